#include "intersect/tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/raymesh/triangle_corners.h"
#include "base/util/check.h"
#include "base/util/parallel.h"
#include "intersect/box_tree.h"

namespace trilens {

// Watertight intersection in double: shear the ray onto an axis, then compare signed areas in two dimensions.

ShearedRay::ShearedRay(const Ray& ray) : origin_(ray.origin) {
    const Vec3 size = glm::abs(ray.direction);
    z_ = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    x_ = (z_ + 1) % 3;
    y_ = (z_ + 2) % 3;
    shear_x_ = ray.direction[x_] / ray.direction[z_];
    shear_y_ = ray.direction[y_] / ray.direction[z_];
    scale_z_ = 1 / ray.direction[z_];
}

std::optional<TriangleHit> ShearedRay::meet(const std::array<Vec3, 3>& corner) const {
    // Corners relative to the ray's origin, sheared so that the ray is the z axis. Each corner by itself, so
    // that triangles which share it get the same bits.
    std::array<Vec3, 3> p;
    for (int k = 0; k < 3; ++k) {
        const Vec3 local = corner[k] - origin_;
        p[k] = {local[x_] - shear_x_ * local[z_], local[y_] - shear_y_ * local[z_], local[z_]};
    }

    // Twice the signed areas of the origin with each edge; a corner's weight is the area opposite to it.
    const double area0 = p[2].x * p[1].y - p[2].y * p[1].x;
    const double area1 = p[0].x * p[2].y - p[0].y * p[2].x;
    const double area2 = p[1].x * p[0].y - p[1].y * p[0].x;
    const bool any_negative = area0 < 0 || area1 < 0 || area2 < 0;
    const bool any_positive = area0 > 0 || area1 > 0 || area2 > 0;
    if (any_negative && any_positive) return std::nullopt;
    const double area = area0 + area1 + area2;
    if (!(area != 0) || !std::isfinite(area)) return std::nullopt;

    const Vec3 weight = Vec3(area0, area1, area2) / area;
    const double t = scale_z_ * (weight.x * p[0].z + weight.y * p[1].z + weight.z * p[2].z);
    if (!std::isfinite(t)) return std::nullopt;
    return TriangleHit{t, {weight.y, weight.z}};
}

bool has_no_area(const std::array<Vec3, 3>& corner) {
    const Vec3 a = corner[1] - corner[0], b = corner[2] - corner[0];
    const double area = length(cross(a, b)), bound = length(a) * length(b);
    // Four roundings of relative size epsilon go into each component of the cross product.
    return !(area > 4 * std::numeric_limits<double>::epsilon() * bound) || !std::isfinite(bound);
}

// The inside by areas, else the nearest of three edges.

NearestToOrigin nearest_to_origin(const PlaneTriangle& p) {
    const Vec3 areas(cross(p[1], p[2]), cross(p[2], p[0]), cross(p[0], p[1]));
    const double sum = areas.x + areas.y + areas.z;
    const Vec3 weights = areas / sum;
    if (sum != 0 && weights.x >= 0 && weights.y >= 0 && weights.z >= 0) return {weights, 0};

    NearestToOrigin best;
    for (int k = 0; k < 3; ++k) {
        const Vec2 a = p[k], edge = p[(k + 1) % 3] - a;
        const double size_2 = dot(edge, edge);
        const double share = size_2 > 0 ? std::clamp(-dot(a, edge) / size_2, 0.0, 1.0) : 0.0;
        const double distance = length(a + share * edge);
        if (distance < best.distance) {
            best = {Vec3(0), distance};
            best.weights[k] = 1 - share;
            best.weights[(k + 1) % 3] = share;
        }
    }
    return best;
}

// First hits: Embree's tree for candidates, the watertight test in double for the answer.

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kSamplesPerTask = 256;
constexpr std::size_t kTrianglesPerTask = 4096;

/// Triangles that share a box: one, or two that follow each other in the scene and lie close.
struct Group {
    Id first = kNone;
    Id count = 0;
};

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

Hit Tracer::first_hit(const Ray& ray, double t_min, double t_max) const {
    // The smallest t, and whether any other hit came as near as a tie on the way there.
    Id seen = kNone;
    TriangleHit first{kInfinity, {}};
    bool tie = false;
    data_->for_each_hit(ray, t_min, tie_end(t_max), [&](Id triangle, const TriangleHit& hit) {
        tie = tie || (seen != kNone && tie_end(std::min(hit.t, first.t)) >= std::max(hit.t, first.t));
        if (hit.t < first.t) first = hit, seen = triangle;
        return tie_end(first.t);
    });
    if (seen == kNone || first.t > t_max) return {};

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
