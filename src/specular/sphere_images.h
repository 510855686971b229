// Counts the reflections in a whole sphere (Alhazen's problem) without a look at its cells.
#pragma once

#include "base/math/vec.h"
#include "specular/simd_bounds.h"

namespace trilens {

struct SphereShape {
    Vec3 center{0};
    double radius = 1;
};

/// Of lanes for which it is known that the law of reflection has two zeros on the sphere at which eye and
/// point lie on the same side of it.
struct SphereZeros {
    LaneBits lit = 0;          // one is seen from outside, the other from inside
    LaneBits shaded = 0;       // both are seen from inside
    PointLanes first, second;  // unit normals there, roughly; the first the one in front or between
};

/// Said only where the law stays clear of zero at a distance from the zeros, and clear of singular at them:
/// where eye and point lie well outside, and the way between them passes well clear of the sphere, or well
/// inside it but well aside of its centre.
///
/// Zeros lie in the plane of eye, point and centre, where h vanishes along the circle. Let the circle have
/// radius 1; r be the distance from the eye or the point, and c the cosine of its direction and the normal.
/// The optical path's second derivative along the circle is the sum of c^2 / r - c over both. On the arc seen
/// from outside by both each c is below zero, and the sum above. On arcs seen from inside by both r > 2 c,
/// since the way has come through the circle: the sum is below zero. So each of these arcs has one zero at
/// most, a minimum of the path on the first and a maximum on the others. On the arcs between, where the signs
/// of c differ, h along the circle vanishes only where both directions are opposite, a minimum: where the way
/// between eye and point meets the circle. Minima and maxima take turns around the circle. So where that way
/// is clear of the sphere there is one arc of each kind, and each has a zero; where it leads through, there
/// are two minima on it, none on an arc seen from outside by both, and a maximum on each of two arcs.
void find_zeros(const SphereShape& sphere, const Vec3& eye, const PointLanes& points, SphereZeros& zeros);

/// Of lanes for which it is known how often an eye outside sees them reflected in the sphere's front.
struct FrontZeros {
    LaneBits one = 0, none = 0;
    PointLanes at;  // unit normals there, roughly
};

/// A place is seen from its front by eye and point where its tangent plane parts them from the sphere: there
/// are such where the way between them passes the sphere, one arc of the circle above, and none where it
/// meets it. On that arc the path has one minimum, whose second derivative is no less than either c. Said
/// where the way is clear of the edge.
void find_front_zeros(const SphereShape& sphere, const Vec3& eye, const PointLanes& points,
                      FrontZeros& zeros);

}  // namespace trilens
