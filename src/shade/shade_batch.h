// Shading in SIMD lanes: a structure of arrays of surface points, and the steps over it.
#pragma once

#include <cstddef>

#include "base/math/vec.h"
#include "base/raymesh/segments.h"

namespace trilens {

inline constexpr std::size_t kShadeLanes = Segments::kMost;

struct alignas(64) ShadeLanes3 {
    double x[kShadeLanes], y[kShadeLanes], z[kShadeLanes];

    void set(std::size_t lane, const Vec3& v) { x[lane] = v.x, y[lane] = v.y, z[lane] = v.z; }
    Vec3 get(std::size_t lane) const { return {x[lane], y[lane], z[lane]}; }
};

/// Points of triangles that rays see. Lanes do not see each other: an answer has the same bits in any lane,
/// with any neighbours, and with any instruction set.
struct ShadeBatch {
    using Bits = Segments::Bits;  // bit i: lane i

    // what is asked: all kShadeLanes are set, though only the first `count` may count
    ShadeLanes3 corner[3];         // of the triangle
    ShadeLanes3 corner_normal[3];  // where `has_normals`
    ShadeLanes3 toward;            // the ray's direction, any length
    alignas(64) double weight[3][kShadeLanes];
    std::size_t count = 0;
    bool has_normals = false;

    // of the surface there, by find_surfaces
    ShadeLanes3 position, geometric_normal, normal, shadow_start;
    Bits smooth = 0;  // lanes whose normal comes from the corners

    // of one sample of a light, by find_light (shade/light_batch.h)
    ShadeLanes3 way;                             // of shadow rays, from shadow_start to the light
    alignas(64) double irradiance[kShadeLanes];  // over pi, unhindered and of a white light
    Bits lit = 0;                                // lanes that it reaches where nothing stands in the way

    ShadeLanes3 arriving;  // irradiance over pi of all lights so far, and the ambient radiance
};

/// Where the points lie and how the surface stands there. `offset`: of the start of shadow rays along the
/// geometric normal, world units.
void find_surfaces(ShadeBatch& batch, double offset);

/// Adds radiance that arrives from everywhere alike.
void add_ambient(ShadeBatch& batch, const Vec3& radiance);

/// Adds the light found last to what arrives in those lanes.
void add_light(ShadeBatch& batch, const Vec3& color, ShadeBatch::Bits lanes);

}  // namespace trilens
