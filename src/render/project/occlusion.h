// What lies between two places: objects, and optics on their exact surfaces or as facets.
#pragma once

#include <cstddef>

#include "render/frame/frame.h"
#include "render/world/world.h"

namespace trilens {

/// Asks for segments from place to place, world frame. A segment is free if what it meets lies at its ends.
/// Thread-safe to read; world and frame must live longer.
class OcclusionQueries {
  public:
    /// `exact`: optics are their exact surfaces, else the frame's facets.
    OcclusionQueries(const World& world, const Frame& frame, bool exact)
        : world_(world), frame_(frame), exact_(exact) {}

    bool is_free_of_objects(const Vec3& from, const Vec3& to) const;
    bool is_free_of_optic(const Vec3& from, const Vec3& to, std::size_t optic) const;

    /// Whether nothing at all lies between the camera and a place. `on_facet`: the optic on whose facet the
    /// place lies, off the exact surface: that optic is its facets then; kNone: there is none.
    bool sees(const Vec3& from, const Vec3& to, Id on_facet = kNone) const;

    /// Whether light that leaves an optic at `from` comes to `to` without meeting another, or the same once
    /// more; `on_facet` as above, of `from`.
    bool goes_straight(const Vec3& from, const Vec3& to, Id on_facet = kNone) const;

  private:
    bool is_free_of_facets(const Ray& segment, std::size_t optic) const;
    bool is_free_of_surface(const Ray& segment, std::size_t optic) const;

    const World& world_;
    const Frame& frame_;
    bool exact_;
};

}  // namespace trilens
