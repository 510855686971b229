// Tessellation of primitives into polygons, for objects.
#pragma once

#include <variant>

#include "base/description/optic_description.h"
#include "scene/data/polygons.h"

namespace trilens {

// The kinds that objects alone have.

struct BoxPrimitive {
    static constexpr const char* kName = "box";
    Vec3 size{2};  // along tangent, axis and tangent x axis
};

/// Its axis is its normal.
struct DiskPrimitive {
    static constexpr const char* kName = "disk";
    double radius = 1;
    double hole = 0;  // radius of a hole in its middle, below its own; 0: none
};

using ObjectPrimitiveKind =
    std::variant<SpherePrimitive, ParaboloidPrimitive, CylinderPrimitive, ConePrimitive, PlanePrimitive,
                 LensPrimitive, BoxPrimitive, DiskPrimitive>;

/// A primitive as an object has it, in the mesh's own frame.
struct ObjectPrimitive {
    Vec3 center{0};  // paraboloid: its apex; cone: of its base; lens: its front's vertex
    Vec3 axis{0, 1, 0}, tangent{1, 0, 0};  // unit, at right angles
    ObjectPrimitiveKind kind = SpherePrimitive();
    int segments = 48;  // of a full circle, 3..1024
};

inline const char* kind_name(const ObjectPrimitive& primitive) {
    return std::visit([](const auto& kind) { return kind.kName; }, primitive.kind);
}

/// Quads and triangles with exact normals and uvs (u around the axis from the tangent, v along it; plane, box
/// and disk: each side from corner to corner), fronts outwards. Spheres, boxes, cylinders, cones
/// and lenses are closed.
PolygonMesh tessellate(const ObjectPrimitive& primitive);

}  // namespace trilens
