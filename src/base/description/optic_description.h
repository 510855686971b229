// An optic as a scene gives it: subdivision cages (UsdGeomMesh's names), analytic primitives, how they are
// cut into facets, and how the rays at corners are chosen.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "base/description/lens_side.h"
#include "base/math/vec.h"
#include "base/util/ids.h"
#include "base/util/names.h"

namespace trilens {

// Subdivision cages (UsdGeomMesh's names) and analytic primitives.

/// kUnsubdivided: its triangles as they are, with the normals of their corners interpolated.
enum class SubdivisionScheme { kCatmullClark, kLoop, kBilinear, kUnsubdivided };
enum class InterpolateBoundary { kNothing, kEdgeOnly, kEdgeAndCorner };

template <>
struct EnumNames<SubdivisionScheme> {
    static constexpr std::array kTable{
        NamedValue<SubdivisionScheme>{SubdivisionScheme::kCatmullClark, "catmullClark"},
        NamedValue<SubdivisionScheme>{SubdivisionScheme::kLoop, "loop"},
        NamedValue<SubdivisionScheme>{SubdivisionScheme::kBilinear, "bilinear"},
        NamedValue<SubdivisionScheme>{SubdivisionScheme::kUnsubdivided, "none"}};
};
template <>
struct EnumNames<InterpolateBoundary> {
    static constexpr std::array kTable{
        NamedValue<InterpolateBoundary>{InterpolateBoundary::kNothing, "none"},
        NamedValue<InterpolateBoundary>{InterpolateBoundary::kEdgeOnly, "edgeOnly"},
        NamedValue<InterpolateBoundary>{InterpolateBoundary::kEdgeAndCorner, "edgeAndCorner"}};
};

/// A polygon mesh with subdivision tags. As an object it is drawn as its polygons; as an optic it stands for
/// its limit surface. Field names and meaning: UsdGeomMesh; a sharpness >= 10 is infinite.
struct Cage {
    std::vector<Vec3> points;
    std::vector<int> face_vertex_counts;
    std::vector<int> face_vertex_indices;
    SubdivisionScheme scheme = SubdivisionScheme::kCatmullClark;
    InterpolateBoundary interpolate_boundary = InterpolateBoundary::kEdgeAndCorner;
    std::vector<int> crease_indices;         // chains of vertices, one after the other
    std::vector<int> crease_lengths;         // vertices per chain
    std::vector<double> crease_sharpnesses;  // one per chain, or one per edge of all chains
    std::vector<int> corner_indices;
    std::vector<double> corner_sharpnesses;
    std::vector<int> hole_indices;  // faces that are not drawn
    std::vector<Vec3> normals;  // kUnsubdivided: per face corner, any length, zero: the face's own; or empty
};

// The kinds of primitives, each with its lengths, in its own frame: z along the axis, x along the tangent.
// for_each_length() calls use(length, its name) with every member: what scales, checks or hashes primitives
// asks it.

struct SpherePrimitive {
    static constexpr const char* kName = "sphere";
    double radius = 1;
};
template <typename Use>
void for_each_length(SpherePrimitive& sphere, const Use& use) {
    auto& [radius] = sphere;
    use(radius, "radius");
}

/// Its centre is the apex, its axis goes from there towards the focus.
struct ParaboloidPrimitive {
    static constexpr const char* kName = "paraboloid";
    double radius = 1;        // of its rim
    double focal_length = 1;  // apex to focus
};
template <typename Use>
void for_each_length(ParaboloidPrimitive& paraboloid, const Use& use) {
    auto& [radius, focal_length] = paraboloid;
    use(radius, "radius");
    use(focal_length, "focal length");
}

struct CylinderPrimitive {
    static constexpr const char* kName = "cylinder";
    double radius = 1;
    double height = 2;  // along the axis
};
template <typename Use>
void for_each_length(CylinderPrimitive& cylinder, const Use& use) {
    auto& [radius, height] = cylinder;
    use(radius, "radius");
    use(height, "height");
}

/// Its centre is the middle of its base, its axis goes from there to the apex.
struct ConePrimitive {
    static constexpr const char* kName = "cone";
    double radius = 1;  // of its base
    double height = 2;
};
template <typename Use>
void for_each_length(ConePrimitive& cone, const Use& use) {
    auto& [radius, height] = cone;
    use(radius, "radius");
    use(height, "height");
}

/// Its axis is its normal.
struct PlanePrimitive {
    static constexpr const char* kName = "plane";
    Vec2 size{2, 2};  // lengths of its sides along tangent and axis x tangent
};
template <typename Use>
void for_each_length(PlanePrimitive& plane, const Use& use) {
    auto& [size] = plane;
    use(size.x, "size");
    use(size.y, "size");
}

/// A closed body between two sides, with a straight edge from rim to rim. Its centre is the vertex of its
/// front side, its axis goes from there to that of its back. Its sides' shapes are scaled by
/// with_scaled_shape(), and its hole, which may be 0, by whoever scales it.
struct LensPrimitive {
    static constexpr const char* kName = "lens";
    double thickness = 0.5;  // along the axis
    LensSide front = {}, back = {};
    double hole = 0;  // radius of a round hole along the axis; 0: none
};
template <typename Use>
void for_each_length(LensPrimitive& lens, const Use& use) {
    use(lens.thickness, "thickness");
    use(lens.front.aperture, "aperture");
    use(lens.back.aperture, "aperture");
}

using PrimitiveKind = std::variant<SpherePrimitive, ParaboloidPrimitive, CylinderPrimitive, ConePrimitive,
                                   PlanePrimitive, LensPrimitive>;

/// An optic given by a formula instead of a cage; world frame.
struct Primitive {
    Vec3 center{0};
    Vec3 axis{0, 1, 0};     // unit
    Vec3 tangent{1, 0, 0};  // unit, at right angles to axis: where u begins
    PrimitiveKind kind = SpherePrimitive();
    bool is_mirrored = false;  // whether u turns clockwise about the axis, as where a transform mirrors it
};

inline const char* kind_name(const Primitive& primitive) {
    return std::visit([](const auto& kind) { return kind.kName; }, primitive.kind);
}

// How an optic is cut into facets: where they lie, and how the rays at their corners are chosen.

/// kInterpolated: each corner has its own exact ray. kFitted: corner rays are such that what is interpolated
/// between them comes nearest to the exact rays in the mean.
enum class CornerRays : std::uint8_t { kInterpolated, kFitted };

template <>
struct EnumNames<CornerRays> {
    static constexpr std::array kTable{NamedValue<CornerRays>{CornerRays::kFitted, "fitted"},
                                       NamedValue<CornerRays>{CornerRays::kInterpolated, "interpolated"}};
};

/// kSurface: N x N per face of the surface (thesis 7.2.1). kScreen: N x N over the optic's bounds on the film
/// (thesis 7.2.2); for optics of many small faces, or none.
enum class GridKind { kSurface, kScreen };

template <>
struct EnumNames<GridKind> {
    static constexpr std::array kTable{NamedValue<GridKind>{GridKind::kSurface, "surface"},
                                       NamedValue<GridKind>{GridKind::kScreen, "screen"}};
};

}  // namespace trilens
