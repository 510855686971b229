// Finds planes that hold a beam of rays, and tests boxes against them.
#include "projector/beam.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trilens {
namespace {

// A plane is trusted only beyond this share of the coordinates involved. Rounding in the planes, the boxes and the
// decision who is hit stays below 64 units in the last place of them (1.4e-14).
constexpr double kSlack = 1e-13;
// Rounding of a dot product of a unit normal with a direction, as a share of the direction.
constexpr double kAlong = 8 * std::numeric_limits<double>::epsilon();

double size_of(const Vec3& v) { return std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z); }

double reach(const Box& box) { return size_of(glm::max(glm::abs(box.lo), glm::abs(box.hi))); }

/// The largest normal . x over the box; at least the computed normal . x of each of its points.
double highest(const Box& box, const Vec3& normal) {
    return std::max(normal.x * box.lo.x, normal.x * box.hi.x) + std::max(normal.y * box.lo.y, normal.y * box.hi.y) +
           std::max(normal.z * box.lo.z, normal.z * box.hi.z);
}

double lowest(const Box& box, const Vec3& normal) { return -highest(box, -normal); }

}  // namespace

Beam::Beam(const BlockRays& block) {
    if (!(block.weight_least > 0)) return;
    constexpr std::array<Vec2, 4> kCorners{Vec2{-1, -1}, Vec2{1, -1}, Vec2{1, 1}, Vec2{-1, 1}};
    for (std::size_t k = 0; k < 4; ++k) {
        const double u = kCorners[k].x, v = kCorners[k].y;
        origin_[k] = block.rays.origin_at(u, v) / block.rays.weight_at(u, v);
        direction_[k] = block.rays.direction_at(u, v);
        origin_size_ = std::max(origin_size_, size_of(origin_[k]));
    }
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
    for (const Vec3& d : direction_) axis_ += normalize_or_zero(d);
    axis_ = normalize_or_zero(axis_);
    add_plane(axis_);

    // How fast the rays go along the axis tells how far t a box is, unless a ray goes nearly across it.
    constexpr double kSteepest = 0.01;
    bool steep = true;
    for (std::size_t k = 0; k < 4; ++k) {
        const double speed = dot(axis_, direction_[k]);
        if (!(speed > kSteepest * length(direction_[k]))) steep = false;
        axis_speed_ = std::max(axis_speed_, speed);
        axis_start_ = k == 0 ? dot(axis_, origin_[k]) : std::max(axis_start_, dot(axis_, origin_[k]));
    }
    if (!steep) axis_speed_ = 0;
}

void Beam::add_plane(const Vec3& normal) {
    const Vec3 unit = normalize_or_zero(normal);
    if (unit == Vec3(0) || planes_ == plane_.size()) return;
    double offset = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 4; ++k) {
        if (!(dot(unit, direction_[k]) >= -kAlong * length(direction_[k]))) return;
        offset = std::min(offset, dot(unit, origin_[k]));
    }
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
