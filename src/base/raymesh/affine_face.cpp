#include "base/raymesh/affine_face.h"

namespace trilens {

std::optional<AffineFace> affine_face(const Surface& surface, Id face) {
    constexpr double kRounding = 1e-13;
    if (!surface.is_flat(face)) return std::nullopt;
    const auto at = [&](const Vec2& uv) { return surface.eval_first_order(face, uv).position; };
    AffineFace affine;
    affine.corner = at({0, 0});
    affine.by_u = at({1, 0}) - affine.corner;
    affine.by_v = at({0, 1}) - affine.corner;
    const double far = length(affine.corner) + length(affine.by_u) + length(affine.by_v);
    const bool is_square = surface.domain(face) == FaceDomain::kSquare;
    for (const Vec2& uv :
         {Vec2(0.5, 0), Vec2(0, 0.5), Vec2(0.5, 0.5), Vec2(0.25, 0.25), is_square ? Vec2(1) : Vec2(0)}) {
        const Vec3 place = affine.corner + uv.x * affine.by_u + uv.y * affine.by_v;
        if (!(length(at(uv) - place) <= kRounding * far)) return std::nullopt;
    }
    return affine;
}

}  // namespace trilens
