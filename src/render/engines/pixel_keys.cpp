// Keys of whole pixels: what all samples of a pixel surely see, by bounds over the pixel. After: Hanrahan and
// Heckbert, Beam Tracing Polygonal Objects, SIGGRAPH 1984 (coherence of beams); Akeley, RealityEngine
// Graphics, 1993.
#include <algorithm>
#include <array>
#include <atomic>
#include <unordered_map>

#include "base/raymesh/rasterize.h"
#include "base/util/parallel.h"
#include "render/engines/border_pixels.h"
#include "render/engines/fragment_keys.h"
#include "render/engines/path_ends.h"

namespace trilens {
namespace {

constexpr std::size_t kPixelsTogether = 1024;

/// The outermost samples of a pixel of a grid, which numbers its pixels in rows.
class PixelCorners {
  public:
    explicit PixelCorners(const SampleGrid& grid)
        : x0_(grid.x0),
          y0_(grid.y0),
          width_(static_cast<std::size_t>(grid.width())),
          low_(0.5 / grid.side),
          high_((grid.side - 0.5) / grid.side) {}

    std::array<Vec2, 4> of(std::size_t pixel) const {
        const double x = x0_ + static_cast<double>(pixel % width_),
                     y = y0_ + static_cast<double>(pixel / width_);
        return {Vec2(x + low_, y + low_), Vec2(x + high_, y + low_), Vec2(x + low_, y + high_),
                Vec2(x + high_, y + high_)};
    }

    /// What value(corner) is at all corners; none: it is not the same. The samples between lie in their hull.
    template <typename Value>
    std::optional<Id> common(std::size_t pixel, const Value& value) const {
        const std::array<Vec2, 4> corner = of(pixel);
        const Id first = value(corner[0]);
        for (std::size_t k = 1; k < 4; ++k)
            if (value(corner[k]) != first) return std::nullopt;
        return first;
    }

  private:
    int x0_, y0_;
    std::size_t width_;
    double low_, high_;
};

Vec3 shares_at(const FacetWeights& weights, const Vec2& at) {
    const Vec3 e = weights.unnormalised(at.x, at.y);
    return e / (e.x + e.y + e.z);
}

/// As HistoryKeys, of pixels. `leaf`: per pixel of `part`.
class PixelHistories {
  public:
    PixelHistories(const OpticPaths& paths, const SampleGrid& part, const std::vector<Id>& leaf)
        : paths_(paths), part_(part), corners_(part), leaf_(leaf), goes_on_(paths.nodes.size()) {}

    /// kAlone where the pixel's samples may differ. Parents first.
    void join(const PreparedScene& objects, Id node, std::span<FragmentKey> keys);

  private:
    void join_facet(Id node, std::size_t facet, std::span<const Id> pixels, std::span<FragmentKey> keys);

    const OpticPaths& paths_;
    const SampleGrid& part_;
    const PixelCorners corners_;
    const std::vector<Id>& leaf_;
    std::vector<std::vector<char>> goes_on_;  // per node and pixel
    std::vector<Visible> visible_;            // per pixel, of the node
};

void PixelHistories::join_facet(Id index, std::size_t facet, std::span<const Id> pixels,
                                std::span<FragmentKey> keys) {
    const PathNode& node = paths_.nodes[index];
    const FacetWeights weights = facet_weights(node.mesh, facet);
    const IdTriple& corner = node.mesh.facets[facet];
    // A quotient of linear functions is largest and smallest at corners, where the denominator keeps its
    // sign.
    const auto fate_at = [&](const Vec2& at, const Visible& seen) {
        const Vec3 share = shares_at(weights, at);
        double next = 0;
        for (int k = 0; k < 3; ++k) next += share[k] * node.next[corner[static_cast<std::size_t>(k)]];
        return fate_before_next(seen, next, node.touches[facet]);
    };
    for (const Id p : pixels) {
        if (keys[p] == kAlone) continue;
        const Visible& seen = visible_[p];
        std::optional<Id> fate;
        if (!weights.edge_on && seen.triangle != kSeveral)
            fate = node.ends[facet] ? static_cast<Id>(Fate::kEnds) : corners_.common(p, [&](const Vec2& at) {
                return static_cast<Id>(fate_at(at, seen));
            });
        if (fate == static_cast<Id>(Fate::kEnds))
            keys[p] = joined(keys[p], index, seen.triangle);
        else if (fate == static_cast<Id>(Fate::kGoesOn))
            goes_on_[index][p] = 1;
        else
            keys[p] = kAlone;
    }
}

void PixelHistories::join(const PreparedScene& objects, Id index, std::span<FragmentKey> keys) {
    const PathNode& node = paths_.nodes[index];
    const std::span<const char> came =
        node.parent == kNone ? std::span<const char>() : std::span<const char>(goes_on_[node.parent]);
    const FacetSamples owned = group_by_facet(owners_of_node(node, leaf_, came), node.mesh.facets.size());
    if (owned.sample.empty()) return;
    visible_.assign(keys.size(), Visible{kSeveral});
    find_visible_by_pixel(objects, node.mesh, owned, part_, visible_);
    goes_on_[index].assign(keys.size(), 0);
    parallel_for(node.mesh.facets.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f)
            if (!owned.of(f).empty()) join_facet(index, f, owned.of(f), keys);
    });
}

/// As KeyFinder, of pixels.
class PixelKeyFinder {
  public:
    PixelKeyFinder(const FragmentKeysParams& params, const SampleGrid& grid)
        : params_(params), grid_(grid), first_(grid.pixels()), open_(grid.pixels(), 0) {}

    void find(std::span<FragmentKey> keys);

  private:
    void see_objects(const FacetSamples& owned);
    void see_optic(std::size_t index, const FacetSamples& owned);
    void meet_optic(std::size_t index, const Visible& seen, std::size_t pixel);
    void join_borders(std::size_t index, const SampleGrid& part, std::span<const PixelTriangle> open,
                      std::span<Visible> visible);
    void follow_optic(std::size_t index, std::span<FragmentKey> keys) const;
    bool set_owners(std::size_t index, std::size_t turn, const SampleGrid& part, const PixelCorners& corners,
                    std::vector<Id>& owner, std::vector<FragmentKey>& joint) const;
    std::optional<Id> owner_of(std::size_t index, const PixelCorners& corners, std::size_t pixel,
                               Id seen) const;
    void find_leaves(std::size_t index, const FacetSamples& owned, const PixelCorners& corners,
                     std::vector<Id>& leaf) const;
    /// Calls body(pixel of the part, pixel of the grid) for all of a part's.
    template <typename Body>
    void for_each_pixel(const SampleGrid& part, const Body& body) const;

    double reach() const { return params_.frame.camera.far_depth - params_.frame.camera.near_depth; }

    const FragmentKeysParams& params_;
    const SampleGrid& grid_;
    std::vector<FirstSeen> first_;
    std::vector<char> open_;        // samples may see several things
    std::vector<Id> camera_facet_;  // per pixel, of linear cameras
    // Pixels (of the grid) that see several facets of one optic together, by optic.
    std::vector<std::unordered_map<std::size_t, std::vector<Id>>> borders_;
};

template <typename Body>
void PixelKeyFinder::for_each_pixel(const SampleGrid& part, const Body& body) const {
    const std::size_t across = static_cast<std::size_t>(part.width()),
                      of_grid = static_cast<std::size_t>(grid_.width()),
                      left = static_cast<std::size_t>(part.x0 - grid_.x0),
                      top = static_cast<std::size_t>(part.y0 - grid_.y0);
    parallel_for(static_cast<std::size_t>(part.height()), 8, [&](std::size_t from, std::size_t to) {
        for (std::size_t y = from; y < to; ++y)
            for (std::size_t x = 0; x < across; ++x) body(y * across + x, (y + top) * of_grid + left + x);
    });
}

void PixelKeyFinder::see_objects(const FacetSamples& owned) {
    const RayMesh& mesh = params_.frame.camera.mesh;
    std::vector<Visible> visible(grid_.pixels(), Visible{kSeveral});
    find_visible_by_pixel(prepared_objects(params_.world), mesh, owned, grid_, visible);
    parallel_for(visible.size(), kPixelsTogether, [&](std::size_t from, std::size_t to) {
        for (std::size_t p = from; p < to; ++p) {
            const Visible& seen = visible[p];
            if (seen.triangle == kSeveral || (seen.seen() && seen.t_low <= reach() && seen.t_high > reach()))
                open_[p] = 1;
            else if (seen.seen() && seen.t_low <= reach())
                first_[p].seen = seen;
        }
    });
}

void PixelKeyFinder::meet_optic(std::size_t index, const Visible& seen, std::size_t pixel) {
    FirstSeen& first = first_[pixel];
    if (seen.triangle == kSeveral || seen.t_high > reach()) open_[pixel] = 1;
    if (open_[pixel]) return;
    if (first.seen.seen()) {
        const bool before = surely_before(seen, first.seen);
        if (!before && !surely_before(first.seen, seen)) open_[pixel] = 1;
        if (!before) return;
    }
    first = {seen, static_cast<Id>(index)};
}

void PixelKeyFinder::see_optic(std::size_t index, const FacetSamples& owned) {
    const SampleGrid part = part_in(grid_, params_.windows[index]);
    if (part.size() == 0) return;
    const RayMesh& mesh = params_.frame.camera.mesh;
    const PreparedScene& facets = params_.frame.optics[index].facets->prepared();
    std::vector<Visible> visible(part.pixels(), Visible{kSeveral});
    std::vector<PixelTriangle> open;
    std::vector<PixelTriangle>* const asked = camera_facet_.empty() ? nullptr : &open;
    if (part.size() == grid_.size())
        find_visible_by_pixel(facets, mesh, owned, part, visible, asked);
    else
        find_visible_by_pixel(facets, mesh, pixels_in_facets(mesh, part), part, visible, asked);
    join_borders(index, part, open, visible);
    for_each_pixel(part, [&](std::size_t here, std::size_t there) {
        const Visible& seen = visible[here];
        if (seen.triangle == kSeveral || (seen.seen() && seen.t_low <= reach()))
            meet_optic(index, seen, there);
    });
}

/// Pixels that see some facets together count as if they saw the first of them.
void PixelKeyFinder::join_borders(std::size_t index, const SampleGrid& part,
                                  std::span<const PixelTriangle> open, std::span<Visible> visible) {
    const RayMesh& mesh = params_.frame.camera.mesh;
    const SurfaceGrid& grid = params_.frame.optics[index].facets->grid();
    const PixelCorners corners(part);
    const std::size_t across = static_cast<std::size_t>(part.width());
    for (std::size_t first = 0, last = 0; first < open.size(); first = last) {
        const std::size_t pixel = open[first].pixel;
        while (last < open.size() && open[last].pixel == pixel) ++last;
        const std::size_t in_grid = (pixel / across + static_cast<std::size_t>(part.y0 - grid_.y0)) *
                                        static_cast<std::size_t>(grid_.width()) +
                                    pixel % across + static_cast<std::size_t>(part.x0 - grid_.x0);
        const Id facet = camera_facet_[in_grid];
        if (facet == kNone || open_[in_grid]) continue;
        const FacetWeights weights = facet_weights(mesh, facet);
        std::array<Ray, 4> rays;
        const std::array<Vec2, 4> places = corners.of(pixel);
        for (std::size_t k = 0; k < 4; ++k) rays[k] = sample_ray(mesh, facet, weights, places[k]);
        std::optional<JointFacets> joint = joint_facets(grid, open.subspan(first, last - first), rays);
        if (!joint) continue;
        visible[pixel] = joint->seen;
        borders_[index][in_grid] = std::move(joint->facets);
    }
}

/// The facet of the optic's paths that all samples of the pixel lie in, all of which see facet `seen`.
std::optional<Id> PixelKeyFinder::owner_of(std::size_t index, const PixelCorners& corners, std::size_t pixel,
                                           Id seen) const {
    const OpticPaths& paths = params_.paths[index].paths();
    if (paths.is_on_film())
        return corners.common(pixel, [&](const Vec2& at) { return film_facet(paths.window, at); });
    if (params_.frame.optics[index].film_grid) return std::nullopt;
    return seen;
}

void PixelKeyFinder::find_leaves(std::size_t index, const FacetSamples& owned, const PixelCorners& corners,
                                 std::vector<Id>& leaf) const {
    const OpticPaths& paths = params_.paths[index].paths();
    parallel_for(paths.outline.facets.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f) {
            if (owned.of(f).empty()) continue;
            const Id facet = static_cast<Id>(f);
            const FacetWeights weights = facet_weights(paths.outline, f);
            const bool one = paths.is_whole(facet) || weights.edge_on;
            for (const Id p : owned.of(f)) {
                const std::optional<Id> own =
                    one ? leaf_at(paths, facet, Vec3(1.0 / 3)) : corners.common(p, [&](const Vec2& at) {
                        return leaf_at(paths, facet, shares_at(weights, at));
                    });
                if (!own) continue;
                const PathLeaf& shown = paths.leaves[*own];
                if (shown.method != LeafMethod::kTraced && !shown.layered) leaf[p] = *own;
            }
        }
    });
}

/// The owners of the optic's pixels; where they see several facets, the one whose turn it is. False: there
/// are none.
bool PixelKeyFinder::set_owners(std::size_t index, std::size_t turn, const SampleGrid& part,
                                const PixelCorners& corners, std::vector<Id>& owner,
                                std::vector<FragmentKey>& joint) const {
    const std::vector<Id>& face = params_.frame.optics[index].facets->grid().facet_face;
    const auto& borders = borders_[index];
    owner.assign(part.pixels(), kNone);
    joint.assign(part.pixels(), kAlone);
    std::atomic<bool> any = false;
    for_each_pixel(part, [&](std::size_t here, std::size_t there) {
        const FirstSeen& first = first_[there];
        if (first.optic != index || open_[there]) return;
        Id facet = first.seen.triangle;
        const auto border = borders.empty() ? borders.end() : borders.find(there);
        if (turn > 0 && (border == borders.end() || turn >= border->second.size())) return;
        if (border != borders.end()) facet = border->second[turn];
        const std::optional<Id> own = owner_of(index, corners, here, facet);
        if (!own) return;
        owner[here] = *own;
        joint[here] = key_of_optic(static_cast<Id>(index), face[facet]);
        any = true;
    });
    return any;
}

/// Joins the histories of an optic's pixels: where they see several facets, over each of them.
void PixelKeyFinder::follow_optic(std::size_t index, std::span<FragmentKey> keys) const {
    const SampleGrid part = part_in(grid_, params_.windows[index]);
    if (part.size() == 0) return;
    const OpticPaths& paths = params_.paths[index].paths();
    const PixelCorners corners(part);
    std::vector<Id> owner;
    std::vector<FragmentKey> joint;
    for (std::size_t turn = 0; set_owners(index, turn, part, corners, owner, joint); ++turn) {
        const FacetSamples owned = group_by_facet(owner, paths.outline.facets.size());
        if (params_.nested[index]) params_.nested[index]->build();
        params_.paths[index].prepare(seen_facets(owned));
        std::vector<Id> leaf(part.pixels(), kNone);
        find_leaves(index, owned, corners, leaf);
        for (std::size_t p = 0; p < leaf.size(); ++p)
            if (leaf[p] == kNone) joint[p] = kAlone;
        PixelHistories histories(paths, part, leaf);
        for (const Id node : nodes_in_order(paths))
            histories.join(prepared_objects(params_.world), node, joint);
        for_each_pixel(part, [&](std::size_t here, std::size_t there) {
            if (owner[here] == kNone) return;
            keys[there] = turn == 0 || keys[there] == joint[here] ? joint[here] : kAlone;
        });
    }
}

void PixelKeyFinder::find(std::span<FragmentKey> keys) {
    const FacetSamples owned = pixels_in_facets(params_.frame.camera.mesh, grid_);
    see_objects(owned);
    borders_.resize(params_.frame.optics.size());
    if (params_.frame.camera.linear) {
        camera_facet_.assign(grid_.pixels(), kNone);
        for (std::size_t f = 0; f + 1 < owned.first.size(); ++f)
            for (const Id p : owned.of(f)) camera_facet_[p] = static_cast<Id>(f);
    }
    for (std::size_t i = 0; i < params_.frame.optics.size(); ++i) see_optic(i, owned);
    for (std::size_t p = 0; p < keys.size(); ++p)
        if (first_[p].optic == kNone) keys[p] = key_of_object(first_[p].seen.triangle);
    for (std::size_t i = 0; i < params_.frame.optics.size(); ++i) follow_optic(i, keys);
    for (std::size_t p = 0; p < keys.size(); ++p)
        if (open_[p]) keys[p] = kAlone;
}

}  // namespace

void find_pixel_keys(const FragmentKeysParams& params, const SampleGrid& grid, std::span<FragmentKey> keys) {
    std::fill(keys.begin(), keys.end(), kAlone);
    // Outlines and media are decided sample by sample.
    if (params.rims.limit != kAnyError || params.frame.camera_media.by_ray) return;
    PixelKeyFinder(params, grid).find(keys);
}

}  // namespace trilens
