#include "base/raymesh/flat_face.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

constexpr double kFlatFaceRounding = 1e-13;
/// Places nearer to a border are not surely within, in parameters.
constexpr double kBorderRoom = 1e-9;
/// After a step as small as this one more leaves nothing but rounding.
constexpr double kLastStep = 1e-8;
constexpr int kMostInversionSteps = 10;

}  // namespace

std::optional<FlatFace> FlatFace::of(const Surface& surface, Id face) {
    if (!surface.is_flat(face)) return std::nullopt;
    const auto at = [&](const Vec2& uv) { return surface.eval_first_order(face, uv); };
    FlatFace flat;
    flat.domain_ = surface.domain(face);
    const bool is_square = flat.domain_ == FaceDomain::kSquare;
    flat.corner_ = at({0, 0}).position;
    flat.by_u_ = at({1, 0}).position - flat.corner_;
    flat.by_v_ = at({0, 1}).position - flat.corner_;
    if (is_square) flat.by_both_ = at({1, 1}).position - flat.corner_ - flat.by_u_ - flat.by_v_;
    flat.normal_ = at({0.25, 0.25}).normal;
    if (flat.normal_ == Vec3(0)) return std::nullopt;
    const Vec3 size = glm::abs(flat.normal_);
    const int across = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    flat.axes_ = {(across + 1) % 3, (across + 2) % 3};

    const double far = length(flat.corner_) + length(flat.by_u_) + length(flat.by_v_) + length(flat.by_both_);
    for (const Vec2& uv : {Vec2(0), Vec2(1, 0), Vec2(0, 1), Vec2(0.5, 0), Vec2(0, 0.5), Vec2(0.5),
                           Vec2(0.25, 0.625), is_square ? Vec2(1) : Vec2(0), is_square ? Vec2(0.75) : Vec2(0)}) {
        const SurfacePoint exact = at(uv), own = flat.point(uv);
        const double off = std::max({length(exact.position - own.position), length(exact.du - own.du),
                                     length(exact.dv - own.dv)});
        if (!(off <= kFlatFaceRounding * far && length(exact.normal - own.normal) <= kFlatFaceRounding))
            return std::nullopt;
    }
    flat.is_affine_ = length(flat.by_both_) <= kFlatFaceRounding * far;
    return flat;
}

std::optional<Vec2> FlatFace::parameters_of(const Vec3& place) const {
    const Vec2 goal = in_plane(place - corner_), by_u = in_plane(by_u_), by_v = in_plane(by_v_),
               by_both = in_plane(by_both_);
    Vec2 uv(domain_ == FaceDomain::kSquare ? 0.5 : 0.25);
    bool is_there = false;
    for (int i = 0; i < kMostInversionSteps && !is_there; ++i) {
        const Vec2 du = by_u + uv.y * by_both, dv = by_v + uv.x * by_both;
        const Vec2 left = goal - uv.x * by_u - uv.y * dv;
        const Vec2 step = Vec2(cross(left, dv), cross(du, left)) / cross(du, dv);
        uv += step;
        if (!std::isfinite(uv.x + uv.y)) return std::nullopt;
        // The map of a parallelogram is linear: the second step mends the first one's rounding.
        is_there = std::max(std::fabs(step.x), std::fabs(step.y)) < kLastStep;
    }
    if (!is_there || !(std::min(uv.x, uv.y) > kBorderRoom)) return std::nullopt;
    const double beyond = domain_ == FaceDomain::kSquare ? std::max(uv.x, uv.y) : uv.x + uv.y;
    if (!(beyond < 1 - kBorderRoom)) return std::nullopt;
    return uv;
}

SurfacePoint FlatFace::point(const Vec2& uv) const {
    SurfacePoint point;
    point.du = by_u_ + uv.y * by_both_;
    point.dv = by_v_ + uv.x * by_both_;
    point.position = corner_ + uv.x * by_u_ + uv.y * point.dv;
    point.normal = normal_;
    return point;
}

}  // namespace trilens
