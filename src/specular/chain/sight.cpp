#include "specular/chain/sight.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trilens {

bool sight_from(const Vec3& from, double radius, const Vec3& to, Sight& sight) {
    const Vec3 way = to - from;
    const double distance = length(way);
    if (!(distance > radius)) return false;
    sight.by_distance = 1 / distance;
    sight.direction = way * sight.by_distance;
    sight.sine = radius * sight.by_distance;
    sight.turn = chord_of(sight.sine);
    return true;
}

double turning_radius(const Sight& sight, double stretch, const Reach& a, const Reach& b) {
    return stretch * a.all * b.all +
           sight.by_distance * (a.radius * b.all + a.length * (sight.sine * b.all + b.radius));
}

Vec3 turned(const Sight& sight, double index, const Vec3& step) {
    return index * sight.by_distance * (step - dot(sight.direction, step) * sight.direction);
}

double largest_coordinate(const Vec3& v) {
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

double rounding_of_way(double index, double by_distance, double coordinate) {
    constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
    return kRounding * index * (1 + coordinate * by_distance);
}

}  // namespace trilens
