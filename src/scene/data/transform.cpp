// The arithmetic of affine maps.
#include "scene/data/transform.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trilens {

Transform compose(const Transform& outer, const Transform& inner) {
    return {outer.linear * inner.linear, map_point(outer, inner.translation)};
}

Transform make_transform(const Vec3& translate, const Vec4& rotate, const Vec3& scale) {
    const double largest =
        std::max({std::abs(rotate.x), std::abs(rotate.y), std::abs(rotate.z), std::abs(rotate.w)});
    const Vec4 unit = glm::normalize(rotate / largest);
    const Mat3 rotation = glm::mat3_cast(Quat(unit.w, unit.x, unit.y, unit.z));
    return {Mat3(rotation[0] * scale.x, rotation[1] * scale.y, rotation[2] * scale.z), translate};
}

Vec4 quaternion_about(const Vec3& axis, double degrees) {
    const double half = std::remainder(degrees, 720) * std::numbers::pi / 360;
    return {std::sin(half) * normalize_or_zero(axis), std::cos(half)};
}

Vec4 quaternion_of_euler(const Vec3& degrees, const std::string& order) {
    Quat all(1, 0, 0, 0);
    for (const char letter : order) {
        const int k = letter - 'X';
        Vec3 axis(0);
        axis[k] = 1;
        const Vec4 one = quaternion_about(axis, degrees[k]);
        all = Quat(one.w, one.x, one.y, one.z) * all;
    }
    return {all.x, all.y, all.z, all.w};
}

std::optional<Transform> make_transform(std::span<const double, 16> columns) {
    if (columns[3] != 0 || columns[7] != 0 || columns[11] != 0 || columns[15] != 1) return std::nullopt;
    Transform t;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            t.linear[column][row] = columns[static_cast<std::size_t>(4 * column + row)];
    t.translation = {columns[12], columns[13], columns[14]};
    return t;
}

bool flattens(const Transform& t) {
    // Unit columns first, so that tiny and huge scales count for nothing.
    const Mat3 unit(normalize_or_zero(t.linear[0]), normalize_or_zero(t.linear[1]),
                    normalize_or_zero(t.linear[2]));
    return !(std::abs(glm::determinant(unit)) > kFlat);
}

bool mirrors(const Transform& t) {
    return triple(normalize_or_zero(t.linear[0]), normalize_or_zero(t.linear[1]),
                  normalize_or_zero(t.linear[2])) < 0;
}

Mat3 normal_map(const Transform& t) {
    // The cofactor matrix is the inverse transpose times the determinant, of which only the sign matters.
    const Mat3& m = t.linear;
    const double sign = mirrors(t) ? -1 : 1;
    return {sign * cross(m[1], m[2]), sign * cross(m[2], m[0]), sign * cross(m[0], m[1])};
}

std::optional<double> similarity_factor(const Transform& t) {
    const double factor = length(t.linear[0]);
    for (int i = 0; i < 3; ++i) {
        const Vec3 column = t.linear[i] / factor, next = t.linear[(i + 1) % 3] / factor;
        if (!(std::abs(dot(column, column) - 1) <= kSimilar) || !(std::abs(dot(column, next)) <= kSimilar))
            return std::nullopt;
    }
    return factor;
}

}  // namespace trilens
