// The zeros of the law of reflection on a whole sphere: how many there are, without a look at its cells.
#pragma once

#include "base/vec.h"
#include "camera/specular_lanes.h"

namespace trilens {

struct SphereShape {
    Vec3 center{0};
    double radius = 1;
};

/// Of lanes whose law of reflection has two zeros on the sphere.
struct SphereZeros {
    LaneBits two = 0;
    PointLanes front, back;  // unit normals where the zeros are seen from outside and from inside, roughly
};

/// Finds for which lanes it is known that the law has two zeros on the sphere, one where it is seen
/// from outside by eye and point, one where from inside by both, and stays clear of zero at a distance from
/// them. Said only where both lie well outside, and the way from one to the other well clear of the sphere.
///
/// Zeros lie in the plane of eye, point and centre, where h vanishes along the circle. Let the circle have
/// radius 1; r be the distance from the eye or the point, and c the cosine of its direction and the normal.
/// The optical path's second derivative along the circle is the sum of c^2 / r - c over both. On the arc seen
/// from outside by both each c is below zero, and the sum above. On the arc seen from inside by both r > 2 c,
/// since the way has come through the circle: the sum is below zero. So each of these two arcs has one zero at
/// most. On the arcs between, where the signs of c differ, h along the circle vanishes only where both
/// directions are opposite, that is between eye and point. The path has a minimum and a maximum somewhere on
/// the circle: one on each arc.
void find_two_zeros(const SphereShape& sphere, const Vec3& eye, const PointLanes& points, SphereZeros& zeros);

}  // namespace trilens
