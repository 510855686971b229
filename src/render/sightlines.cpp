#include "render/sightlines.h"

#include <optional>

namespace trilens {
namespace {

/// A segment is free if what it meets lies within this share of its ends.
constexpr double kFreeShare = 1e-6;

}  // namespace

bool Sightlines::is_free_of_objects(const Vec3& from, const Vec3& to) const {
    return !object_tracer(world_).occluded({from, to - from}, kFreeShare, 1 - kFreeShare);
}

bool Sightlines::is_free_of_optic(const Vec3& from, const Vec3& to, std::size_t optic) const {
    const Ray segment{from, to - from};
    if (!exact_) return !frame_.optics[optic].facets->tracer().occluded(segment, kFreeShare, 1 - kFreeShare);
    const std::optional<SurfaceHit> hit = limit_tracer(world_, optic).first_hit(segment, kFreeShare);
    return !hit || hit->t >= 1 - kFreeShare;
}

bool Sightlines::sees(const Vec3& from, const Vec3& to) const {
    if (!is_free_of_objects(from, to)) return false;
    for (std::size_t i = 0; i < world_.optics.size(); ++i)
        if (!is_free_of_optic(from, to, i)) return false;
    return true;
}

bool Sightlines::goes_straight(const Vec3& from, const Vec3& to) const {
    const Ray segment{from, to - from};
    for (std::size_t i = 0; i < world_.optics.size(); ++i) {
        const std::optional<SurfaceHit> hit = limit_tracer(world_, i).first_hit(segment, kFreeShare);
        if (hit && hit->t < 1 - kFreeShare) return false;
    }
    return true;
}

}  // namespace trilens
