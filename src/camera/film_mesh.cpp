#include "camera/film_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"

namespace trilens {
namespace {

constexpr double kNudge = 1e-9;   // share of the film by which corners on a break stand inside their cell
constexpr double kFarAway = 1e4;  // times the focus
constexpr int kFirst = 4;         // N at which a search begins
constexpr double kMargin = 1.1;   // more than the error's order asks for

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

/// How far from `at` the exact camera shows what the mesh's ray passes at t; none where it cannot be told.
std::optional<double> displacement(const CameraModel& model, const Vec2& at, const Vec3& point) {
    std::optional<double> nearest;
    for (std::size_t branch = 0; branch < model.branch_count(); ++branch) {
        if (!model.shows(branch, at)) continue;
        const std::optional<FilmImage> found = model.place(point, branch);
        if (!found) continue;
        Vec2 off = found->pixel - at;
        if (model.period() > 0) off.x = std::remainder(off.x, model.period());
        off.x /= model.stretch(at);
        const double pixels = length(off);
        if (!nearest || pixels < *nearest) nearest = pixels;
    }
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
                    const auto pixels = displacement(model, at, ray.origin + t * ray.direction);
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
