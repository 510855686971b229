// The facets that paths are worked out for: a surface's, squares of the film, or some with their paths given.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/util/parallel.h"
#include "paths/facets/divide_facet.h"
#include "paths/facets/facet_paths.h"

namespace trilens {
namespace {

constexpr std::size_t kOutlinesPerTask = 64;
constexpr double kUnbounded = std::numeric_limits<double>::infinity();

}  // namespace

OpticPaths::OpticPaths(ProbeContext context, const SurfaceGrid& grid, DivideParams params)
    : context_(std::move(context)), grid_(&grid), params_(std::move(params)) {
    set_places(grid);
    outline_.screen.reserve(places_.size());
    for (const Place& place : places_) {
        outline_.screen.push_back(context_.camera.screen(place.point));
        incident_.push_back(context_.camera.ray(outline_.screen.back(), place.point).direction);
    }
}

OpticPaths::OpticPaths(ProbeContext context, const SurfaceGrid& grid, std::span<const CornerView> views,
                       DivideParams params)
    : context_(std::move(context)), grid_(&grid), params_(std::move(params)) {
    set_places(grid);
    for (const CornerView& view : views) {
        outline_.screen.push_back(view.screen);
        incident_.push_back(view.incident);
    }
}

OpticPaths::~OpticPaths() = default;

void OpticPaths::set_places(const SurfaceGrid& grid) {
    places_.resize(grid.corner_point.size());
    for (std::size_t f = 0; f < grid.facets.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const Id corner = grid.facets[f][k];
            places_[corner] = {grid.facet_face[f], grid.facet_uv[f][k],
                               grid.points[grid.corner_point[corner]], grid.corner_normal[corner]};
        }
    outline_.rays.resize(places_.size());
    outline_.facets = grid.facets;
    corner_probes_.resize(2 * places_.size());
    cells_.resize(grid.facets.size());
    prepared_.resize(grid.facets.size());
    fitted_.resize(grid.facets.size());
}

void OpticPaths::set_film_corner(Id corner, const Vec2& pixel) {
    // A point at the surface's depth first; where the ray meets the surface, that point.
    const Vec3 at = context_.camera.affine ? Vec3(pixel, 1) : Vec3(pixel * window_.depth, window_.depth);
    Chord chord{at, context_.camera.point(at), 2 * window_.reach};
    auto probe = std::make_unique<PathProbe>(
        probe_chord(context_, chord, {.side = ProbeSide::kNearest, .least_weight = kFainter * kLeastWeight}));
    if (!params_.estimates) probe_offsets(context_, *probe);
    if (probe->state != ProbeState::kMissed) {
        chord.point = probe->place.point;
        if (!context_.camera.affine) chord.screen = probe->screen = context_.camera.screen(chord.point);
        set_corner_ray_scale(context_, *probe);
    }
    places_[corner].point = chord.point;
    outline_.screen[corner] = chord.screen;
    corner_probes_[2 * corner + 1] = std::move(probe);
}

OpticPaths::OpticPaths(ProbeContext context, const FilmWindow& window, DivideParams params)
    : context_(std::move(context)), window_(window), params_(std::move(params)) {
    const Id n = static_cast<Id>(window.n), side = n + 1;
    const std::size_t corners = static_cast<std::size_t>(side) * side;
    places_.resize(corners);
    outline_.rays.resize(corners);
    outline_.screen.resize(corners);
    corner_probes_.resize(2 * corners);
    parallel_for(corners, kOutlinesPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t c = from; c < to; ++c) {
            const Vec2 share(static_cast<double>(c % side) / n, static_cast<double>(c / side) / n);
            set_film_corner(static_cast<Id>(c), window.low + share * (window.high - window.low));
        }
    });
    for (Id j = 0; j < n; ++j)
        for (Id i = 0; i < n; ++i) {
            const Id a = j * side + i, b = a + 1, c = b + side, d = a + side;
            outline_.facets.push_back({a, b, c});
            outline_.facets.push_back({a, c, d});
        }
    cells_.resize(outline_.facets.size());
    prepared_.resize(outline_.facets.size());
    fitted_.resize(outline_.facets.size());
}

Id OpticPaths::film_facet(const Vec2& pixel) const {
    const Vec2 at = (pixel - window_.low) / (window_.high - window_.low) * static_cast<double>(window_.n);
    const auto cell = [&](double x) { return std::clamp(static_cast<int>(std::floor(x)), 0, window_.n - 1); };
    const int i = cell(at.x), j = cell(at.y);
    const bool above = at.y - j > at.x - i;  // of the diagonal from (i, j)
    return static_cast<Id>(2 * (j * window_.n + i) + (above ? 1 : 0));
}

OpticPaths::OpticPaths(ProbeContext context, const FirstPaths& first)
    : context_(std::move(context)), grid_(first.grid), ends_first_(true) {
    const SurfaceGrid& grid = *first.grid;
    const RayMesh *const reflection = first.reflection, *const refraction = first.refraction;
    outline_.facets = grid.facets;
    outline_.rays.resize(first.views.size());
    for (const CornerView& view : first.views) {
        outline_.screen.push_back(view.screen);
        incident_.push_back(view.incident);
    }
    cells_.resize(grid.facets.size());
    prepared_.resize(grid.facets.size());
    fitted_.resize(grid.facets.size());
    const std::size_t facets = grid.facets.size();
    for (std::size_t f = 0; f < facets; ++f) {
        leaves_.push_back({static_cast<Id>(f)});
        cells_[f].leaf = static_cast<Id>(f);
    }
    const Media around = context_.camera.media(Vec3(0));
    const auto add = [&](const RayMesh& mesh, Event event, const Media& media) -> PathNode& {
        PathSegment segment;
        segment.step = {context_.optic, event};
        segment.path = event == Event::kReflect ? Path::kReflect : Path::kRefract;
        segment.medium = active_medium(*context_.world, media);
        PathNode& node = nodes_[node_of(kNone, segment)];
        node.mesh = mesh;
        node.leaves.resize(facets);
        std::iota(node.leaves.begin(), node.leaves.end(), Id{0});
        node.ends.assign(facets, 1);
        node.principal.assign(facets, 1);
        node.touches.assign(facets, 0);
        node.rests.assign(facets, 0);
        node.next.assign(mesh.rays.size(), kUnbounded);
        node.weight.assign(mesh.rays.size(), Vec3(1));
        return node;
    };
    if (reflection) add(*reflection, Event::kReflect, around);
    if (!refraction) return;
    // Facets seen from the front show what is in the glass, those seen from behind what is outside.
    for (const bool into : {true, false}) {
        const std::optional<MediaSides> sides = sides_of(around, context_.optic, into);
        if (!sides) continue;
        const bool is_interface =
            felt_glass(*context_.world, sides->before) != felt_glass(*context_.world, sides->after);
        PathNode& node = add(*refraction, is_interface ? Event::kTransmit : Event::kPass, sides->after);
        for (std::size_t f = 0; f < facets; ++f)
            if (shows_front(static_cast<Id>(f)) != into) node.mesh.facets[f] = {kNone, kNone, kNone};
    }
}

}  // namespace trilens
