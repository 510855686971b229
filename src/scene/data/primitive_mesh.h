// Tessellation of primitives into polygons, for objects.
#pragma once

#include <array>

#include "base/util/names.h"
#include "scene/data/polygons.h"

namespace trilens {

enum class ObjectShape { kSphere, kParaboloid, kCylinder, kPlane, kBox, kDisk };

template <>
struct EnumNames<ObjectShape> {
    static constexpr std::array kTable{NamedValue<ObjectShape>{ObjectShape::kSphere, "sphere"},
                                       NamedValue<ObjectShape>{ObjectShape::kParaboloid, "paraboloid"},
                                       NamedValue<ObjectShape>{ObjectShape::kCylinder, "cylinder"},
                                       NamedValue<ObjectShape>{ObjectShape::kPlane, "plane"},
                                       NamedValue<ObjectShape>{ObjectShape::kBox, "box"},
                                       NamedValue<ObjectShape>{ObjectShape::kDisk, "disk"}};
};

/// A primitive as an object has it: lengths as Primitive has them, in the mesh's own frame.
struct ObjectPrimitive {
    ObjectShape shape = ObjectShape::kSphere;
    Vec3 center{0};                        // paraboloid: its apex
    Vec3 axis{0, 1, 0}, tangent{1, 0, 0};  // unit, at right angles
    double radius = 1, focal_length = 1, height = 2;
    // Plane: along tangent and axis x tangent. Box: along tangent, axis and tangent x axis.
    Vec3 size{2};
    int segments = 48;  // of a full circle, 3..1024
};

/// Quads and triangles with exact normals and uvs (u around the axis from the tangent, v along it; plane, box
/// and disk: each side from corner to corner), fronts outwards. Spheres, boxes and cylinders are closed.
PolygonMesh tessellate(const ObjectPrimitive& primitive);

}  // namespace trilens
