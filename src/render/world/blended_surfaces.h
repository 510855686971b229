// Blended surfaces (glTF's alphaMode BLEND): triangles that show what lies behind in part, apart from those
// that hide it.
#pragma once

#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "caustics/beams/light_paths.h"
#include "intersect/box_tree.h"
#include "render/world/world.h"
#include "volume/volume_integral.h"

namespace trilens {

/// The blended triangles of a world's objects. Thread-safe to read.
class BlendedSurfaces {
  public:
    BlendedSurfaces(TriangleScene triangles, ShadeScene shading);
    BlendedSurfaces(const BlendedSurfaces&) = delete;
    BlendedSurfaces& operator=(const BlendedSurfaces&) = delete;

    /// Takes over lights, materials and shadows from the shading of the other objects.
    void set_up(const ShadeSurroundings& others);

    const TriangleScene& triangles() const { return triangles_; }

    /// All that lie on the ray between t = 0 and t = until, ties with `until` included, from near to far;
    /// where two of one t meet along an edge, one of them. Surfaces of one side count where that is seen.
    std::vector<Hit> crossings(const Ray& ray, double until) const;

    /// The same without those that lie where the ray starts.
    std::vector<Hit> crossings_after_start(const Ray& ray, double until) const;

    /// What comes of light from the segment's end, t = 1, to its start: the surfaces between are what is seen
    /// of them from that end.
    Veil veil(const Ray& segment) const;

    /// What each of them adds: its colour in proportion to its opacity over what lies behind.
    std::vector<VolumeLight> shade(const Ray& ray, std::span<const Hit> crossings) const;

  private:
    bool is_seen_by(const Ray& ray, Id triangle) const;
    std::vector<Hit> crossings_from(double from, const Ray& ray, double until) const;

    TriangleScene triangles_;
    ShadeScene shading_;
    BoxTree tree_;
};

}  // namespace trilens
