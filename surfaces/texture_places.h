// Where a picture lies on a curved surface: uv and the directions in which they grow, on primitives around
// their axis, on cages between the uv of their faces' corners.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/description/optic_description.h"
#include "base/raymesh/surface.h"

namespace trilens {

/// uv at a point of a surface, and how the point moves with u and with v, any length, world frame; zero where
/// it does not.
struct TexturePlace {
    Vec2 uv{0};
    Vec3 along_u{0}, along_v{0};
};

/// For a face, its parameters, and what the surface is there. Called by many threads.
using TexturePlaces = std::function<TexturePlace(Id face, const Vec2& parameters, const SurfacePoint& at)>;

/// u around the axis from the tangent and v along it, 0 to 1 each; of a plane along tangent and axis x
/// tangent: as on an object that is such a primitive. Of one that is mirrored the other way round.
TexturePlaces places_on_primitive(const Primitive& primitive);

/// The face of a cage that a face of its surface is of.
struct CageFace {
    int face = 0;
    int sub_face = -1;  // corner of an n-gon whose part it is; -1: the whole face
};

/// What a surface also is that is made of a cage.
class HasCageFaces {
  public:
    virtual ~HasCageFaces() = default;
    /// None where the cage was repaired, so that its faces are not those that were given.
    virtual std::optional<CageFace> cage_face(Id face) const = 0;
};

/// Bilinear between the corners of quads (linear on triangles), whose uv stand in `uvs`, one per entry of
/// cage.face_vertex_indices; n-gons are quads between corners, edges' middles and their centre. `tangents`,
/// of triangles that are not subdivided, one per entry or none: which way u grows, interpolated between the
/// corners, and v grows along w cross(the surface's normal, xyz), whatever the uv say; where a face's are
/// zero at a corner, u and v grow as the uv say. None where the surface does not know its cage's faces.
/// `surface` is of `cage`.
std::optional<TexturePlaces> places_on_cage(const Surface& surface, const Cage& cage,
                                            std::span<const Vec2> uvs, std::span<const Vec4> tangents = {});

}  // namespace trilens
