// Normals that a surface borrows: positions stay, the light turns by other normals (thesis, chapter 7).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "base/raymesh/surface.h"
#include "surfaces/texture_places.h"

namespace trilens {

/// Normals as a function of position and of the surface's own normal; world frame.
struct NormalField {
    enum class Type {
        kSmooth,  // the surface's own
        kSphere,  // on the lines through `center`: a plane then mirrors like a ball
        kNoise,   // the surface's own, tilted by smooth noise
    };
    Type type = Type::kSmooth;
    Vec3 center{0};          // kSphere
    std::uint64_t seed = 0;  // kNoise
    double amplitude = 0;  // kNoise: tangent of the typical tilt; any size, the normal never leaves its side
    double scale = 1;      // kNoise: bumps per scene unit; scale * position stays below 2^53
};

/// The field's unit normal at `position` where the surface's own is `own` (unit or zero). It lies on the side
/// of `own`: a sphere normal points away from the centre or toward it accordingly, and away where `own` is
/// zero. Zero where there is none: at the sphere's centre, and for the other types where `own` is zero.
Vec3 eval_normal(const NormalField& field, const Vec3& position, const Vec3& own);

/// Replaces the grid's corner normals by the field's; nothing else changes.
void override_normals(SurfaceGrid& grid, const NormalField& field);

/// The same for the exact surface: positions, derivatives and hits of `surface`, the field's normals. Its
/// normal is then no longer along du x dv.
std::unique_ptr<Surface> with_normals(std::shared_ptr<const Surface> surface, const NormalField& field);

/// Normals of a picture: unit, along u, along v and the surface's own normal. Called by many threads.
using MapNormals = std::function<Vec3(const Vec2& uv)>;

/// `surface` with its normals turned by a picture's, which lies as `places` says; where u and v have no
/// direction they are its own. Those of a map whose third coordinate is not positive leave the surface's
/// side.
std::unique_ptr<Surface> with_normal_map(std::shared_ptr<const Surface> surface, TexturePlaces places,
                                         MapNormals normals);

}  // namespace trilens
