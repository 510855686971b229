// First hits: Embree's tree for candidates, the watertight test in double for the answer.
#include "intersect/tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/util/check.h"
#include "base/util/parallel.h"
#include "intersect/box_tree.h"
#include "intersect/triangle_hit.h"

namespace trilens {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kSamplesPerTask = 256;
constexpr std::size_t kTrianglesPerTask = 4096;

/// Triangles that share a box: one, or two that follow each other in the scene and lie close.
struct Group {
    Id first = kNone;
    Id count = 0;
};

std::array<Vec3, 3> corners_of(const TriangleScene& scene, std::size_t triangle) {
    const IdTriple& corner = scene.triangles[triangle];
    return {scene.points[corner[0]], scene.points[corner[1]], scene.points[corner[2]]};
}

Box box_of(const std::array<Vec3, 3>& corner) {
    const auto& [a, b, c] = corner;
    return {glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c))};
}

/// Whether two triangles are met in fewer steps in one box: a box costs a ray about as much as a triangle,
/// and is met as often as its surface is large.
bool share_a_box(const Box& a, const Box& b, const Box& both) {
    return 3 * both.half_area() <= 2 * (a.half_area() + b.half_area());
}

struct Groups {
    std::vector<Group> groups;
    std::vector<Box> boxes;

    /// Adds the triangles [first, last) that can be seen.
    void add(const TriangleScene& scene, std::size_t first, std::size_t last) {
        Box before;  // of the triangle before, where its group has room
        bool open = false;
        for (std::size_t i = first; i < last; ++i) {
            const std::array<Vec3, 3> corner = corners_of(scene, i);
            const bool seen = !has_no_area(corner);
            const Box box = seen ? box_of(corner) : Box{};
            Box both = before;
            both.include(box);
            if (seen && open && share_a_box(before, box, both)) {
                groups.back().count = 2;
                boxes.back() = both;
                open = false;
                continue;
            }
            if (seen) groups.push_back({static_cast<Id>(i), 1}), boxes.push_back(box);
            before = box, open = seen;
        }
    }
};

Groups group_triangles(const TriangleScene& scene) {
    for (const IdTriple& triangle : scene.triangles)
        for (const Id corner : triangle)
            TRILENS_CHECK(corner < scene.points.size(), "a corner must be a point of the scene");
    // Stretches of one length whatever the number of threads: the same groups.
    std::vector<Groups> stretches((scene.size() + kTrianglesPerTask - 1) / kTrianglesPerTask);
    parallel_for(stretches.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t k = from; k < to; ++k)
            stretches[k].add(scene, k * kTrianglesPerTask,
                             std::min(scene.size(), (k + 1) * kTrianglesPerTask));
    });
    Groups all;
    for (Groups& stretch : stretches) {
        all.groups.insert(all.groups.end(), stretch.groups.begin(), stretch.groups.end());
        all.boxes.insert(all.boxes.end(), stretch.boxes.begin(), stretch.boxes.end());
        stretch = {};
    }
    return all;
}

/// The largest t that is one depth with `t` (which is >= 0 or just below).
double tie_end(double t) {
    return t + kDepthTie * std::fabs(t);
}

}  // namespace

struct Tracer::Data {
    std::shared_ptr<const TriangleScene> scene;
    std::vector<Group> groups;
    BoxTree tree;

    Data(std::shared_ptr<const TriangleScene> triangles, Groups grouped, const std::string& isa)
        : scene(std::move(triangles)), groups(std::move(grouped.groups)), tree(grouped.boxes, isa) {}

    IdTriple order(Id triangle) const {
        return {scene->object[triangle], scene->primitive[triangle], triangle};
    }

    /// Calls use(triangle, hit) for hits with t >= t_min; it returns the t beyond which hits no longer
    /// matter.
    template <typename Use>
    void for_each_hit(const Ray& ray, double t_min, double t_max, Use&& use) const {
        const ShearedRay sheared(ray);
        double t_far = t_max;
        tree.visit(ray, t_min, t_max, [&](Id index) {
            const Group& group = groups[index];
            for (Id triangle = group.first; triangle < group.first + group.count; ++triangle) {
                const std::optional<TriangleHit> hit = sheared.meet(corners_of(*scene, triangle));
                if (hit && hit->t >= t_min && hit->t <= t_far) t_far = use(triangle, *hit);
            }
            return t_far;
        });
    }
};

Tracer::Tracer(std::shared_ptr<const TriangleScene> scene, const std::string& isa) {
    TRILENS_CHECK(scene->object.size() == scene->size() && scene->primitive.size() == scene->size(),
                  "one object and one primitive per triangle");
    Groups grouped = group_triangles(*scene);
    data_ = std::make_unique<Data>(std::move(scene), std::move(grouped), isa);
}
Tracer::Tracer(TriangleScene scene, const std::string& isa)
    : Tracer(std::make_shared<const TriangleScene>(std::move(scene)), isa) {}
Tracer::~Tracer() = default;
Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;

Hit Tracer::first_hit(const Ray& ray, double t_min) const {
    // The smallest t, and whether any other hit came as near as a tie on the way there.
    Id seen = kNone;
    TriangleHit first{kInfinity, {}};
    bool tie = false;
    data_->for_each_hit(ray, t_min, kInfinity, [&](Id triangle, const TriangleHit& hit) {
        tie = tie || (seen != kNone && tie_end(std::min(hit.t, first.t)) >= std::max(hit.t, first.t));
        if (hit.t < first.t) first = hit, seen = triangle;
        return tie_end(first.t);
    });
    if (seen == kNone) return {};

    // Among all within the tie of the smallest, the one that comes first in the scene: no order of visits
    // shows.
    if (tie) {
        const double t_end = tie_end(first.t);
        data_->for_each_hit(ray, t_min, t_end, [&](Id triangle, const TriangleHit& hit) {
            if (data_->order(triangle) < data_->order(seen)) first = hit, seen = triangle;
            return t_end;
        });
    }
    return {seen, first.t, first.barycentric};
}

bool Tracer::occluded(const Ray& ray, double t_min, double t_max) const {
    bool found = false;
    data_->for_each_hit(ray, t_min, t_max, [&](Id, const TriangleHit& hit) {
        found = found || (hit.t > t_min && hit.t < t_max);
        return found ? -kInfinity : t_max;
    });
    return found;
}

Segments::Bits Tracer::occluded(const Segments& segments) const {
    // Most segments meet no box: a ray is made ready when it does.
    std::array<std::optional<ShearedRay>, Segments::kMost> sheared;
    return data_->tree.find(segments, [&](std::size_t segment, Id index) {
        if (!sheared[segment]) sheared[segment].emplace(segments.ray(segment));
        const Group& group = data_->groups[index];
        for (Id triangle = group.first; triangle < group.first + group.count; ++triangle) {
            const auto hit = sheared[segment]->meet(corners_of(*data_->scene, triangle));
            if (hit && hit->t > 0 && hit->t < 1) return true;
        }
        return false;
    });
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
