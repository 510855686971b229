// A surface's grid as triangles of a scene.
#pragma once

#include "base/raymesh/surface.h"
#include "base/raymesh/triangle_scene.h"

namespace trilens {

/// Appends the facets of `grid` to `scene` as triangles of `object`; primitive f is facet f. Points that
/// facets share stay shared.
void append_facets(const SurfaceGrid& grid, Id object, TriangleScene& scene);

}  // namespace trilens
