#include "camera/model/film_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/util/parallel.h"
#include "camera/model/cut_cells.h"
#include "camera/model/general_linear.h"

namespace trilens {
namespace {

constexpr double kNudge = 1e-9;   // share of the film by which corners on a break stand inside their cell
constexpr std::array kDepths{1.0, 1e4};  // times the focus
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
    /// Where rays are taken: not on a break, but on its own side.
    Vec2 inside(double film) const {
        return {breaks_low ? low + kNudge * film : low, breaks_high ? high - kNudge * film : high};
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

FilmBlock block_of(const CameraModel& model, const FilmSize& film, const Span& across, const Span& down) {
    const Vec2 x = across.inside(film.width), y = down.inside(film.height);
    return {model, {x[0], y[0]}, {x[1], y[1]}, std::max(film.width, film.height)};
}

/// The cells between two breaks in x and two in y.
void append_block(RayMesh& mesh, const CameraModel& model, const FilmSize& film, const Span& across,
                  const Span& down) {
    const std::size_t columns = static_cast<std::size_t>(across.cells) + 1,
                      rows = static_cast<std::size_t>(down.cells) + 1, first = mesh.rays.size();
    mesh.rays.resize(first + columns * rows);
    mesh.screen.resize(first + columns * rows);
    const FilmBlock block = block_of(model, film, across, down);
    parallel_for(rows, 8, [&](std::size_t from, std::size_t to) {
        for (std::size_t j = from; j < to; ++j)
            for (std::size_t i = 0; i < columns; ++i) {
                const Vec2 screen(across.line(static_cast<int>(i)), down.line(static_cast<int>(j)));
                mesh.screen[first + j * columns + i] = Vec3(screen, 1);
                mesh.rays[first + j * columns + i] = block.ray(screen).value_or(Ray{});
            }
    });
    const std::size_t cells = static_cast<std::size_t>(across.cells) * static_cast<std::size_t>(down.cells);
    const auto cell_at = [&](std::size_t cell) {
        const int i = static_cast<int>(cell % static_cast<std::size_t>(across.cells)),
                  j = static_cast<int>(cell / static_cast<std::size_t>(across.cells));
        return FilmCell{{across.line(i), down.line(j)}, {across.line(i + 1), down.line(j + 1)}};
    };
    std::vector<CellRays> has(cells);
    parallel_for(cells, 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t cell = from; cell < to; ++cell) has[cell] = rays_in(block, cell_at(cell));
    });
    for (std::size_t cell = 0; cell < cells; ++cell) {
        if (has[cell] == CellRays::kPartly) add_cut_cell(block, cell_at(cell), mesh);
        if (has[cell] != CellRays::kEverywhere) continue;
        const std::size_t a = first + cell / (columns - 1) * columns + cell % (columns - 1), b = a + 1,
                          c = b + columns, d = a + columns;
        mesh.facets.push_back({static_cast<Id>(a), static_cast<Id>(b), static_cast<Id>(c)});
        mesh.facets.push_back({static_cast<Id>(a), static_cast<Id>(c), static_cast<Id>(d)});
    }
}

Vec2 offset(const CameraModel& model, const Vec2& at, const Vec2& place) {
    Vec2 off = place - at;
    if (model.period() > 0) off.x = std::remainder(off.x, model.period());
    off.x /= model.stretch(at);
    return off;
}

/// How a point at t of the camera's rays moves with the place, per pixel along an axis: to the side that has
/// rays, beside a border.
std::optional<Vec3> slope_along(const CameraModel& model, const Vec2& place, int axis, double t) {
    const std::optional<Ray> here = model.ray(place);
    for (const double step : {kStep, -kStep}) {
        Vec2 beside = place;
        beside[axis] += step;
        const std::optional<Ray> there = model.ray(beside);
        if (!here || !there) continue;
        return (there->origin - here->origin + t * (there->direction - here->direction)) / step;
    }
    return std::nullopt;
}

/// Where near `at` an exact ray passes the point, by Newton's method; `t`: about where along it. None where
/// it does not converge within the film's neighbourhood.
std::optional<Vec2> place_near(const CameraModel& model, const Vec2& at, const Vec3& point, double t) {
    Vec2 place = at;
    for (int round = 0; round < kRounds; ++round) {
        const auto here = model.ray(place);
        const auto along_x = slope_along(model, place, 0, t), along_y = slope_along(model, place, 1, t);
        if (!here || !along_x || !along_y) return std::nullopt;
        const Mat3 slopes(*along_x, *along_y, here->direction);
        const Vec3 left = point - here->origin - t * here->direction, step = inverse(slopes) * left;
        if (!(length(Vec2(step)) < kFarStep)) return std::nullopt;
        Vec2 move(step);
        while (length(move) > kFound && !model.ray(place + move)) move *= 0.5;  // beyond the border
        place += move;
        t += step.z;
        if (length(Vec2(step)) < kFound) return place;
        if (length(move) <= kFound) return std::nullopt;
    }
    return std::nullopt;
}

/// What lies around a place, eight ways at half of kFoldReach and at all of it.
template <class Use>
void for_each_around(const Vec2& at, const Use& use) {
    for (int k = 0; k < 8; ++k)
        for (const double reach : {0.5 * kFoldReach, kFoldReach}) {
            const double angle = 0.25 * 3.14159265358979323846 * k;
            use(at + reach * Vec2(std::cos(angle), std::sin(angle)));
        }
}

/// Whether the picture of what lies at t turns over near that place: there displacements have no bound.
bool folds_near(const CameraModel& model, const Vec2& at, double t) {
    bool positive = false, negative = false;
    for_each_around(at, [&](const Vec2& place) {
        const auto spread = film_spread(model, place, kStep);
        if (!spread) return;
        for (const double depth : {0.9 * t, t, 1.1 * t}) (spread->at(depth) > 0 ? positive : negative) = true;
    });
    return positive && negative;
}

bool borders_near(const CameraModel& model, const Vec2& at) {
    bool any = false;
    for_each_around(at, [&](const Vec2& place) { any = any || !model.ray(place); });
    return any;
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
    const auto local = place_near(model, at, passed.point, passed.t);
    if (!local && borders_near(model, at)) return std::nullopt;
    if (local) nearest = std::min(*nearest, length(offset(model, at, *local)));
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
                for (const double depth : kDepths) {
                    const double t = depth * model.focus();
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
