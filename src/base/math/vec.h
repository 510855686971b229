// Small vectors and matrices, always double: the only include of GLM.
#pragma once

#define GLM_FORCE_XYZW_ONLY
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

namespace trilens {

using Vec2 = glm::dvec2;
using Vec3 = glm::dvec3;
using Vec4 = glm::dvec4;
using Mat2 = glm::dmat2;
using Mat3 = glm::dmat3;  // columns, as in GLM: m[column][row]
using Mat4 = glm::dmat4;
using Quat = glm::dquat;

using glm::cross;
using glm::dot;
using glm::length;
using glm::normalize;

/// Of the plane: twice the signed area of the triangle from the origin over a to b.
inline double cross(const Vec2& a, const Vec2& b) {
    return a.x * b.y - a.y * b.x;
}

/// The triple product a . (b x c): six times the signed volume of the tetrahedron on a, b, c.
inline double triple(const Vec3& a, const Vec3& b, const Vec3& c) {
    return dot(a, cross(b, c));
}

/// `direction` scaled to length 1, or the zero vector where its length is zero or not finite.
inline Vec3 normalize_or_zero(const Vec3& direction) {
    // Scale by the largest component first, so that tiny and huge vectors neither vanish nor overflow.
    const double largest =
        glm::max(glm::max(glm::abs(direction.x), glm::abs(direction.y)), glm::abs(direction.z));
    if (!(largest > 0) || largest > 1.7e308) return Vec3(0);
    const Vec3 scaled = direction / largest;
    return scaled / length(scaled);
}

/// A unit vector at right angles to a unit vector; which one is not said.
inline Vec3 unit_across(const Vec3& unit) {
    return normalize(cross(unit, glm::abs(unit.x) < 0.7 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
}

}  // namespace trilens
