#include "render/project/occlusion.h"

namespace trilens {
namespace {

/// A segment is free if what it meets lies within this share of its ends.
constexpr double kSightFreeShare = 1e-6;

}  // namespace

bool OcclusionQueries::is_free_of_objects(const Vec3& from, const Vec3& to) const {
    return !object_tracer(world_).occluded({from, to - from}, kSightFreeShare, 1 - kSightFreeShare);
}

bool OcclusionQueries::is_free_of_facets(const Ray& segment, std::size_t optic) const {
    return !frame_.optics[optic].facets->tracer().occluded(segment, kSightFreeShare, 1 - kSightFreeShare);
}

bool OcclusionQueries::is_free_of_surface(const Ray& segment, std::size_t optic) const {
    return !limit_tracer(world_, optic).meets(segment, kSightFreeShare, 1 - kSightFreeShare);
}

bool OcclusionQueries::is_free_of_optic(const Vec3& from, const Vec3& to, std::size_t optic) const {
    const Ray segment{from, to - from};
    return exact_ ? is_free_of_surface(segment, optic) : is_free_of_facets(segment, optic);
}

bool OcclusionQueries::sees(const Vec3& from, const Vec3& to, Id on_facet) const {
    if (!is_free_of_objects(from, to)) return false;
    const Ray segment{from, to - from};
    for (std::size_t i = 0; i < world_.optics.size(); ++i)
        if (i == on_facet ? !is_free_of_facets(segment, i) : !is_free_of_optic(from, to, i)) return false;
    return true;
}

bool OcclusionQueries::goes_straight(const Vec3& from, const Vec3& to, Id on_facet) const {
    const Ray segment{from, to - from};
    for (std::size_t i = 0; i < world_.optics.size(); ++i)
        if (i == on_facet ? !is_free_of_facets(segment, i) : !is_free_of_surface(segment, i)) return false;
    return true;
}

}  // namespace trilens
