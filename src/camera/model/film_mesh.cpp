#include "camera/model/film_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/util/parallel.h"
#include "camera/model/general_linear.h"

namespace trilens {
namespace {

constexpr double kNudge = 1e-9;   // share of the film by which corners on a break stand inside their cell
constexpr double kFarAway = 1e4;  // times the focus
constexpr int kFirst = 4;         // N at which a search begins
constexpr double kMargin = 1.1;   // more than the error's order asks for
constexpr double kSure = 0.05;    // pixels: a displacement of that or less is that of the image looked for
constexpr double kStep = 0.01;    // pixels, of differences between rays
constexpr double kFound = 1e-6;   // pixels
constexpr double kFarStep = 1e3;  // pixels
constexpr double kFoldReach = 8;  // pixels
constexpr int kRounds = 12;

/// Lines along one axis between two breaks.
struct Span {
    double low = 0, high = 1;
    int cells = 1;
    bool breaks_low = false, breaks_high = false;

    double line(int i) const { return i == cells ? high : low + (high - low) * i / cells; }
    /// Where the ray of that line is taken.
    double inside(int i, double film) const {
        if (i == 0 && breaks_low) return low + kNudge * film;
        if (i == cells && breaks_high) return high - kNudge * film;
        return line(i);
    }
};

std::vector<Span> make_spans(std::vector<double> breaks, double size, int n) {
    std::sort(breaks.begin(), breaks.end());
    std::vector<double> ends{0};
    for (const double at : breaks)
        if (at > ends.back() + 1e-6 * size && at < (1 - 1e-6) * size) ends.push_back(at);
    ends.push_back(size);
    std::vector<Span> spans;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        Span span{ends[i], ends[i + 1], 1, i > 0, i + 2 < ends.size()};
        span.cells = std::max(1, static_cast<int>(std::lround(n * (span.high - span.low) / size)));
        spans.push_back(span);
    }
    return spans;
}

/// The cells between two breaks in x and two in y.
void append_block(RayMesh& mesh, const CameraModel& model, const FilmSize& film, const Span& across,
                  const Span& down) {
    const std::size_t columns = static_cast<std::size_t>(across.cells) + 1,
                      rows = static_cast<std::size_t>(down.cells) + 1, first = mesh.rays.size();
    mesh.rays.resize(first + columns * rows);
    mesh.screen.resize(first + columns * rows);
    std::vector<char> own(columns * rows);  // has a ray where the grid put it
    parallel_for(rows, 8, [&](std::size_t from, std::size_t to) {
        for (std::size_t j = from; j < to; ++j)
            for (std::size_t i = 0; i < columns; ++i) {
                const int column = static_cast<int>(i), row = static_cast<int>(j);
                Vec2 screen(across.line(column), down.line(row));
                std::optional<Ray> ray =
                    model.ray({across.inside(column, film.width), down.inside(row, film.height)});
                own[j * columns + i] = ray.has_value();
                if (!ray) ray = model.ray(screen = model.nearest_with_ray(screen));
                mesh.screen[first + j * columns + i] = Vec3(screen, 1);
                if (ray) mesh.rays[first + j * columns + i] = *ray;
            }
    });
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
        for (const std::size_t corner : {a, b, c})
            if (mesh.rays[first + corner].direction == Vec3(0)) return;
        mesh.facets.push_back(
            {static_cast<Id>(first + a), static_cast<Id>(first + b), static_cast<Id>(first + c)});
    };
    for (std::size_t j = 0; j + 1 < rows; ++j)
        for (std::size_t i = 0; i + 1 < columns; ++i) {
            const std::size_t a = j * columns + i, b = a + 1, c = b + columns, d = a + columns;
            if (!own[a] && !own[b] && !own[c] && !own[d]) continue;
            add(a, b, c);
            add(a, c, d);
        }
}

Vec2 offset(const CameraModel& model, const Vec2& at, const Vec2& place) {
    Vec2 off = place - at;
    if (model.period() > 0) off.x = std::remainder(off.x, model.period());
    off.x /= model.stretch(at);
    return off;
}

/// Where near `at` an exact ray passes the point, by Newton's method; `t`: about where along it. None where
/// it does not converge within the film's neighbourhood.
std::optional<Vec2> place_near(const CameraModel& model, const Vec2& at, const Vec3& point, double t) {
    Vec2 place = at;
    for (int round = 0; round < kRounds; ++round) {
        const auto here = model.ray(place), right = model.ray(place + Vec2(kStep, 0)),
                   below = model.ray(place + Vec2(0, kStep));
        if (!here || !right || !below) return std::nullopt;
        const auto along = [&](const Ray& ray) {
            return (ray.origin - here->origin + t * (ray.direction - here->direction)) / kStep;
        };
        const Mat3 slopes(along(*right), along(*below), here->direction);
        const Vec3 left = point - here->origin - t * here->direction, step = inverse(slopes) * left;
        if (!(length(Vec2(step)) < kFarStep)) return std::nullopt;
        place += Vec2(step);
        t += step.z;
        if (length(Vec2(step)) < kFound) return place;
    }
    return std::nullopt;
}

/// Whether the picture of what lies at t turns over near that place: there displacements have no bound.
bool folds_near(const CameraModel& model, const Vec2& at, double t) {
    bool positive = false, negative = false;
    for (int k = 0; k < 8; ++k)
        for (const double reach : {0.5 * kFoldReach, kFoldReach}) {
            const double angle = 0.25 * 3.14159265358979323846 * k;
            const auto spread =
                film_spread(model, at + reach * Vec2(std::cos(angle), std::sin(angle)), kStep);
            if (!spread) continue;
            for (const double depth : {0.9 * t, t, 1.1 * t})
                (spread->at(depth) > 0 ? positive : negative) = true;
        }
    return positive && negative;
}

/// A point that the mesh's ray passes.
struct Passed {
    Vec3 point{0};
    double t = 0;
};

/// How far from `at` the exact camera shows it; none where it cannot be told.
std::optional<double> displacement(const CameraModel& model, const Vec2& at, const Passed& passed) {
    std::optional<double> nearest;
    for (std::size_t branch = 0; branch < model.branch_count(); ++branch) {
        if (!model.shows(branch, at)) continue;
        const std::optional<FilmImage> found = model.place(passed.point, branch);
        if (!found) continue;
        const double pixels = length(offset(model, at, found->pixel));
        if (!nearest || pixels < *nearest) nearest = pixels;
    }
    if (!nearest || *nearest <= kSure) return nearest;
    // Of several images the place that was found may be another.
    if (const auto local = place_near(model, at, passed.point, passed.t))
        nearest = std::min(*nearest, length(offset(model, at, *local)));
    if (*nearest > kSure && folds_near(model, at, passed.t)) return std::nullopt;
    return nearest;
}

}  // namespace

RayMesh make_film_mesh(const CameraModel& model, const FilmSize& film, int n) {
    RayMesh mesh;
    for (const Span& down : make_spans(model.breaks_y(), film.height, n))
        for (const Span& across : make_spans(model.breaks_x(), film.width, n))
            append_block(mesh, model, film, across, down);
    return mesh;
}

FilmError film_error(const CameraModel& model, const FilmSize& film, const RayMesh& mesh) {
    static const std::array kPlaces{Vec3(1. / 3), Vec3(0.5, 0.5, 0), Vec3(0, 0.5, 0.5), Vec3(0.5, 0, 0.5)};
    std::vector<FilmError> of_facet(mesh.facets.size());
    parallel_for(mesh.facets.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f)
            for (const Vec3& weights : kPlaces) {
                Vec3 screen(0);
                for (int k = 0; k < 3; ++k)
                    screen += weights[k] * mesh.screen[mesh.facets[f][static_cast<std::size_t>(k)]];
                const Vec2 at(screen.x, screen.y);
                if (at.x < 0 || at.y < 0 || at.x > film.width || at.y > film.height) continue;
                const Ray ray = interpolated_ray(mesh, f, weights);
                for (const double t : {model.focus(), kFarAway * model.focus()}) {
                    const auto pixels = displacement(model, at, {ray.origin + t * ray.direction, t});
                    if (pixels && *pixels > of_facet[f].pixels) of_facet[f] = {*pixels, at};
                }
            }
    });
    FilmError worst;
    for (const FilmError& one : of_facet)
        if (one.pixels > worst.pixels) worst = one;
    return worst;
}

TolerantMesh make_film_mesh_within(const CameraModel& model, const FilmSize& film, double tolerance,
                                   int most) {
    TolerantMesh result;
    int n = std::min(kFirst, most);
    while (true) {
        RayMesh mesh = make_film_mesh(model, film, n);
        result.n = n;
        result.error = film_error(model, film, mesh);
        if (result.error.pixels <= tolerance) {
            result.mesh = std::move(mesh);
            return result;
        }
        if (n == most) return result;
        const double wanted = n * std::sqrt(result.error.pixels / tolerance) * kMargin;
        n = static_cast<int>(std::clamp(wanted, n + 1.0, 4.0 * n));
        n = std::min(n, most);
    }
}

}  // namespace trilens
