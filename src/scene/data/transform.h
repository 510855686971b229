// Affine maps of meshes: what a scene file's `transform` and a glTF node say.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "base/math/vec.h"

namespace trilens {

/// point -> linear * point + translation.
struct Transform {
    Mat3 linear{1};
    Vec3 translation{0};
};

inline Vec3 map_point(const Transform& t, const Vec3& point) {
    return t.linear * point + t.translation;
}

/// First `inner`, then `outer`.
Transform compose(const Transform& outer, const Transform& inner);

/// Scale, then rotate, then translate. The quaternion x, y, z, w may have any length but 0.
Transform make_transform(const Vec3& translate, const Vec4& rotate, const Vec3& scale);

/// The quaternion x, y, z, w of a rotation by `degrees` about an axis of any length but 0.
Vec4 quaternion_about(const Vec3& axis, double degrees);

/// Of rotations about the fixed axes by `degrees` about x, y and z, in the order of the letters: "XYZ" is
/// about x first.
Vec4 quaternion_of_euler(const Vec3& degrees, const std::string& order);

/// From 16 numbers, column by column; none where the last row is not 0 0 0 1.
std::optional<Transform> make_transform(std::span<const double, 16> columns);

/// Whether the map turns volumes to nothing: |det| <= kFlat times the product of its columns' lengths.
bool flattens(const Transform& t);
inline constexpr double kFlat = 1e-12;

/// Whether the map turns right hands into left hands.
bool mirrors(const Transform& t);

/// Normals go by the inverse transpose; unit, or zero where the normal is zero. `t` must not flatten.
Mat3 normal_map(const Transform& t);

/// The factor of a similarity (rotation or mirroring times a factor), none for other maps. Tolerance:
/// kSimilar.
std::optional<double> similarity_factor(const Transform& t);
inline constexpr double kSimilar = 1e-9;  // relative; a matrix written with ten digits passes

}  // namespace trilens
