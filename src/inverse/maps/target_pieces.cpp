// The flat parts of an object in the pixels of its map: Sutherland and Hodgman's clipping of each pixel by
// the triangles on the texture.
#include <algorithm>
#include <array>

#include "base/math/polygon.h"
#include "inverse/maps/target.h"

namespace trilens {
namespace {

constexpr double kLeastShare = 1e-9;  // of a pixel, that a part has

const std::vector<Vec2> kWholePixel{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};

std::vector<Vec2> clipped(const std::vector<Vec2>& outline, const Vec2& from, const Vec2& to) {
    std::vector<Vec2> kept;
    for (std::size_t i = 0; i < outline.size(); ++i) {
        const Vec2 &a = outline[i], &b = outline[(i + 1) % outline.size()];
        const double at_a = cross(to - from, a - from), at_b = cross(to - from, b - from);
        if (at_a >= 0) kept.push_back(a);
        if ((at_a >= 0) != (at_b >= 0)) kept.push_back(a + at_a / (at_a - at_b) * (b - a));
    }
    return kept;
}

bool holds(const std::vector<Vec2>& outline, const Vec2& at) {
    for (std::size_t i = 0; i < outline.size(); ++i)
        if (cross(outline[(i + 1) % outline.size()] - outline[i], at - outline[i]) < 0) return false;
    return true;
}

Vec2 middle_of(const std::vector<Vec2>& outline) {
    Vec2 sum(0);
    for (const Vec2& corner : outline) sum += corner;
    return sum / static_cast<double>(outline.size());
}

Vec3 front_of(const ObjectMesh& object, Id triangle) {
    const IdTriple& corner = object.triangles[triangle];
    const Vec3& p = object.points[corner[0]];
    return normalize_or_zero(cross(object.points[corner[1]] - p, object.points[corner[2]] - p));
}

}  // namespace

std::vector<TargetPiece> Target::pieces(const Vec2& pixel) const {
    if (rectangle_) return {{*place(pixel), rectangle_->normal(), kWholePixel, 1}};
    std::vector<TargetPiece> pieces;
    for (const Id t : triangles_around(pixel)) {
        const std::optional<TargetPlace> at_middle = place_on(t, pixel, false);
        if (!at_middle) continue;
        std::array<Vec2, 3> corner;
        for (std::size_t k = 0; k < 3; ++k)
            corner[k] = Vec2(object_->uvs[t][k].x * description_.width,
                             (1 - object_->uvs[t][k].y) * description_.height) -
                        pixel;
        if (cross(corner[1] - corner[0], corner[2] - corner[0]) < 0) std::swap(corner[1], corner[2]);
        std::vector<Vec2> outline = kWholePixel;
        for (std::size_t k = 0; k < 3; ++k) outline = clipped(outline, corner[k], corner[(k + 1) % 3]);
        const double share = polygon_area(outline);
        if (!(share > kLeastShare)) continue;
        const Vec2 middle = middle_of(outline);
        const auto lies_here = [&](const TargetPiece& other) { return holds(other.outline, middle); };
        if (std::none_of(pieces.begin(), pieces.end(), lies_here))
            pieces.push_back({*at_middle, front_of(*object_, t), std::move(outline), share});
    }
    return pieces;
}

}  // namespace trilens
