// Surface shading: Lambert's cosine law with lights, shadows and textures, for projector and tracer alike.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "base/description/light.h"
#include "base/description/material.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/segments.h"
#include "base/raymesh/triangle_scene.h"
#include "shade/lights/light_sample.h"
#include "shade/material_maps.h"
#include "shade/metallic_roughness.h"
#include "shade/receiver.h"
#include "shade/texture_filter.h"

namespace trilens {

/// What triangles of one scene are shaded by, whichever they are.
struct ShadeSurroundings {
    std::vector<Material> materials;
    std::vector<Light> lights;
    Background background;
    // Mip maps of the materials' pictures, by material, and of the background's, null where it has none. Set
    // by prepare_textures(); without them nothing is filtered.
    std::vector<MaterialMips> mips;
    std::shared_ptr<const MipMap> environment_map;
    // By light: what stands for the background where the light is one of it, else null; set by
    // prepare_lights(), without which an environment's light must not be asked for.
    std::vector<std::shared_ptr<const EnvironmentSamples>> environment_samples;
    double size = 1;  // diagonal of the scene's bounding box, the unit of shadow offsets

    /// Which of the segments meet anything that casts a shadow; only asked for lights with shadows.
    std::function<Segments::Bits(const Segments&)> occluded;
    // The same of lights with caustics, which glass stops, too.
    std::function<Segments::Bits(const Segments&)> occluded_by_all;
    // Of light that nothing stops, the share that comes from a segment's end (t = 1) to its start, through
    // what blends; null: nothing does.
    std::function<double(const Ray&)> let_through;

    /// Irradiance by light number `light`, one with caustics, over optics.
    std::function<Vec3(std::size_t light, const Receiver&)> caustic;
};

/// Appearance of the triangles of a TriangleScene; the arrays have one entry per triangle, but uvs, colors,
/// normals, tangents and baked light may end early: triangles beyond have zeros, and colours of one.
struct ShadeScene : ShadeSurroundings {
    const TriangleScene* triangles = nullptr;
    std::vector<Id> material;              // index into materials
    std::vector<std::array<Vec2, 3>> uvs;  // v upward from the picture's bottom; unset triangles hold zeros
    std::vector<std::array<Vec2, 3>> second_uvs;  // of textures whose sampler says so
    std::vector<std::array<Vec4, 3>> colors;    // factors of base colour and alpha; unset triangles hold ones
    std::vector<std::array<Vec3, 3>> normals;   // unit per corner; all zero: the triangle is flat
    std::vector<std::array<Vec4, 3>> tangents;  // of normal maps, as ObjectMesh has them
    std::vector<BakedLight> baked;              // arrives beside what the lights send
};

/// Radiance (linear Rec.709) that leaves the hit point towards where `ray` came from. Objects are two-sided;
/// they are matt (radiance = base colour times irradiance over pi, plus ambient), or of the
/// metallic-roughness BRDF where they have a roughness, or show their base colour if unlit. Where a triangle
/// has corner normals its shadow rays start above it, on the smooth surface that they promise (Hanika 2021),
/// so that the edge of a round body's own shadow does not follow its triangles.
Vec3 shade_hit(const ShadeScene& scene, const Hit& hit, const Ray& ray);

/// How far along its normal a shadow ray starts, as a share of the scene's size: above float rounding of a
/// ray tracer that works near the scene's centre, below what can be seen.
inline constexpr double kShadowOffset = 1e-5;

/// Radiance of the background along `direction` (any length, world).
Vec3 shade_background(const Background& background, const Vec3& direction);

/// The mean of the background's radiance about `direction` (world, any length) over a footprint, whose two
/// sides are steps of the direction; `map`: of its picture.
Vec3 background_radiance(const Background& background, const MipMap& map, const Vec3& direction,
                         const std::array<Vec3, 2>& sides);

/// Sets the mip maps of materials and background; keeps those of pictures that stay.
void prepare_textures(ShadeScene& scene);

/// Sets the samples of environment lights; keeps those of a background that stays.
void prepare_lights(ShadeScene& scene);

/// How many samples a light of the scene has.
std::size_t sample_count(const ShadeScene& scene, std::size_t light);

/// One of them, as a point sees it. sample < sample_count().
LightSample light_sample(const ShadeScene& scene, std::size_t light, std::size_t sample, const LitPoint& at);

/// What of a ray's origin and direction (both as the ray has them, not unit) changes along the two sides of
/// the part of the film that it stands for.
struct RayDifferential {
    std::array<Vec3, 2> origin{}, direction{};
};

/// A ray and what it sees.
struct SeenAlong {
    const Hit* hit = nullptr;  // unset: nothing but the background
    const Ray* ray = nullptr;
    // What the material's pictures, or the background's, show where the hit stands for more than one point of
    // them; null: as texels_at has it.
    const MapTexels* texels = nullptr;
    const RayDifferential* differential = nullptr;  // where textures are averaged; null: it stands for itself
    // Sides of the parallelogram on the surface, around the hit, over which caustics are averaged; null: the
    // point alone.
    const std::array<Vec3, 2>* footprint = nullptr;
    bool without_caustics = false;  // light that comes over optics is not asked for
    bool exact_caustics = false;    // it comes by exact rays
    // Receiver's, of what comes over optics.
    const std::atomic<bool>* cancel = nullptr;
};

/// The light at a point of a surface, as it arrives.
struct ReachingLight {
    // Which lights of one sample, whose shadows have hard edges, reach it, as a hash of the set: equal sets
    // have equal ones.
    std::uint64_t lights = 0;
    ArrivedLight arrived;  // of a plain surface only `matt`: irradiance over pi, and the ambient radiance
    // Radiance of what comes over optics, a part of the light that shade_rays gives and no part of `arrived`.
    Vec3 caustic{0};
};

/// What the rays show: each hit's shade (the same bits as shade_hit's where neither texels nor differential
/// is given), or the background. light.size() == seen.size(). `reaching`: gets the light at each hit that is
/// lit, if it is not empty; then it has that size, too.
void shade_rays(const ShadeScene& scene, std::span<const SeenAlong> seen, std::span<Vec3> light,
                std::span<ReachingLight> reaching = {});

/// Only the light at each hit. All must be hits of materials that are lit.
void find_reaching_light(const ShadeScene& scene, std::span<const SeenAlong> seen,
                         std::span<ReachingLight> reaching);

/// What the surface there is like.
SurfaceLook look_at(const ShadeScene& scene, const Hit& hit, const MapTexels& texels);

/// Normals at a point of a triangle; unit, on the side that is looked at.
struct SurfaceNormals {
    Vec3 shading{0}, geometric{0};  // the mesh's, between its corners; the triangle's plane's
};

/// The light that was baked into the surface there, irradiance over pi, on the side that faces against
/// `toward`.
Vec3 baked_light_at(const ShadeScene& scene, const Hit& hit, const Vec3& toward);

/// The normal there that light comes to, where the material's normal map shows `in_map`. The tangent is the
/// mean of the corners' by their weights, at right angles to the normal; where they have none it is the
/// triangle's own derivative by u.
Vec3 mapped_normal(const ShadeScene& scene, const Hit& hit, const SurfaceNormals& surface,
                   const Vec3& in_map);

/// Whether the surface there is matt and has no map but its colours'.
bool is_plain(const ShadeScene& scene, const Hit& hit);

/// Whether the material there is lit: else it shows its base colour.
bool is_lit(const ShadeScene& scene, const Hit& hit);

/// Whether what is seen there is of pictures or of the mesh's own colours: of the material, or of the
/// background where nothing is hit.
bool has_texture(const ShadeScene& scene, const Hit& hit);

/// Whether pictures say how light comes to the surface there, not just what colour it has.
bool has_light_maps(const ShadeScene& scene, const Hit& hit);

/// What the pictures show there, or the background's radiance: means over the ray's footprint where it has a
/// differential. Of `seen` no texels are asked for.
MapTexels texels_at(const ShadeScene& scene, const SeenAlong& seen);

/// How much of what lies behind the material hides there: 0..1, by the alpha of its base colour's picture.
double opacity_at(const ShadeScene& scene, const Hit& hit);

/// Reflectance of a polished metal by Schlick's approximation, as glTF has it:
/// f0 + (1 - f0) (1 - cos)^5, cos the cosine of incidence in 0..1.
/// Source: Schlick, An Inexpensive BRDF Model for Physically-based Rendering, 1994.
Vec3 metal_reflectance(const Vec3& f0, double cos_incident);

/// Share of light left after `distance` in an absorbing medium (Beer's law in KHR_materials_volume's terms):
/// attenuation_color ^ (distance / attenuation_distance); 1 where the material does not absorb.
Vec3 volume_transmittance(const Material& material, double distance);

}  // namespace trilens
