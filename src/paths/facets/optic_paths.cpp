#include "paths/facets/optic_paths.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "base/util/parallel.h"
#include "paths/facets/divide_facet.h"
#include "paths/facets/path_build.h"

namespace trilens {

Id PathNode::facet_of(Id leaf) const {
    const auto found = std::lower_bound(leaves.begin(), leaves.end(), leaf);
    if (found == leaves.end() || *found != leaf) return kNone;
    const Id facet = static_cast<Id>(found - leaves.begin());
    return mesh.has_rays(facet) ? facet : kNone;
}

Id leaf_at(const OpticPaths& paths, Id facet, const Vec3& weights) {
    PathCell cell = paths.cells[facet];
    Vec3 local = weights;
    while (cell.children != kNone) {
        const int child = child_of(local);
        local = child_weights(local, child);
        cell = paths.cells[cell.children + static_cast<Id>(child)];
    }
    return cell.leaf;
}

std::vector<Id> nodes_in_order(const OpticPaths& paths) {
    std::vector<Id> order;
    const auto key = [&](Id n) {
        return std::tuple(paths.nodes[n].step.optic, paths.nodes[n].step.event, paths.nodes[n].colours,
                          paths.nodes[n].medium);
    };
    const std::function<void(Id)> visit = [&](Id parent) {
        std::vector<Id> children;
        for (std::size_t n = 0; n < paths.nodes.size(); ++n)
            if (paths.nodes[n].parent == parent) children.push_back(static_cast<Id>(n));
        std::sort(children.begin(), children.end(), [&](Id a, Id b) { return key(a) < key(b); });
        for (const Id child : children) {
            order.push_back(child);
            visit(child);
        }
    };
    visit(kNone);
    return order;
}

Id film_facet(const FilmWindow& window, const Vec2& pixel) {
    const Vec2 at = (pixel - window.low) / (window.high - window.low) * static_cast<double>(window.n);
    const auto cell = [&](double x) { return std::clamp(static_cast<int>(std::floor(x)), 0, window.n - 1); };
    const int i = cell(at.x), j = cell(at.y);
    const bool above = at.y - j > at.x - i;  // of the diagonal from (i, j)
    return static_cast<Id>(2 * (j * window.n + i) + (above ? 1 : 0));
}

namespace {

constexpr std::size_t kOutlinesPerTask = 64, kFacetsPerTask = 16;
constexpr double kUnbounded = std::numeric_limits<double>::infinity();

std::unique_ptr<PathBuild> begin_build(ProbeContext context, const SurfaceGrid* grid, DivideParams params) {
    auto build = std::make_unique<PathBuild>();
    build->in.context = std::move(context);
    build->in.grid = grid;
    build->in.params = std::move(params);
    return build;
}

/// The outline's facets are set.
void make_room_for_facets(PathBuild& build) {
    const std::size_t facets = build.out.outline.facets.size();
    build.out.cells.resize(facets);
    build.progress.prepared.resize(facets);
    build.progress.fitted.resize(facets);
}

void set_places(PathBuild& build, const SurfaceGrid& grid) {
    build.in.places.resize(grid.corner_point.size());
    for (std::size_t f = 0; f < grid.facets.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const Id corner = grid.facets[f][k];
            build.in.places[corner] = {grid.facet_face[f], grid.facet_uv[f][k],
                                       grid.points[grid.corner_point[corner]], grid.corner_normal[corner]};
        }
    build.out.outline.rays.resize(build.in.places.size());
    build.out.outline.facets = grid.facets;
    build.caches.corner_probes.resize(2 * build.in.places.size());
    make_room_for_facets(build);
}

void set_views(PathBuild& build, std::span<const CornerView> views) {
    for (const CornerView& view : views) {
        build.out.outline.screen.push_back(view.screen);
        build.in.incident.push_back(view.incident);
    }
}

void set_film_corner(PathBuild& build, Id corner, const Vec2& pixel) {
    // A point at the surface's depth first; where the ray meets the surface, that point.
    const Vec3 at = build.in.context.camera.affine
                        ? Vec3(pixel, 1)
                        : Vec3(pixel * build.out.window.depth, build.out.window.depth);
    Chord chord{at, build.in.context.camera.point(at), 2 * build.out.window.reach};
    auto probe = std::make_unique<PathProbe>(probe_chord(
        build.in.context, chord, {.side = ProbeSide::kNearest, .least_weight = kFainter * kLeastWeight}));
    if (!build.in.params.estimates) probe_offsets(build.in.context, *probe);
    if (probe->state != ProbeState::kMissed) {
        chord.point = probe->place.point;
        if (!build.in.context.camera.affine)
            chord.screen = probe->screen = build.in.context.camera.screen(chord.point);
        set_corner_ray_scale(build.in.context, *probe);
    }
    build.in.places[corner].point = chord.point;
    build.out.outline.screen[corner] = chord.screen;
    build.caches.corner_probes[2 * corner + 1] = std::move(probe);
}

void prepare_facets(PathBuild& build, std::span<const Id> facets) {
    if (build.in.ends_first) {
        for (const Id f : facets) {
            build.out.projected_count += !build.progress.prepared[f];
            build.progress.prepared[f] = 1;
        }
        return;
    }
    keep_room(build);
    survey_facets(build);
    const std::vector<Id> fresh = wanted_facets(build, facets);
    std::vector<Id> probed;
    for (const Id f : fresh) {
        if (!build.progress.has_room[f]) continue;
        if (is_worth_probing(build, f))
            probed.push_back(f);
        else
            ++build.out.probe_report.not_worth;
    }
    probe_corners(build, probed);

    std::vector<DividedFacet> divided(fresh.size());
    parallel_for(fresh.size(), kFacetsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            if (build.caches.surveyed.contains(fresh[i])) continue;
            if (!build.progress.has_room[fresh[i]] || !is_worth_probing(build, fresh[i]))
                divided[i] = traced_facet(screen_corners(build.out, fresh[i]));
            else
                divided[i] = divide_facet(build.in.context, facet_to_divide(build, fresh[i]), build.in.params,
                                          build.out.probe_report.plan);
        }
    });
    // Taken when all are there: whoever is stopped before finds them again.
    for (std::size_t i = 0; i < fresh.size(); ++i)
        if (const auto surveyed = build.caches.surveyed.extract(fresh[i]))
            divided[i] = std::move(*surveyed.mapped());
    set_ray_scales(build.in, divided);
    std::vector<FittedLeaf> whole, open;
    for (std::size_t i = 0; i < fresh.size(); ++i) {
        build.progress.prepared[fresh[i]] = 1;
        const Id first_leaf = static_cast<Id>(build.out.leaves.size());
        append_facet(build, fresh[i], fresh[i], divided[i]);
        for (std::size_t p = 0; p < divided[i].parts.size(); ++p) {
            const FittedLeaf leaf{static_cast<Id>(first_leaf + p), &divided[i].parts[p]};
            if (leaf.part->method != LeafMethod::kProjected) continue;
            open.push_back(leaf);
            if (fits_alone(build, leaf.leaf))
                fit_alone(leaf, build.out.nodes);
            else
                whole.push_back(leaf);
        }
    }
    if (build.in.params.fit) fit_nodes(whole, build.out.nodes, parallel_length(build.in.context).value_or(1));
    divide_by_error(build, open);
}

}  // namespace

PathBuilder::PathBuilder(std::unique_ptr<PathBuild> build) : build_(std::move(build)) {}
PathBuilder::PathBuilder(PathBuilder&&) noexcept = default;
PathBuilder& PathBuilder::operator=(PathBuilder&&) noexcept = default;
PathBuilder::~PathBuilder() = default;

void PathBuilder::prepare(std::span<const Id> facets) {
    prepare_facets(*build_, facets);
}

const OpticPaths& PathBuilder::paths() const {
    return build_->out;
}

const ProbeContext& PathBuilder::context() const {
    return build_->in.context;
}

PathBuilder paths_over_grid(ProbeContext context, const SurfaceGrid& grid, DivideParams params) {
    auto begun = begin_build(std::move(context), &grid, std::move(params));
    PathBuild& build = *begun;
    set_places(build, grid);
    const PathCamera& camera = build.in.context.camera;
    build.out.outline.screen.reserve(build.in.places.size());
    for (const Place& place : build.in.places) {
        build.out.outline.screen.push_back(camera.screen(place.point));
        build.in.incident.push_back(camera.ray(build.out.outline.screen.back(), place.point).direction);
    }
    return PathBuilder(std::move(begun));
}

PathBuilder paths_over_views(ProbeContext context, const SurfaceGrid& grid, std::span<const CornerView> views,
                             DivideParams params) {
    auto begun = begin_build(std::move(context), &grid, std::move(params));
    set_places(*begun, grid);
    set_views(*begun, views);
    return PathBuilder(std::move(begun));
}

PathBuilder paths_over_film(ProbeContext context, const FilmWindow& window, DivideParams params) {
    auto begun = begin_build(std::move(context), nullptr, std::move(params));
    PathBuild& build = *begun;
    build.out.window = window;
    const Id n = static_cast<Id>(window.n), side = n + 1;
    const std::size_t corners = static_cast<std::size_t>(side) * side;
    build.in.places.resize(corners);
    build.out.outline.rays.resize(corners);
    build.out.outline.screen.resize(corners);
    build.caches.corner_probes.resize(2 * corners);
    parallel_for(corners, kOutlinesPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t c = from; c < to; ++c) {
            const Vec2 share(static_cast<double>(c % side) / n, static_cast<double>(c / side) / n);
            set_film_corner(build, static_cast<Id>(c), window.low + share * (window.high - window.low));
        }
    });
    for (Id j = 0; j < n; ++j)
        for (Id i = 0; i < n; ++i) {
            const Id a = j * side + i, b = a + 1, c = b + side, d = a + side;
            build.out.outline.facets.push_back({a, b, c});
            build.out.outline.facets.push_back({a, c, d});
        }
    make_room_for_facets(build);
    return PathBuilder(std::move(begun));
}

PathBuilder first_optic_paths(ProbeContext context, const FirstPaths& first) {
    auto begun = begin_build(std::move(context), first.grid, {});
    PathBuild& build = *begun;
    build.in.ends_first = true;
    const SurfaceGrid& grid = *first.grid;
    const RayMesh *const reflection = first.reflection, *const refraction = first.refraction;
    build.out.outline.facets = grid.facets;
    build.out.outline.rays.resize(first.views.size());
    set_views(build, first.views);
    make_room_for_facets(build);
    const std::size_t facets = grid.facets.size();
    for (std::size_t f = 0; f < facets; ++f) {
        build.out.leaves.push_back({static_cast<Id>(f)});
        build.out.cells[f].leaf = static_cast<Id>(f);
    }
    const Media around = build.in.context.camera.media(Vec3(0));
    const auto add = [&](const RayMesh& mesh, Event event, const Media& media) -> PathNode& {
        PathSegment segment;
        segment.step = {build.in.context.optic, event};
        segment.path = event == Event::kReflect ? Path::kReflect : Path::kRefract;
        segment.medium = active_medium(*build.in.context.world, media);
        PathNode& node = build.out.nodes[node_of(build, kNone, segment)];
        node.mesh = mesh;
        node.leaves.resize(facets);
        std::iota(node.leaves.begin(), node.leaves.end(), Id{0});
        node.ends.assign(facets, 1);
        node.principal.assign(facets, 1);
        node.touches.assign(facets, 0);
        node.rests.assign(facets, 0);
        node.to_mirror.assign(facets, 0);
        node.has_start.assign(facets,
                              has_start(*build.in.context.world, segment.step, segment.medium,
                                        {active_medium(*build.in.context.world, around), kUnbounded}));
        node.next.assign(mesh.rays.size(), kUnbounded);
        node.weight.assign(mesh.rays.size(), Vec3(1));
        return node;
    };
    if (reflection) add(*reflection, Event::kReflect, around);
    if (!refraction) return PathBuilder(std::move(begun));
    // Facets seen from the front show what is in the glass, those seen from behind what is outside.
    for (const bool into : {true, false}) {
        const std::optional<MediaSides> sides = sides_of(around, build.in.context.optic, into);
        if (!sides) continue;
        const bool is_interface = felt_glass(*build.in.context.world, sides->before) !=
                                  felt_glass(*build.in.context.world, sides->after);
        PathNode& node = add(*refraction, is_interface ? Event::kTransmit : Event::kPass, sides->after);
        for (std::size_t f = 0; f < facets; ++f)
            if (shows_front(build, static_cast<Id>(f)) != into) node.mesh.facets[f] = {kNone, kNone, kNone};
    }
    return PathBuilder(std::move(begun));
}

}  // namespace trilens
