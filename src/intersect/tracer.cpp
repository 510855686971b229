// First hits: Embree's tree for candidates, the watertight test in double for the answer.
#include "intersect/tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/parallel.h"
#include "intersect/box_tree.h"
#include "intersect/triangle_hit.h"

namespace trilens {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kSamplesPerTask = 256;

/// A triangle that can be seen; its corners stand here, one cache line and a bit, and not behind indices.
struct Target {
    std::array<Vec3, 3> corner;
    Id triangle = kNone;
    Id object = kNone, primitive = kNone;

    IdTriple order() const { return {object, primitive, triangle}; }
};

std::vector<Target> make_targets(const TriangleScene& scene) {
    std::vector<Target> targets;
    targets.reserve(scene.size());
    for (std::size_t i = 0; i < scene.size(); ++i) {
        Target target;
        for (int k = 0; k < 3; ++k) {
            TRILENS_CHECK(scene.triangles[i][k] < scene.points.size(),
                          "a corner must be a point of the scene");
            target.corner[k] = scene.points[scene.triangles[i][k]];
        }
        if (has_no_area(target.corner)) continue;
        target.triangle = static_cast<Id>(i);
        target.object = scene.object[i];
        target.primitive = scene.primitive[i];
        targets.push_back(target);
    }
    return targets;
}

std::vector<Box> make_boxes(const std::vector<Target>& targets) {
    std::vector<Box> boxes;
    boxes.reserve(targets.size());
    for (const Target& target : targets) {
        const auto& [a, b, c] = target.corner;
        boxes.push_back({glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))});
    }
    return boxes;
}

/// The largest t that is one depth with `t` (which is >= 0 or just below).
double tie_end(double t) {
    return t + kDepthTie * std::fabs(t);
}

}  // namespace

struct Tracer::Data {
    std::vector<Target> targets;
    BoxTree tree;

    Data(std::vector<Target> seen, const std::string& isa)
        : targets(std::move(seen)), tree(make_boxes(targets), isa) {}

    /// Calls use(target, hit) for hits with t >= t_min; it returns the t beyond which hits no longer matter.
    template <typename Use>
    void for_each_hit(const Ray& ray, double t_min, double t_max, Use&& use) const {
        const ShearedRay sheared(ray);
        double t_far = t_max;
        tree.visit(ray, t_min, t_max, [&](Id index) {
            const Target& target = targets[index];
            const std::optional<TriangleHit> hit = sheared.meet(target.corner);
            if (hit && hit->t >= t_min && hit->t <= t_far) t_far = use(target, *hit);
            return t_far;
        });
    }
};

Tracer::Tracer(const TriangleScene& scene, const std::string& isa) {
    TRILENS_CHECK(scene.object.size() == scene.size() && scene.primitive.size() == scene.size(),
                  "one object and one primitive per triangle");
    data_ = std::make_unique<Data>(make_targets(scene), isa);
}
Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;

Hit Tracer::first_hit(const Ray& ray, double t_min) const {
    // The smallest t, and whether any other hit came as near as a tie on the way there.
    const Target* seen = nullptr;
    TriangleHit first{kInfinity, {}};
    bool tie = false;
    data_->for_each_hit(ray, t_min, kInfinity, [&](const Target& target, const TriangleHit& hit) {
        tie = tie || (seen && tie_end(std::min(hit.t, first.t)) >= std::max(hit.t, first.t));
        if (hit.t < first.t) first = hit, seen = &target;
        return tie_end(first.t);
    });
    if (!seen) return {};

    // Among all within the tie of the smallest, the one that comes first in the scene: no order of visits
    // shows.
    if (tie) {
        const double t_end = tie_end(first.t);
        data_->for_each_hit(ray, t_min, t_end, [&](const Target& target, const TriangleHit& hit) {
            if (target.order() < seen->order()) first = hit, seen = &target;
            return t_end;
        });
    }
    return {seen->triangle, first.t, first.barycentric};
}

bool Tracer::occluded(const Ray& ray, double t_min, double t_max) const {
    bool found = false;
    data_->for_each_hit(ray, t_min, t_max, [&](const Target&, const TriangleHit& hit) {
        found = found || (hit.t > t_min && hit.t < t_max);
        return found ? -kInfinity : t_max;
    });
    return found;
}

void trace_facets(const Tracer& tracer, const RayMesh& mesh, const FacetSamples& owned,
                  const SampleGrid& grid, std::span<Hit> hits) {
    TRILENS_CHECK(hits.size() == grid.size(), "one hit per sample");
    TRILENS_CHECK(owned.first.size() == mesh.facets.size() + 1, "samples grouped by the facets of this mesh");

    // Tasks are stretches of the samples in facet order: few large facets and many small ones share out
    // alike.
    parallel_for(owned.sample.size(), kSamplesPerTask, [&](std::size_t first, std::size_t last) {
        const auto after = std::upper_bound(owned.first.begin(), owned.first.end(), first);
        std::size_t facet = static_cast<std::size_t>(after - owned.first.begin()) - 1;
        for (std::size_t i = first; i < last; ++facet) {
            const std::size_t end = std::min(last, owned.first[facet + 1]);
            if (i < end && mesh.has_rays(facet)) {
                const FacetWeights weights = facet_weights(mesh, facet);
                for (std::size_t k = i; k < end; ++k) {
                    const Id s = owned.sample[k];
                    hits[s] = tracer.first_hit(sample_ray(mesh, facet, weights, grid.position(s)));
                }
            }
            i = std::max(i, end);
        }
    });
}

}  // namespace trilens
