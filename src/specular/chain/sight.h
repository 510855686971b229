// Ball arithmetic of directions: a vector known to lie within a radius of a middle.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/math/vec.h"

namespace trilens {

/// The chord 2 sin(angle / 2) of an angle is at most this, for all sines up to 1.
inline double chord_of(double sine) {
    return sine * (1 + 0.4143 * sine * sine);
}

/// Directions from one ball of places to another.
struct Sight {
    Vec3 direction{0};       // unit, from middle to middle
    double turn = 0;         // no direction differs by more
    double sine = 0;         // of the largest angle
    double by_distance = 0;  // 1 / distance of the middles

    /// No 1 / distance differs by more.
    double stretch() const { return by_distance * sine / (1 - sine); }
};

/// The ways between two balls are those from the one's middle to a ball of both radii, `radius`. False where
/// the balls meet.
inline bool sight_from(const Vec3& from, double radius, const Vec3& to, Sight& sight) {
    const Vec3 way = to - from;
    const double distance = length(way);
    if (!(distance > radius)) return false;
    sight.by_distance = 1 / distance;
    sight.direction = way * sight.by_distance;
    sight.sine = radius * sight.by_distance;
    sight.turn = chord_of(sight.sine);
    return true;
}

/// Of a tangent or second derivative: the length in the middle, the most anywhere, and how much it changes.
struct Reach {
    double length = 0, all = 0, radius = 0;

    static Reach of(const Vec3& middle, double radius) {
        const double size = glm::length(middle);
        return {size, size + radius, radius};
    }
};

/// The most that (a . Q b) / d changes, Q the projection across a sight of distance d. `stretch`: the
/// sight's.
inline double turning_radius(const Sight& sight, double stretch, const Reach& a, const Reach& b) {
    return stretch * a.all * b.all +
           sight.by_distance * (a.radius * b.all + a.length * (sight.sine * b.all + b.radius));
}

/// (n / l) (1 - e e^T) v: how n times the unit direction of a stretch turns as one of its ends moves by v.
/// `by_length`: n / l, 0 at infinity.
inline Vec3 turn_of_way(double by_length, const Vec3& way, const Vec3& v) {
    return by_length * (v - dot(way, v) * way);
}

/// The largest size of a coordinate.
inline double largest_coordinate(const Vec3& v) {
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

/// Of a gradient's part in one sight, per length of the tangent: what rounding leaves of it.
inline double rounding_of_way(double index, double by_distance, double coordinate) {
    constexpr double kSightRounding = 64 * std::numeric_limits<double>::epsilon();
    return kSightRounding * index * (1 + coordinate * by_distance);
}

}  // namespace trilens
