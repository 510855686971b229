// Where a facet images a world point (Vallance 2005, chapter 3, listing 3.1), with polished roots.
#include "trilinear/points/point_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/math/box.h"
#include "base/math/roots.h"
#include "base/raymesh/sample_grid.h"
#include "base/util/error.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

// The point on the facet's rays as a function of (w1, w2, t), relative to o_0, and its derivatives.
struct Position {
    Vec3 point, by_w1, by_w2, by_t;
};

Position position(const Coplanarity& f, double w1, double w2, double t) {
    const Vec3 a = f.e1 + t * f.f1, b = f.e2 + t * f.f2;
    const Vec3 direction = f.direction + w1 * f.f1 + w2 * f.f2;
    return {t * f.direction + w1 * a + w2 * b, a, b, direction};
}

struct NewtonSolution {
    double w1, w2, t;
    Vec3 tolerance;  // of w0, w1, w2
    double t_tolerance;
    double residual;
};

// Newton steps on the three equations, for as long as they bring the point closer.
NewtonSolution polish(const Coplanarity& f, const Vec3& x, const Vec3& weights, double t) {
    NewtonSolution s{weights.y, weights.z, t, Vec3(0), 0, 0};
    Position p = position(f, s.w1, s.w2, s.t);
    s.residual = length(p.point - x);
    for (int step = 0; step < 3; ++step) {
        const Vec3 miss = x - p.point;
        const double det = triple(p.by_w1, p.by_w2, p.by_t);
        if (det == 0) break;
        const double w1 = s.w1 + triple(miss, p.by_w2, p.by_t) / det;
        const double w2 = s.w2 + triple(p.by_w1, miss, p.by_t) / det;
        const double next_t = s.t + triple(p.by_w1, p.by_w2, miss) / det;
        const Position next = position(f, w1, w2, next_t);
        const double residual = length(next.point - x);
        if (!(residual < s.residual)) break;
        s.w1 = w1, s.w2 = w2, s.t = next_t, s.residual = residual, p = next;
    }

    // How far rounding of the coordinates moves the solution: rows of the inverse of the derivative.
    const double det = std::fabs(triple(p.by_w1, p.by_w2, p.by_t));
    const double rounding =
        kCoordinateRounding * (length(f.origin) + length(x) + std::fabs(s.t) * length(p.by_t));
    const auto moved = [&](const Vec3& row) { return det > 0 ? length(row) * rounding / det : kLooseWeight; };
    const Vec3 by_w1 = cross(p.by_w2, p.by_t), by_w2 = cross(p.by_t, p.by_w1);
    s.tolerance = Vec3(moved(by_w1 + by_w2), moved(by_w1), moved(by_w2));
    s.tolerance = kWeightTolerance + glm::min(s.tolerance, Vec3(kLooseWeight));
    s.t_tolerance = std::min(moved(cross(p.by_w1, p.by_w2)), kLooseWeight * std::fabs(t));
    return s;
}

}  // namespace

PointImages point_images(const Coplanarity& facet, const Vec3& point, const ImageFilter& filter) {
    PointImages images;
    const Vec3 x = point - facet.origin;
    const double size = length(x) + length(facet.e1) + length(facet.e2);
    double previous = NAN;
    for (const double root : real_roots(coplanarity_cubic(facet, point))) {
        if (root == previous) continue;
        previous = root;
        if (!filter.behind && root < 0 && -root * length(facet.direction) > kLooseWeight * size) continue;

        const std::optional<Vec3> weights = weights_in_parametric_triangle(facet, root, point);
        if (!weights) continue;
        const NewtonSolution s = polish(facet, x, *weights, root);
        if (!(s.residual <= kImageResidual * size)) continue;
        const Vec3 w(1 - s.w1 - s.w2, s.w1, s.w2);
        const bool inside = w.x >= -s.tolerance.x && w.y >= -s.tolerance.y && w.z >= -s.tolerance.z;
        const bool ahead = s.t >= -s.t_tolerance;
        if ((!inside && !filter.whole_plane) || (!ahead && !filter.behind)) continue;
        const double t = filter.behind ? s.t : std::max(s.t, 0.0);
        images.image[static_cast<std::size_t>(images.count++)] = {t, w};
    }
    return images;
}

namespace {

// Borders count as inside by up to 1e-6 of a weight (kLooseWeight): the sides stand off by more than that.
constexpr double kStandOff = 1e-5;
// And by what rounding may do to a projection on a side's normal, as a share of the lengths involved.
constexpr double kRounding = 1e-13;

}  // namespace

FacetBeam make_facet_beam(const Coplanarity& facet) {
    const Vec3 d0 = facet.direction, d1 = d0 + facet.f1, d2 = d0 + facet.f2;
    FacetBeam beam;
    beam.axis = normalize_or_zero(normalize_or_zero(d0) + normalize_or_zero(d1) + normalize_or_zero(d2));
    beam.along = {dot(d0, beam.axis), dot(d1, beam.axis), dot(d2, beam.axis)};
    // Nearly across the axis, t would hang on rounding.
    constexpr double kAcross = 1e-3;
    if (beam.along.x <= kAcross * length(d0) || beam.along.y <= kAcross * length(d1) ||
        beam.along.z <= kAcross * length(d2))
        beam.axis = Vec3(0);
    return beam;
}

bool may_hold(const Coplanarity& facet, const FacetBeam& beam, const Vec3& point) {
    if (beam.axis == Vec3(0)) return true;
    const Vec3 x = point - facet.origin;
    const Vec3 d0 = facet.direction, d1 = d0 + facet.f1, d2 = d0 + facet.f2;
    const double size =
        length(x) + length(facet.e1) + length(facet.e2) + kRounding * length(facet.origin) / kStandOff;

    // t = (sum w_k N_k) / (sum w_k D_k) is a mean of the N_k / D_k, since all D_k are positive.
    const double height = dot(x, beam.axis);
    const Vec3 t =
        Vec3(height, height - dot(facet.e1, beam.axis), height - dot(facet.e2, beam.axis)) / beam.along;
    const Vec3 margin = kStandOff * size / beam.along;
    const double low = std::max(std::min({t.x - margin.x, t.y - margin.y, t.z - margin.z}),
                                -std::max({margin.x, margin.y, margin.z}));
    const double high = std::max({t.x + margin.x, t.y + margin.y, t.z + margin.z});
    if (high < low) return false;

    // The parametric triangles at both ends, and their sides along the axis.
    const std::array<Vec3, 6> hull = {low * d0,  facet.e1 + low * d1,  facet.e2 + low * d2,
                                      high * d0, facet.e1 + high * d1, facet.e2 + high * d2};
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        const Vec3 normal = cross(hull[next] + hull[next + 3] - hull[k] - hull[k + 3], beam.axis);
        double least = dot(normal, hull[0]), most = least;
        for (std::size_t i = 1; i < 6; ++i) {
            const double side = dot(normal, hull[i]);
            least = std::min(least, side), most = std::max(most, side);
        }
        const double room =
            kStandOff * (most - least) + kRounding * length(normal) * (size + length(facet.origin));
        const double here = dot(normal, x);
        if (here > most + room || here < least - room) return false;
    }
    return true;
}

// Where world points appear through a whole RayMesh, by a tree of rounded cones over its facets' beams.

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
