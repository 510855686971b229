// The slab test of Kay and Kajiya (Ray Tracing Complex Scenes, 1986), homogeneous: a sample's ray is known
// times its weight W, so that W x = O + t D is tested against W times the box.
#include "projector/scalar/scalar_engine.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/util/check.h"
#include "base/util/parallel.h"
#include "projector/exact/exact_hit.h"
#include "projector/scene/bvh.h"

namespace trilens {
namespace {

// A box is widened by this share of the coordinates involved. Rounding in the boxes, the rays and the
// decision who is hit stays below 64 units in the last place of them (1.4e-14).
constexpr double kBoxSlack = 1e-13;
// A hit's t is off by less than this share of itself: kLeastDeterminant lets 2^30 units in the last place in.
constexpr double kTimeSlack = 1e-5;

/// The smallest t >= 0 at which the ray is in the box, whose coordinates are the ray's; none where it misses.
std::optional<double> enter_box(const SampleRay& ray, const Box& box) {
    const Vec3 a = ray.weight * box.low, b = ray.weight * box.high;
    const double slack = kBoxSlack * (largest_part(a) + largest_part(b) + largest_part(ray.origin));
    double first = 0, last = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const double low = std::min(a[axis], b[axis]) - slack - ray.origin[axis],
                     high = std::max(a[axis], b[axis]) + slack - ray.origin[axis];
        if (ray.direction[axis] == 0) {
            if (low > 0 || high < 0) return std::nullopt;
            continue;
        }
        const double t0 = low / ray.direction[axis], t1 = high / ray.direction[axis];
        first = std::max(first, std::min(t0, t1));
        last = std::min(last, std::max(t0, t1));
    }
    if (first > last) return std::nullopt;
    return first;
}

/// enter_box() of many boxes of one scene: what does not depend on the box is worked out once.
class RaySlabs {
  public:
    RaySlabs(const SampleRay& ray, const Vec3& centre, const Box& bounds)
        : weight_(ray.weight), origin_(ray.origin + ray.weight * centre) {
        constexpr double kLeast = 1e-300;  // instead of 0, whose inverse times 0 is no number
        slack_ = kBoxSlack *
                 (2 * std::fabs(weight_) *
                      (std::max(largest_part(bounds.low), largest_part(bounds.high)) + largest_part(centre)) +
                  largest_part(ray.origin));
        for (int axis = 0; axis < 3; ++axis)
            inverse_[axis] = 1 / (ray.direction[axis] == 0 ? kLeast : ray.direction[axis]);
    }

    /// Whether the ray may be in the box at some 0 <= t <= until.
    bool meets(const Box& box, double until) const {
        double first = 0, last = until;
        for (int axis = 0; axis < 3; ++axis) {
            const double a = weight_ * box.low[axis] - origin_[axis],
                         b = weight_ * box.high[axis] - origin_[axis];
            const double t0 = (std::min(a, b) - slack_) * inverse_[axis],
                         t1 = (std::max(a, b) + slack_) * inverse_[axis];
            first = std::max(first, std::min(t0, t1));
            last = std::min(last, std::max(t0, t1));
        }
        return first * (1 - kTimeSlack) <= last;
    }

  private:
    double weight_, slack_ = 0;
    Vec3 origin_, inverse_{0};
};

/// A node of the tree that waits, and the smallest t at which the ray is in it.
struct OpenNode {
    Id node = 0;
    double enters = 0;
};

/// One ray on its way.
struct RayWalk {
    const PreparedScene::Data& scene;
    const SampleRay& ray;
    const Vec3& centre;
    FirstHit first{};

    void offer(Id triangle) {
        const std::optional<LineHit> hit =
            exact_hit(ray, {scene.corner(0, triangle, centre), scene.corner(1, triangle, centre),
                            scene.corner(2, triangle, centre)});
        if (hit) first.offer(*hit, triangle, scene.rank(triangle));
    }

    void offer_all() {
        for (std::size_t i = 0; i < scene.size(); ++i) offer(static_cast<Id>(i));
    }

    void walk(std::vector<OpenNode>& stack) {
        const Bvh& bvh = scene.bvh();
        const auto push = [&](Id node) {
            const Box& box = bvh.nodes[node].box;
            if (const auto enters = enter_box(ray, {box.low - centre, box.high - centre}))
                stack.push_back({node, *enters});
        };
        stack.clear();
        if (!bvh.nodes.empty()) push(0);
        while (!stack.empty()) {
            const OpenNode next = stack.back();
            stack.pop_back();
            if (next.enters * (1 - kTimeSlack) > first.limit()) continue;
            const BvhNode& node = bvh.nodes[next.node];
            for (Id i = node.first; i < node.first + node.count; ++i) offer(bvh.order[i]);
            if (node.count > 0) continue;
            // The nearer child is put on top, so that what it hides need not be looked at.
            const std::size_t before = stack.size();
            push(node.first);
            push(node.first + 1);
            if (stack.size() == before + 2 && stack[before].enters < stack[before + 1].enters)
                std::swap(stack[before], stack[before + 1]);
        }
    }

    /// Appends every triangle with 0 <= t <= until.
    void collect(double until, std::vector<OpenNode>& stack, std::vector<Crossing>& found) {
        const Bvh& bvh = scene.bvh();
        if (bvh.nodes.empty()) return;
        const RaySlabs slabs(ray, centre, bvh.nodes[0].box);
        const auto push = [&](Id node) {
            if (slabs.meets(bvh.nodes[node].box, until)) stack.push_back({node, 0});
        };
        stack.clear();
        push(0);
        while (!stack.empty()) {
            const BvhNode node = bvh.nodes[stack.back().node];
            stack.pop_back();
            for (Id i = node.first; i < node.first + node.count; ++i) cross(bvh.order[i], until, found);
            if (node.count > 0) continue;
            push(node.first);
            push(node.first + 1);
        }
    }

    void cross(Id triangle, double until, std::vector<Crossing>& found) const {
        const std::optional<LineHit> hit =
            exact_hit(ray, {scene.corner(0, triangle, centre), scene.corner(1, triangle, centre),
                            scene.corner(2, triangle, centre)});
        if (hit && hit->t >= 0 && hit->t <= until)
            found.push_back({scene.triangles[triangle].triangle(), hit->t});
    }

    template <typename Pass>
    Hit see(const Pass& pass) {
        pass();
        if (first.order_mattered()) first.begin_second_pass(), pass();
        return first.winner() == kNone ? Hit{} : scene_hit(scene, first.winner(), first.hit());
    }
};

Hit see_first(RayWalk ray, bool cull, std::vector<OpenNode>& stack) {
    return cull ? ray.see([&] { ray.walk(stack); }) : ray.see([&] { ray.offer_all(); });
}

}  // namespace

Hit first_hit_of(const PreparedScene::Data& scene, const SampleRay& ray, const Vec3& centre) {
    std::vector<OpenNode> stack;
    return see_first({scene, ray, centre}, true, stack);
}

namespace {

/// Calls use(f, weights, rays, samples) for some samples of a facet after the other, on threads: facets that
/// have rays and are not seen edge-on.
template <typename Use>
void for_each_facet(const RayMesh& mesh, const FacetSamples& owned, std::size_t samples_together, Use&& use) {
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        const std::span<const Id> samples = owned.of(f);
        if (!mesh.has_rays(f) || samples.empty()) continue;
        const FacetWeights weights = facet_weights(mesh, f);
        if (weights.edge_on) continue;
        const FacetRays rays = make_facet_rays({mesh, static_cast<Id>(f), weights});
        parallel_for(samples.size(), samples_together, [&](std::size_t from, std::size_t to) {
            use(f, weights, rays, samples.subspan(from, to - from));
        });
    }
}

}  // namespace

void draw_scalar(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                 const SampleGrid& grid, std::span<Hit> hits, bool cull) {
    const auto draw = [&](std::size_t, const FacetWeights&, const FacetRays& facet,
                          std::span<const Id> samples) {
        std::vector<OpenNode> stack;
        for (const Id sample : samples) {
            const SampleRay ray = facet.at(grid.position(sample));
            hits[sample] = see_first({scene.data(), ray, facet.centre}, cull, stack);
        }
    };
    for_each_facet(mesh, owned, 512, draw);
}

void find_crossings(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                    const SampleGrid& grid, std::span<const double> until, const TakeCrossings& take) {
    constexpr double kRoom = 1e-9;  // of the scene's size
    Box bounds;
    if (!scene.data().bvh().nodes.empty()) bounds = scene.data().bvh().nodes[0].box;
    const Vec3 room = kRoom * bounds.size();
    const auto may_start_inside = [&](const Vec3& start) {
        return Box{bounds.low - room, bounds.high + room}.holds(start);
    };
    TRILENS_CHECK(until.size() == grid.size(), "one length per sample of the grid");
    const auto collect = [&](std::size_t f, const FacetWeights& weights, const FacetRays& facet,
                             std::span<const Id> samples) {
        std::vector<OpenNode> stack;
        std::vector<Crossing> found;
        for (const Id sample : samples) {
            if (!(until[sample] > 0)) continue;
            const Vec2 position = grid.position(sample);
            const SampleRay ray = facet.at(position);
            RayWalk walk{scene.data(), ray, facet.centre};
            found.clear();
            walk.collect(until[sample], stack, found);
            std::sort(found.begin(), found.end(), [](const Crossing& a, const Crossing& b) {
                return a.t != b.t ? a.t < b.t : a.triangle < b.triangle;
            });
            if (found.empty() && may_start_inside(facet.centre + ray.origin / ray.weight))
                if (const Hit behind = see_first(walk, true, stack); behind.seen())
                    found.push_back({behind.triangle, behind.t});
            take(sample, sample_ray(mesh, f, weights, position), found);
        }
    };
    for_each_facet(mesh, owned, 64, collect);
}

}  // namespace trilens
