// Ball arithmetic of directions: a vector known to lie within a radius of a middle.
#pragma once

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
bool sight_from(const Vec3& from, double radius, const Vec3& to, Sight& sight);

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
double turning_radius(const Sight& sight, double stretch, const Reach& a, const Reach& b);

/// How index times the unit direction of a sight changes along a step of its far end, in the middle: the
/// direction turns by the step across it.
Vec3 turned(const Sight& sight, double index, const Vec3& step);

/// The largest size of a coordinate.
double largest_coordinate(const Vec3& v);

/// Of a gradient's part in one sight, per length of the tangent: what rounding leaves of it.
double rounding_of_way(double index, double by_distance, double coordinate);

}  // namespace trilens
