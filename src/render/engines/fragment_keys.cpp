#include "render/engines/fragment_keys.h"

#include <algorithm>
#include <cmath>

#include "base/raymesh/rasterize.h"
#include "base/util/parallel.h"
#include "render/engines/path_ends.h"
#include "render/frame/frame.h"

namespace trilens {

Fate fate_before_next(const Visible& seen, double next, bool touches) {
    if (!seen.seen()) return Fate::kGoesOn;
    if (seen.t_high <= next * (1 + kTouch)) return Fate::kEnds;
    if (touches) return seen.t_high <= next * (1 + kNearTouch) ? Fate::kEnds : Fate::kUnknown;
    return seen.t_low > next * (1 + kTouch) ? Fate::kGoesOn : Fate::kUnknown;
}

std::vector<Id> owners_of_node(const PathNode& node, const std::vector<Id>& leaf,
                               std::span<const char> came) {
    std::vector<Id> owner(leaf.size(), kNone);
    if (node.parent != kNone && came.empty()) return owner;
    Id of_leaf = kNone, facet = kNone;  // the sample's before
    for (std::size_t s = 0; s < owner.size(); ++s) {
        if (leaf[s] == kNone || (node.parent != kNone && !came[s])) continue;
        if (leaf[s] != of_leaf) {
            of_leaf = leaf[s];
            facet = node.facet_of(of_leaf);
        }
        owner[s] = facet;
    }
    return owner;
}

void HistoryKeys::join_facet(Id index, std::size_t facet, std::span<const Id> samples,
                             std::span<FragmentKey> keys) {
    const PathNode& node = drawn_.paths.nodes[index];
    const FacetWeights weights = facet_weights(node.mesh, facet);
    if (weights.edge_on) return;
    const IdTriple& corner = node.mesh.facets[facet];
    for (const Id s : samples) {
        if (keys[s] == kAlone) continue;
        Fate fate = Fate::kEnds;
        if (!node.ends[facet]) {
            const Vec2 at = drawn_.grid.position(s);
            const Vec3 e = weights.unnormalised(at.x, at.y), share = e / (e.x + e.y + e.z);
            double next = 0;
            for (int k = 0; k < 3; ++k) next += share[k] * node.next[corner[static_cast<std::size_t>(k)]];
            fate = fate_before_next(visible_[s], next, node.touches[facet]);
        }
        if (fate == Fate::kEnds)
            keys[s] = joined(keys[s], index, visible_[s].triangle);
        else if (fate == Fate::kUnknown)
            keys[s] = kAlone;
        else
            goes_on_[index][s] = 1;
    }
}

void HistoryKeys::join(const PreparedScene& objects, Id index, std::span<FragmentKey> keys) {
    const PathNode& node = drawn_.paths.nodes[index];
    const std::span<const char> came =
        node.parent == kNone ? std::span<const char>() : std::span<const char>(goes_on_[node.parent]);
    const FacetSamples owned =
        group_by_facet(owners_of_node(node, drawn_.leaf, came), node.mesh.facets.size());
    if (owned.sample.empty()) return;
    visible_.assign(drawn_.grid.size(), Visible());
    find_visible(objects, node.mesh, owned, drawn_.grid, visible_);
    goes_on_[index].assign(drawn_.grid.size(), 0);
    parallel_for(node.mesh.facets.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f)
            if (!owned.of(f).empty()) join_facet(index, f, owned.of(f), keys);
    });
}

bool surely_before(const Visible& one, const Visible& other) {
    constexpr float kRoomInT = 1e-6f;  // of t: what kDepthTie and the rounding of bounds take up
    return one.t_high < other.t_low - kRoomInT * std::fabs(other.t_low);
}

namespace {

constexpr std::size_t kRunsTogether = 4, kSamplesTogether = 4096;

/// Calls body(first sample of the part, that of the grid, count) for runs of all of a part's samples, by many
/// threads.
template <typename Body>
void for_each_part(const SampleGrid& part, const SampleGrid& grid, const Body& body) {
    if (!part.chosen.empty()) {
        parallel_for(part.size(), kSamplesTogether,
                     [&](std::size_t from, std::size_t to) { body(from, from, to - from); });
        return;
    }
    const std::size_t run = part.size() / part.runs();
    parallel_for(part.runs(), kRunsTogether, [&](std::size_t from, std::size_t to) {
        for (std::size_t y = from; y < to; ++y) body(y * run, part.sample_in(grid, y * run), run);
    });
}

class KeyFinder {
  public:
    KeyFinder(const FragmentKeysParams& params, const SampleGrid& grid)
        : params_(params), grid_(grid), first_(grid.size()), alone_(grid.size(), 0) {}

    void find(std::span<FragmentKey> keys);

  private:
    void see_objects(const FacetSamples& owned, std::span<FragmentKey> keys);
    void see_optic(std::size_t index, const FacetSamples& owned);
    void meet_optic(std::size_t index, const Visible& seen, std::size_t sample);
    void set_apart_by_ray(const FacetSamples& owned);
    void set_apart_rims();
    void follow_optic(std::size_t index, std::span<FragmentKey> keys) const;

    /// Along the camera's rays as far as its far plane.
    double reach() const { return params_.frame.camera.far_depth - params_.frame.camera.near_depth; }
    Ray camera_ray(std::size_t sample) const;

    const FragmentKeysParams& params_;
    const SampleGrid& grid_;
    std::vector<FirstSeen> first_;
    std::vector<char> alone_;
    std::vector<Id> camera_facet_;  // per sample, where rays are asked for
};

/// What the camera sees of the objects; samples without a ray have their key.
void KeyFinder::see_objects(const FacetSamples& owned, std::span<FragmentKey> keys) {
    std::fill(keys.begin(), keys.end(), kNoRay);
    std::vector<Visible> visible(grid_.size());
    find_visible(prepared_objects(params_.world), params_.frame.camera.mesh, owned, grid_, visible);
    for (std::size_t f = 0; f < params_.frame.camera.mesh.facets.size(); ++f) {
        if (!params_.frame.camera.mesh.has_rays(f)) continue;
        const std::span<const Id> samples = owned.of(f);
        parallel_for(samples.size(), 1024, [&](std::size_t from, std::size_t to) {
            for (const Id s : samples.subspan(from, to - from)) {
                keys[s] = key_of_object(kNone);
                const Visible& seen = visible[s];
                if (!seen.seen() || seen.t_low > reach()) continue;
                if (seen.t_high > reach()) alone_[s] = 1;
                first_[s].seen = seen;
            }
        });
    }
}

Ray KeyFinder::camera_ray(std::size_t sample) const {
    const RayMesh& mesh = params_.frame.camera.mesh;
    const Id facet = camera_facet_[sample];
    return sample_ray(mesh, facet, facet_weights(mesh, facet), grid_.position(sample));
}

void KeyFinder::meet_optic(std::size_t index, const Visible& seen, std::size_t sample) {
    FirstSeen& first = first_[sample];
    if (seen.t_high > reach()) alone_[sample] = 1;
    if (first.seen.seen()) {
        const bool before = surely_before(seen, first.seen);
        if (!before && !surely_before(first.seen, seen)) alone_[sample] = 1;
        if (params_.rims.limit != kAnyError &&
            may_change_order(
                {params_.world, params_.frame, params_.rims, reach()}, camera_ray(sample),
                {static_cast<Id>(index), seen.triangle, 0.5 * (seen.t_low + seen.t_high)},
                {first.optic, first.seen.triangle, 0.5 * (first.seen.t_low + first.seen.t_high)}))
            alone_[sample] = 1;
        if (!before) return;
    }
    first = {seen, static_cast<Id>(index)};
}

void KeyFinder::see_optic(std::size_t index, const FacetSamples& owned) {
    const SampleGrid part = part_in(grid_, params_.windows[index]);
    if (part.size() == 0) return;
    const RayMesh& mesh = params_.frame.camera.mesh;
    std::vector<Visible> visible(part.size());
    const PreparedScene& facets = params_.frame.optics[index].facets->prepared();
    if (part.size() == grid_.size())
        find_visible(facets, mesh, owned, part, visible);
    else
        find_visible(facets, mesh, rasterize_facets(mesh, part), part, visible);
    for_each_part(part, grid_, [&](std::size_t here, std::size_t there, std::size_t count) {
        for (std::size_t x = 0; x < count; ++x) {
            const Visible& seen = visible[here + x];
            if (seen.seen() && seen.t_low <= reach()) meet_optic(index, seen, there + x);
        }
    });
}

/// Samples whose rays start in media of their own.
void KeyFinder::set_apart_by_ray(const FacetSamples& owned) {
    const CameraMedia& media = params_.frame.camera_media;
    if (!media.by_ray) return;
    for_each_camera_ray(params_.frame.camera.mesh, owned, grid_, [&](Id s, Id, const Ray& ray) {
        for (const Box& box : media.boxes)
            if (box.holds(ray.origin)) alone_[s] = 1;
    });
}

/// Samples near outlines that are off: the exact surfaces decide what they see.
void KeyFinder::set_apart_rims() {
    if (params_.rims.limit == kAnyError) return;
    std::vector<char> near(grid_.size());
    for (std::size_t i = 0; i < params_.rims.edges.size(); ++i) {
        std::fill(near.begin(), near.end(), 0);
        mark_near_outline(params_.rims.edges[i], params_.rims.limit, grid_, near);
        for (std::size_t s = 0; s < near.size(); ++s) alone_[s] = alone_[s] || near[s];
    }
}

/// Joins the histories of an optic's samples.
void KeyFinder::follow_optic(std::size_t index, std::span<FragmentKey> keys) const {
    const SampleGrid part = part_in(grid_, params_.windows[index]);
    if (part.size() == 0) return;
    const OpticPaths& paths = params_.paths[index].paths();
    const FramedOptic& framed = params_.frame.optics[index];
    std::vector<Id> owner(part.size(), kNone);
    std::vector<FragmentKey> joint(part.size(), kAlone);
    const std::vector<Id>& face = framed.facets->grid().facet_face;
    for_each_part(part, grid_, [&](std::size_t here, std::size_t there, std::size_t count) {
        for (std::size_t x = 0; x < count; ++x) {
            const FirstSeen& first = first_[there + x];
            if (first.optic != index || alone_[there + x]) continue;
            const std::size_t s = here + x;
            owner[s] = paths.is_on_film() ? film_facet(paths.window, part.position(s))
                       : framed.film_grid ? framed.mesh_facet(first.seen.triangle, part.position(s))
                                          : first.seen.triangle;
            joint[s] = key_of_optic(static_cast<Id>(index), face[first.seen.triangle]);
        }
    });

    const FacetSamples owned = group_by_facet(owner, paths.outline.facets.size());
    const std::vector<Id> seen = seen_facets(owned);
    if (seen.empty()) return;
    if (params_.nested[index]) params_.nested[index]->build();
    params_.paths[index].prepare(seen);
    std::vector<Id> leaf = leaves_of_samples(paths, owned, part);
    parallel_for(leaf.size(), 4096, [&](std::size_t from, std::size_t to) {
        for (std::size_t s = from; s < to; ++s) {
            if (leaf[s] == kNone) continue;
            const PathLeaf& shown = paths.leaves[leaf[s]];
            if (shown.method != LeafMethod::kTraced && !shown.layered) continue;
            leaf[s] = kNone;
            joint[s] = kAlone;
        }
    });
    HistoryKeys histories({paths, part, leaf});
    for (const Id node : nodes_in_order(paths)) histories.join(prepared_objects(params_.world), node, joint);
    for_each_part(part, grid_, [&](std::size_t here, std::size_t there, std::size_t count) {
        for (std::size_t x = 0; x < count; ++x)
            if (first_[there + x].optic == index) keys[there + x] = joint[here + x];
    });
}

void KeyFinder::find(std::span<FragmentKey> keys) {
    const FacetSamples owned = rasterize_facets(params_.frame.camera.mesh, grid_);
    if (params_.rims.limit != kAnyError) {
        camera_facet_.assign(grid_.size(), kNone);
        for (std::size_t f = 0; f + 1 < owned.first.size(); ++f)
            for (const Id s : owned.of(f)) camera_facet_[s] = static_cast<Id>(f);
    }
    see_objects(owned, keys);
    for (std::size_t i = 0; i < params_.frame.optics.size(); ++i) see_optic(i, owned);
    set_apart_by_ray(owned);
    set_apart_rims();
    parallel_for(keys.size(), 4096, [&](std::size_t from, std::size_t to) {
        for (std::size_t s = from; s < to; ++s)
            if (first_[s].optic == kNone && first_[s].seen.seen())
                keys[s] = key_of_object(first_[s].seen.triangle);
    });
    for (std::size_t i = 0; i < params_.frame.optics.size(); ++i) follow_optic(i, keys);
    for (std::size_t s = 0; s < keys.size(); ++s)
        if (alone_[s]) keys[s] = kAlone;
}

}  // namespace

void find_fragment_keys(const FragmentKeysParams& params, const SampleGrid& grid,
                        std::span<FragmentKey> keys) {
    KeyFinder(params, grid).find(keys);
}

}  // namespace trilens
