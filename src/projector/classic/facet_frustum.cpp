#include "projector/classic/facet_frustum.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trilens {
namespace {

// A plane is trusted only beyond this share of the coordinates involved. Rounding in the planes, the boxes
// and the decision who is hit stays below 64 units in the last place of them (1.4e-14).
constexpr double kSlack = 1e-13;
// Rounding of the dot product of two unit vectors.
constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();
// A normal further off than this is not the plane of a side.
constexpr double kLargestTurn = 1e-9;

double size_of(const Vec3& v) {
    return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
}

double reach(const Box& box) {
    return size_of(glm::max(glm::abs(box.low), glm::abs(box.high)));
}

/// The largest normal . x over the box; at least the computed normal . x of each of its points.
double highest(const Box& box, const Vec3& normal) {
    return std::max(normal.x * box.low.x, normal.x * box.high.x) +
           std::max(normal.y * box.low.y, normal.y * box.high.y) +
           std::max(normal.z * box.low.z, normal.z * box.high.z);
}

}  // namespace

FacetFrustum::FacetFrustum(const TrilinearFacet& facet) : centre_(facet.corner[0].origin) {
    const std::array<Ray, 3>& c = facet.corner;
    const Vec3 o1 = (c[1].origin - centre_) * 0.5, o2 = (c[2].origin - centre_) * 0.5;
    const Vec3 d1 = (c[1].direction - c[0].direction) * 0.5, d2 = (c[2].direction - c[0].direction) * 0.5;
    constexpr std::array<Vec2, 4> kCorners{Vec2{-1, -1}, Vec2{1, -1}, Vec2{1, 1}, Vec2{-1, 1}};
    for (std::size_t k = 0; k < 4; ++k) {
        const double u = kCorners[k].x, v = kCorners[k].y;
        origin_[k] = (o1 + o2) + u * o1 + v * o2;
        direction_[k] = (c[0].direction + d1 + d2) + u * d1 + v * d2;
        unit_direction_[k] = normalize_or_zero(direction_[k]);
        origin_size_ = std::max(origin_size_, size_of(origin_[k]));
    }
    add_axis();

    // The sides: through adjacent directions where the frustum opens or closes, else along the axis.
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t next = (k + 1) % 4;
        const Vec3 across = cross(direction_[k], direction_[next]);
        add_plane(across);
        add_plane(-across);
        const Vec3 along = cross(origin_[next] - origin_[k], axis_);
        add_plane(along);
        add_plane(-along);
    }
}

void FacetFrustum::add_axis() {
    for (const Vec3& d : unit_direction_) axis_ += d;
    axis_ = normalize_or_zero(axis_);
    least_cosine_ = 1;
    for (const Vec3& d : unit_direction_) least_cosine_ = std::min(least_cosine_, dot(axis_, d));
    // The axis means something unless a ray goes nearly across it.
    constexpr double kSteep = 0.01;
    if (!(least_cosine_ > kSteep)) least_cosine_ = 0;
    add_plane(axis_);
}

void FacetFrustum::add_plane(const Vec3& normal) {
    Vec3 unit = normalize_or_zero(normal);
    if (unit == Vec3(0)) return;

    // A normal that should be square to two directions misses by rounding; turn it towards the axis by as
    // much.
    double least = 1;
    for (const Vec3& d : unit_direction_) least = std::min(least, dot(unit, d));
    if (least < kRounding) {
        if (!(least > -kLargestTurn && least_cosine_ > 0)) return;
        unit += (kRounding - least) / least_cosine_ * axis_;
    }
    double offset = std::numeric_limits<double>::infinity();
    for (const Vec3& o : origin_) offset = std::min(offset, dot(unit, o));
    plane_[planes_++] = {unit, offset - kSlack * origin_size_};
}

bool FacetFrustum::misses(const Box& box) const {
    const double slack = kSlack * reach(box);
    for (std::size_t k = 0; k < planes_; ++k) {
        if (highest(box, plane_[k].normal) + slack < plane_[k].offset) return true;
    }
    return false;
}

}  // namespace trilens
