// Finds planes that hold a beam of rays, and tests boxes against them.
#include "projector/blocks/beam.h"

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

double lowest(const Box& box, const Vec3& normal) {
    return -highest(box, -normal);
}

}  // namespace

Beam::Beam(const BlockRays& block) {
    if (!(block.weight_least > 0)) return;
    constexpr std::array<Vec2, 4> kCorners{Vec2{-1, -1}, Vec2{1, -1}, Vec2{1, 1}, Vec2{-1, 1}};
    for (std::size_t k = 0; k < 4; ++k) {
        const double u = kCorners[k].x, v = kCorners[k].y;
        origin_[k] = block.rays.origin_at(u, v) / block.rays.weight_at(u, v);
        direction_[k] = block.rays.direction_at(u, v) / block.rays.weight_at(u, v);
        unit_direction_[k] = normalize_or_zero(direction_[k]);
        origin_size_ = std::max(origin_size_, size_of(origin_[k]));
    }
    // The origins may be small sums of large terms.
    origin_size_ = std::max(origin_size_, block.origin_size / block.weight_least);
    add_axis();

    // The sides: through adjacent directions where the beam opens or closes, else along the axis.
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

void Beam::add_axis() {
    for (const Vec3& d : unit_direction_) axis_ += d;
    axis_ = normalize_or_zero(axis_);
    least_cosine_ = 1;
    for (std::size_t k = 0; k < 4; ++k) {
        least_cosine_ = std::min(least_cosine_, dot(axis_, unit_direction_[k]));
        axis_speed_ = std::max(axis_speed_, dot(axis_, direction_[k]));
        axis_start_ = k == 0 ? dot(axis_, origin_[k]) : std::max(axis_start_, dot(axis_, origin_[k]));
    }
    // How fast the rays go along the axis tells how far t a box is, unless a ray goes nearly across it.
    constexpr double kSteep = 0.01;
    if (!(least_cosine_ > kSteep)) axis_speed_ = least_cosine_ = 0;
    add_plane(axis_);
}

void Beam::add_plane(const Vec3& normal) {
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

bool Beam::misses(const Box& box) const {
    const double slack = kSlack * reach(box);
    for (std::size_t k = 0; k < planes_; ++k) {
        if (highest(box, plane_[k].normal) + slack < plane_[k].offset) return true;
    }
    return false;
}

double Beam::nearest(const Box& box) const {
    if (!(axis_speed_ > 0)) return 0;
    const double ahead = lowest(box, axis_) - axis_start_ - kSlack * (reach(box) + origin_size_);
    return std::max(0.0, ahead / axis_speed_ * (1 - kSlack));
}

}  // namespace trilens
