// On which side of an edge a point of the plane lies, exactly, with a tie rule that no two sides can both
// claim.
#pragma once

#include <cmath>

#include "base/math/vec.h"

namespace trilens {

/// a b - c d to within two units in the last place (Kahan; proof: Jeannerod, Louvet, Muller, Further Analysis
/// of Kahan's Algorithm for 2 x 2 Determinants, 2013). No overflow or underflow.
inline double difference_of_products(double a, double b, double c, double d) {
    const double cd = c * d;
    const double error = std::fma(-c, d, cd);
    return std::fma(a, b, -cd) + error;
}

/// The exact sign of a b - c d: -1, 0 or 1. Rounding is monotonic, so products that round differently compare
/// as they are.
inline int sign_of_difference(double a, double b, double c, double d) {
    const double ab = a * b, cd = c * d;
    if (ab != cd) return ab > cd ? 1 : -1;
    const double rest = std::fma(a, b, -ab) - std::fma(c, d, -cd);
    return rest > 0 ? 1 : rest < 0 ? -1 : 0;
}

/// The side of the edge a -> b that the origin of the plane is on, -1 or 1; a and b are homogeneous (x w, y
/// w, w). A tie is resolved as if the origin were moved by (s, s^2) with an infinitely small s > 0: right,
/// and less so down where y points down (the top-left rule). All ties move it alike, so around a corner, too,
/// one triangle has it. 0: a and b are one point, no side can be told.
inline int side_of_edge(const Vec3& a, const Vec3& b) {
    const int side = sign_of_difference(a.x, b.y, a.y, b.x);
    if (side != 0) return side;
    // The first derivative by the origin's x that is not zero, else by its y.
    const int by_x = sign_of_difference(a.y, b.z, a.z, b.y);
    return by_x != 0 ? by_x : sign_of_difference(a.z, b.x, a.x, b.z);
}

}  // namespace trilens
