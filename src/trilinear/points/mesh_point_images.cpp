// Where world points appear through a whole RayMesh, by a tree of rounded cones over its facets' beams.
#include "trilinear/points/mesh_point_images.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/math/box.h"
#include "base/raymesh/check_data.h"
#include "base/util/error.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr std::uint32_t kLeaf = 1;
constexpr std::size_t kPointsPerTask = 512;

// Room for rounding in the cones, far above it and far below what would cost speed.
constexpr double kConeSlack = 1e-9;

// Two images are one where the weights of the corners agree to this, which is wider than the borders are.
constexpr double kSameImage = 4 * kLooseWeight;

Vec3 centroid_origin(const RayMesh& mesh, Id facet) {
    const IdTriple& c = mesh.facets[facet];
    return (mesh.rays[c[0]].origin + mesh.rays[c[1]].origin + mesh.rays[c[2]].origin) / 3.0;
}

}  // namespace

/// What the tree is built by, worked out once.
struct MeshPointImages::Means {
    std::vector<Vec3> unit;               // per corner: its direction
    std::vector<Vec3> origin, direction;  // per facet with rays

    explicit Means(const RayMesh& mesh) : origin(mesh.facets.size()), direction(mesh.facets.size()) {
        unit.reserve(mesh.rays.size());
        for (const Ray& ray : mesh.rays) unit.push_back(normalize_or_zero(ray.direction));
        for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
            if (!mesh.has_rays(f)) continue;
            origin[f] = centroid_origin(mesh, static_cast<Id>(f));
            Vec3 sum(0);
            for (const Id c : mesh.facets[f]) sum += unit[c];
            direction[f] = normalize_or_zero(sum);
        }
    }
};

MeshPointImages::MeshPointImages(const RayMesh& mesh) : corners_(mesh.facets), screen_(mesh.screen) {
    check_ray_mesh(mesh);
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (mesh.has_rays(f)) facet_.push_back(static_cast<Id>(f));
    }
    if (facet_.empty()) return;
    build(mesh, Means(mesh), 0, static_cast<std::uint32_t>(facet_.size()));
    coplanarity_.reserve(facet_.size());
    beam_.reserve(facet_.size());
    for (const Id f : facet_) {
        coplanarity_.push_back(make_coplanarity(trilinear_facet(mesh, f)));
        beam_.push_back(make_facet_beam(coplanarity_.back()));
    }
}

MeshPointImages::Node MeshPointImages::cone(const RayMesh& mesh, const Means& means,
                                            std::span<const Id> facets) {
    // A ball about the origins, and the mean direction.
    Box origins;
    Vec3 axis(0);
    for (const Id f : facets) {
        for (const Id c : mesh.facets[f]) origins.include(mesh.rays[c].origin);
        axis += means.direction[f];
    }
    Node node;
    node.center = 0.5 * (origins.low + origins.high);
    node.axis = normalize_or_zero(axis);

    // The widest corner direction bounds the interpolated ones too, as long as it stays below a right angle.
    double smallest_cosine = length(node.axis) > 0 ? 1 : -1;
    for (const Id f : facets) {
        for (const Id c : mesh.facets[f]) {
            node.radius = std::max(node.radius, length(mesh.rays[c].origin - node.center));
            smallest_cosine = std::min(smallest_cosine, dot(means.unit[c], node.axis));
        }
    }
    const double sine = std::sqrt(std::max(0.0, 1 - smallest_cosine * smallest_cosine));
    node.spread = smallest_cosine > kConeSlack ? sine + kConeSlack : 2;
    node.radius += kConeSlack * (node.radius + length(node.center));
    return node;
}

std::uint32_t MeshPointImages::build(const RayMesh& mesh, const Means& means, std::uint32_t first,
                                     std::uint32_t end) {
    const std::uint32_t index = static_cast<std::uint32_t>(node_.size());
    node_.push_back(cone(mesh, means, std::span(facet_).subspan(first, end - first)));
    if (end - first <= kLeaf) {
        node_[index].first = first, node_[index].end = end;
    } else {
        // Halve along the widest of six axes: three of place, three of direction at about the mesh's own
        // distance.
        Box places, directions;
        for (std::uint32_t i = first; i < end; ++i) {
            places.include(means.origin[facet_[i]]), directions.include(means.direction[facet_[i]]);
        }
        const double reach = 2 * node_[0].radius;
        const Vec3 wide_place = places.size(), wide_direction = reach * directions.size();
        int widest = 0;
        const auto width = [&](int axis) { return axis < 3 ? wide_place[axis] : wide_direction[axis - 3]; };
        for (int axis = 1; axis < 6; ++axis) widest = width(axis) > width(widest) ? axis : widest;
        const auto key = [&](Id f) {
            return widest < 3 ? means.origin[f][widest] : means.direction[f][widest - 3];
        };
        const std::uint32_t half = first + (end - first) / 2;
        std::sort(facet_.begin() + first, facet_.begin() + end, [&](Id a, Id b) {
            const double ka = key(a), kb = key(b);
            return ka != kb ? ka < kb : a < b;
        });
        build(mesh, means, first, half);
        build(mesh, means, half, end);
    }
    node_[index].skip = static_cast<std::uint32_t>(node_.size());
    return index;
}

bool MeshPointImages::may_see(const Node& node, const Vec3& point) {
    // Is |v - s axis| <= radius + s spread for some s >= 0? A quadratic inequality in s.
    const Vec3 v = point - node.center;
    const double outside = dot(v, v) - node.radius * node.radius;
    if (outside <= 0) return true;
    const double narrow = 1 - node.spread * node.spread;
    if (narrow <= 0) return true;
    const double along = dot(v, node.axis) + node.radius * node.spread;
    return along > 0 && along * along >= narrow * outside * (1 - kConeSlack);
}

bool MeshPointImages::same_image(const MeshPointImage& a, const MeshPointImage& b) const {
    if (std::fabs(a.t - b.t) > kSameImage * std::max(a.t, b.t)) return false;
    // Every corner must have the same weight in both, one that a facet does not have the weight zero.
    const auto covered = [&](const MeshPointImage& p, const MeshPointImage& q) {
        for (int i = 0; i < 3; ++i) {
            double other = 0;
            for (int j = 0; j < 3; ++j) {
                if (corners_[p.facet][static_cast<std::size_t>(i)] ==
                    corners_[q.facet][static_cast<std::size_t>(j)]) {
                    other = q.weights[j];
                }
            }
            if (std::fabs(p.weights[i] - other) > kSameImage) return false;
        }
        return true;
    };
    return covered(a, b) && covered(b, a);
}

void MeshPointImages::append(const Vec3& point, std::vector<MeshPointImage>& images) const {
    if (!is_coordinate(point)) throw InputError("", "point", "is not finite, or too large");
    const std::size_t first_new = images.size();
    for (std::uint32_t n = 0; n < node_.size();) {
        const Node& node = node_[n];
        if (!may_see(node, point)) {
            n = node.skip;
            continue;
        }
        for (std::uint32_t i = node.first; i < node.end; ++i) {
            if (!may_hold(coplanarity_[i], beam_[i], point)) continue;
            const Id f = facet_[i];
            for (const PointImage& image : point_images(coplanarity_[i], point)) {
                const IdTriple& c = corners_[f];
                const Vec3 s = image.weights.x * screen_[c[0]] + image.weights.y * screen_[c[1]] +
                               image.weights.z * screen_[c[2]];
                if (s.z > 0) images.push_back({f, image.t, image.weights, Vec2(s.x / s.z, s.y / s.z)});
            }
        }
        ++n;
    }

    // By facet and t, and what two facets share only once.
    const auto begin = images.begin() + static_cast<std::ptrdiff_t>(first_new);
    std::sort(begin, images.end(), [](const MeshPointImage& a, const MeshPointImage& b) {
        return a.facet != b.facet ? a.facet < b.facet : a.t < b.t;
    });
    std::size_t kept = first_new;
    for (std::size_t i = first_new; i < images.size(); ++i) {
        bool known = false;
        for (std::size_t j = first_new; j < kept && !known; ++j) {
            known = images[j].facet != images[i].facet && same_image(images[j], images[i]);
        }
        if (!known) images[kept++] = images[i];
    }
    images.resize(kept);
}

std::vector<MeshPointImage> MeshPointImages::images(const Vec3& point) const {
    std::vector<MeshPointImage> result;
    append(point, result);
    return result;
}

PointImageLists MeshPointImages::images(std::span<const Vec3> points) const {
    // Each task fills its own list; joined in order, the result does not depend on the threads.
    struct Part {
        std::vector<MeshPointImage> image;
        std::vector<std::size_t> end;
    };
    const std::size_t tasks = (points.size() + kPointsPerTask - 1) / kPointsPerTask;
    std::vector<Part> part(tasks);
    parallel_for(tasks, 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t task = first; task < last; ++task) {
            const std::size_t stop = std::min(points.size(), (task + 1) * kPointsPerTask);
            for (std::size_t i = task * kPointsPerTask; i < stop; ++i) {
                append(points[i], part[task].image);
                part[task].end.push_back(part[task].image.size());
            }
        }
    });

    PointImageLists lists;
    lists.first.reserve(points.size() + 1);
    lists.first.push_back(0);
    for (const Part& p : part) {
        const std::size_t before = lists.image.size();
        for (const std::size_t end : p.end) lists.first.push_back(before + end);
        lists.image.insert(lists.image.end(), p.image.begin(), p.image.end());
    }
    return lists;
}

}  // namespace trilens
