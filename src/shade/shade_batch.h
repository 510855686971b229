// Shading in SIMD lanes: a structure of arrays of surface points, and the steps over it.
#pragma once

#include <cstdint>
#include <span>

#include "base/raymesh/segments.h"
#include "shade/lights/light_sample.h"

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

    // of one light, by find_light
    ShadeLanes3 way;                             // of shadow rays, from shadow_start to the light
    alignas(64) double irradiance[kShadeLanes];  // over pi, unhindered and of a white light
    Bits lit = 0;                                // lanes that it reaches where nothing stands in the way

    ShadeLanes3 arriving;  // irradiance over pi of all lights so far, and the ambient radiance
};

/// A point light, or a directional one without an angle, as all lanes see it.
struct ShadeLight {
    bool is_point = false;
    Vec3 position{0};        // of a point light
    Vec3 toward{0}, far{0};  // of a directional one: unit, and so far that it is beyond the scene
    double intensity = 0;
    bool casts_shadows = false;
};

/// Where the points lie and how the surface stands there. `offset`: of the start of shadow rays along the
/// geometric normal, world units.
void find_surfaces(ShadeBatch& batch, double offset);

/// What would come of the light where nothing is in the way.
void find_light(ShadeBatch& batch, const ShadeLight& light);

/// The same, of one sample of a light per lane: `samples` has batch.count of them.
void find_sampled_light(ShadeBatch& batch, std::span<const LightSample> samples, bool casts_shadows);

/// Adds radiance that arrives from everywhere alike.
void add_ambient(ShadeBatch& batch, const Vec3& radiance);

/// Adds the light found last to what arrives in those lanes.
void add_light(ShadeBatch& batch, const Vec3& color, ShadeBatch::Bits lanes);

}  // namespace trilens
