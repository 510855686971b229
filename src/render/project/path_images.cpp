#include "render/project/path_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/math/box.h"
#include "base/util/parallel.h"
#include "paths/facets/divide_facet.h"
#include "render/project/image_light.h"
#include "render/world/world.h"
#include "specular/specular_point.h"

namespace trilens {
namespace {

/// A point is free if what its ray meets lies within this share of the way.
constexpr double kPathFreeShare = 1e-6;
constexpr std::size_t kPathFacetsPerTask = 256, kLonePerTask = 4;
/// Traced parts whose paths are held at once, until their rays are added to their histories.
constexpr std::size_t kLoneBatch = 1024;

/// Whether a facet may be seen on the film: some corner behind the eye, or its box on the film.
bool may_be_on_film(const RayMesh& outline, std::size_t facet, const Film& film) {
    Vec2 low(1e300), high(-1e300);
    for (const Id corner : outline.facets[facet]) {
        const Vec3& s = outline.screen[corner];
        if (!(s.z > 0)) return true;
        low = glm::min(low, Vec2(s) / s.z);
        high = glm::max(high, Vec2(s) / s.z);
    }
    return high.x >= 0 && high.y >= 0 && low.x <= film.width && low.y <= film.height;
}

std::array<Vec3, 3> corners_of(const RayMesh& outline, Id facet) {
    const IdTriple& c = outline.facets[facet];
    return {outline.screen[c[0]], outline.screen[c[1]], outline.screen[c[2]]};
}

/// Pixels: the longest side of the part of a facet; infinite where a corner lies behind the eye.
double reach_of(const RayMesh& outline, const PathLeaf& leaf) {
    std::array<Vec2, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 s = corners_of(outline, leaf.facet)[k];
        if (!(s.z > 0)) return std::numeric_limits<double>::infinity();
        corner[k] = Vec2(s) / s.z;
    }
    const double longest = std::max(
        {length(corner[1] - corner[0]), length(corner[2] - corner[1]), length(corner[0] - corner[2])});
    return std::ldexp(longest, -leaf.level);
}

Vec2 lone_pixel(const PathLeaf& leaf) {
    return Vec2(leaf.centre) / leaf.centre.z;
}

/// Whether some of a traced part may be on the film, or within a pixel of it.
bool may_be_on_film(const RayMesh& outline, const PathLeaf& leaf, const Vec2& film) {
    if (!may_reach_film(corners_of(outline, leaf.facet), film)) return false;
    const Vec2 centre = lone_pixel(leaf);
    return length(centre - glm::clamp(centre, Vec2(0), film)) <= reach_of(outline, leaf) + 1;
}

/// Whether the optic itself hides a point of it from the camera. `size`: the optic's, for parallel rays.
bool is_hidden(const ProbeContext& context, const Vec3& screen, const Vec3& point, double size) {
    Ray ray = context.camera.ray(screen, point);
    if (context.camera.parallel) ray = {point - size * ray.direction, size * ray.direction};
    const std::optional<SurfaceHit> hit = context.world->optics[context.optic].tracer->first_hit(ray);
    return hit && hit->t < 1 - kPathFreeShare;
}

/// Which corners of some facets the optic itself hides from the camera.
std::vector<char> hidden_corners(const PathBuilder& paths, const SurfaceGrid& grid,
                                 std::span<const Id> facets, double size) {
    std::vector<char> wanted(grid.corner_point.size(), 0), hidden(grid.corner_point.size(), 0);
    for (const Id f : facets)
        for (const Id corner : grid.facets[f]) wanted[corner] = 1;
    parallel_for(hidden.size(), kPathFacetsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t c = from; c < to; ++c)
            hidden[c] = wanted[c] && is_hidden(paths.context(), paths.paths().outline.screen[c],
                                               grid.points[grid.corner_point[c]], size);
    });
    return hidden;
}

bool is_middle_hidden(const PathBuilder& paths, const SurfaceGrid& grid, Id facet, double size) {
    Vec3 screen(0), middle(0);
    for (const Id corner : grid.facets[facet]) {
        screen += paths.paths().outline.screen[corner] / 3.0;
        middle += grid.points[grid.corner_point[corner]] / 3.0;
    }
    return is_hidden(paths.context(), screen, middle, size);
}

/// The facets that may lie on the film and that the camera may see: it sees a corner or the middle.
std::vector<Id> facets_in_view(const PathBuilder& paths, const SurfaceGrid& grid, const Film& film) {
    std::vector<Id> facets;
    for (Id f = 0; f < paths.paths().outline.facets.size(); ++f)
        if (may_be_on_film(paths.paths().outline, f, film)) facets.push_back(f);
    if (paths.paths().is_on_film()) return facets;
    Box box;
    for (const Vec3& point : grid.points) box.include(point);
    const double size = 2 * length(box.size());
    const std::vector<char> hidden = hidden_corners(paths, grid, facets, size);
    std::vector<char> is_seen(facets.size());
    parallel_for(facets.size(), kPathFacetsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const IdTriple& corner = grid.facets[facets[i]];
            is_seen[i] = !hidden[corner[0]] || !hidden[corner[1]] || !hidden[corner[2]] ||
                         !is_middle_hidden(paths, grid, facets[i], size);
        }
    });
    std::vector<Id> seen;
    for (std::size_t i = 0; i < facets.size(); ++i)
        if (is_seen[i]) seen.push_back(facets[i]);
    return seen;
}

/// Whether all rays of a facet of a node are known to have its history: they are but for paths so faint that
/// nobody asked, and behind places that rest on an object (one_history.cpp).
bool is_proven(const OpticPaths& paths, Id node, std::size_t facet) {
    const Id leaf = paths.nodes[node].leaves[facet];
    for (Id at = node; at != kNone; at = paths.nodes[at].parent) {
        const PathNode& one = paths.nodes[at];
        const Id own = one.facet_of(leaf);
        if (own == kNone) return false;
        bool is_bright = one.principal[own];
        for (const Id corner : one.mesh.facets[own])
            is_bright = is_bright || of_worst_colour(one.weight[corner]) > kMuchLight * kLeastWeight;
        if (!is_bright || (at != node && one.rests[own])) return false;
    }
    return true;
}

/// Paths as deep as the word goes, those alone that may begin it.
PathWorld world_of_word(const World& world, const EventWord& word) {
    PathWorld paths = path_world(world);
    if (!word.asks()) return paths;
    paths.max_depth = static_cast<int>(word.size()) - 1;
    paths.reflect = paths.reflect && word.allows(0, Event::kReflect);
    paths.refract = paths.refract && word.allows(0, Event::kTransmit);
    return paths;
}

}  // namespace

SeveralOpticsImages::SeveralOpticsImages(const World& world, const Frame& frame, std::size_t optic,
                                         const SeveralOpticsChoice& choice)
    : world_(world),
      frame_(frame),
      choice_(choice),
      followed_(world_of_word(world, choice.word)),
      builder_(make_optic_paths(world, frame, optic, nullptr, &followed_)),
      surface_of_([&world](Id other) -> const Surface& { return *world.optics[other].surface; }) {
    builder_.prepare(facets_in_view(builder_, frame.optics[optic].facets->grid(), world.scene.film));
    add_nodes();
    add_lone_rays();
    drop_histories();
    get_ready();
}

/// Those that are not asked for.
void SeveralOpticsImages::drop_histories() {
    std::erase_if(histories_, [&](const History& history) {
        return !choice_.word.is(history.steps) || history.most_light < 0.5 * choice_.min_weight;
    });
    places_.clear();
    history_at_.clear();
}

/// Rows of what is made later; of optics whose normals are not their own, exact rays alone tell.
void SeveralOpticsImages::get_ready() {
    for (History& history : histories_) {
        for (const PathSegment& segment : history.chain) history.colours.push_back(segment.colours);
        if (!std::all_of(history.steps.begin(), history.steps.end(), [&](const Step& step) {
                return has_own_normals(world_.scene.meshes[world_.optics[step.optic].mesh]);
            }))
            history.proven.assign(history.proven.size(), 0);
        history.facet_paths = std::make_unique<Lazy<FacetPaths>[]>(history.grid_facet.size());
        history.lone_paths = std::make_unique<Lazy<LonePath>[]>(history.lone.size());
    }
}

void SeveralOpticsImages::add_nodes() {
    const std::vector<PathNode>& nodes = builder_.paths().nodes;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        // Where light parts into colours the middle one stands for all.
        if (nodes[n].step_count < 2 || (nodes[n].colours != kAllColours && nodes[n].colours != 1)) continue;
        std::vector<PathSegment> segments;
        for (Id at = static_cast<Id>(n); at != kNone; at = nodes[at].parent) {
            PathSegment segment;
            segment.step = nodes[at].step;
            segment.colours = nodes[at].colours;
            segment.path = nodes[at].path;
            segments.insert(segments.begin(), segment);
        }
        for (std::size_t i = 0; i < segments.size(); ++i)
            segments[i].parent = i == 0 ? kNone : static_cast<Id>(i - 1);
        History& history = history_of(segments, static_cast<Id>(segments.size() - 1));
        history.seeds = std::make_unique<MeshPointImages>(nodes[n].mesh);
        for (const Vec3& weight : nodes[n].weight)
            history.most_light = std::max(history.most_light, of_worst_colour(weight));
        for (std::size_t f = 0; f < nodes[n].leaves.size(); ++f) {
            history.grid_facet.push_back(builder_.paths().leaves[nodes[n].leaves[f]].facet);
            history.proven.push_back(is_proven(builder_.paths(), static_cast<Id>(n), f));
        }
    }
}

SeveralOpticsImages::History& SeveralOpticsImages::history_of(const std::vector<PathSegment>& segments,
                                                              Id last) {
    std::vector<Id> chain;
    for (Id s = last; s != kNone; s = segments[s].parent) chain.push_back(s);
    std::reverse(chain.begin(), chain.end());
    Id place = kNone;
    for (const Id s : chain) {
        const Step& step = segments[s].step;
        place = places_.try_emplace({place, step.optic, step.event}, static_cast<Id>(places_.size()))
                    .first->second;
    }
    const auto [known, is_new] = history_at_.try_emplace({place, segments[last].colours}, histories_.size());
    if (!is_new) return histories_[known->second];

    History& made = histories_.emplace_back();
    made.path = segments[last].path;
    for (std::size_t i = 0; i < chain.size(); ++i) {
        PathSegment& segment = made.chain.emplace_back();
        segment.parent = i == 0 ? kNone : static_cast<Id>(i - 1);
        segment.step = segments[chain[i]].step;
        segment.colours = segments[chain[i]].colours;
        segment.ends = chain[i] == last;
        made.steps.push_back(segment.step);
    }
    return made;
}

void SeveralOpticsImages::add_lone_rays() {
    std::vector<const PathLeaf*> traced;
    for (const PathLeaf& leaf : builder_.paths().leaves)
        if (leaf.method == LeafMethod::kTraced && leaf.centre.z > 0) traced.push_back(&leaf);
    std::vector<std::vector<PathSegment>> followed;
    for (std::size_t first = 0; first < traced.size(); first += kLoneBatch) {
        const auto batch = std::span(traced).subspan(first, std::min(kLoneBatch, traced.size() - first));
        followed.assign(batch.size(), {});
        parallel_for(batch.size(), kLonePerTask, [&](std::size_t from, std::size_t to) {
            for (std::size_t i = from; i < to; ++i) followed[i] = followed_from(lone_pixel(*batch[i]));
        });
        for (std::size_t i = 0; i < batch.size(); ++i) add_lone_rays(*batch[i], followed[i]);
    }
}

std::vector<PathSegment> SeveralOpticsImages::followed_from(const Vec2& pixel) const {
    const PathWorld& world = followed_;
    const Id optic = builder_.context().optic;
    const Ray ray = history_query(world_, frame_, {}, {}).camera_ray(pixel);
    const std::optional<SurfaceHit> hit = world.optics[optic].tracer->first_hit(ray);
    if (!hit) return {};
    const Vec3 incoming = normalize_or_zero(ray.direction);
    return follow_paths(world, {{optic, incoming, hit->point.position, hit->point.normal,
                                 dot(incoming, hit->point.normal) <= 0},
                                hit->t * length(ray.direction),
                                frame_.camera_media.of(ray)})
        .segments;
}

void SeveralOpticsImages::add_lone_rays(const PathLeaf& leaf, const std::vector<PathSegment>& followed) {
    const RayMesh& outline = builder_.paths().outline;
    const Vec2 film(world_.scene.film.width, world_.scene.film.height);
    for (std::size_t i = 0; i < followed.size(); ++i) {
        const PathSegment& segment = followed[i];
        if (segment.parent == kNone || (segment.colours != kAllColours && segment.colours != 1)) continue;
        History& history = history_of(followed, static_cast<Id>(i));
        history.lone.push_back({lone_pixel(leaf), leaf.facet, segment.ray, reach_of(outline, leaf),
                                may_be_on_film(outline, leaf, film)});
        history.most_light = std::max(history.most_light, of_worst_colour(segment.weight));
    }
}

}  // namespace trilens
