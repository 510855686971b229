#include "shade/shade.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/raymesh/ray_mesh.h"

namespace trilens {
namespace {

struct Frame {
    Vec3 position, geometric_normal, normal;  // unit, both on the viewer's side
    Vec3 shadow_start;                        // of shadow rays: off the surface, on the viewer's side
    Vec3 weights;
    bool smooth = false;  // whether `normal` comes from the mesh's corner normals
};

/// Where the smooth surface that the corner normals promise runs over a point of the triangle: the
/// point's projections onto the corners' tangent planes, averaged by its weights. Corners whose tangent
/// plane it is already in front of leave it where it is, so a hollow surface stays as it is. Source:
/// Hanika, Hacking the Shadow Terminator, Ray Tracing Gems II, chapter 4, 2021.
Vec3 lifted_to_tangent_planes(const Vec3& point, const std::array<Vec3, 3>& corner,
                              const std::array<Vec3, 3>& normal, const Vec3& weights) {
    Vec3 lifted = point;
    for (std::size_t k = 0; k < 3; ++k) {
        const double depth = std::min(0.0, dot(point - corner[k], normal[k]));
        lifted -= weights[static_cast<int>(k)] * depth * normal[k];
    }
    return lifted;
}

Frame frame_at(const ShadeScene& scene, const Hit& hit, const Vec3& toward_surface) {
    const IdTriple& corner = scene.triangles->triangles[hit.triangle];
    const Vec3 &a = scene.triangles->points[corner[0]], &b = scene.triangles->points[corner[1]],
               &c = scene.triangles->points[corner[2]];
    Frame frame;
    frame.position = position(*scene.triangles, hit);
    frame.weights = Vec3(1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric.x, hit.barycentric.y);
    frame.geometric_normal = normalize_or_zero(cross(b - a, c - a));
    if (dot(frame.geometric_normal, toward_surface) > 0) frame.geometric_normal = -frame.geometric_normal;

    // Smooth normals where the mesh has them, turned to the side that is looked at.
    frame.normal = frame.geometric_normal;
    Vec3 surface = frame.position;
    if (hit.triangle < scene.normals.size()) {
        std::array<Vec3, 3> n = scene.normals[hit.triangle];
        const Vec3 smooth =
            normalize_or_zero(frame.weights.x * n[0] + frame.weights.y * n[1] + frame.weights.z * n[2]);
        if (smooth != Vec3(0)) {
            const double side = dot(smooth, frame.geometric_normal) < 0 ? -1 : 1;
            for (Vec3& normal : n) normal *= side;
            frame.smooth = true;
            frame.normal = side * smooth;
            surface = lifted_to_tangent_planes(frame.position, {a, b, c}, n, frame.weights);
        }
    }
    frame.shadow_start = surface + kShadowOffset * scene.size * frame.geometric_normal;
    return frame;
}

/// Whether anything stands between the surface and a sample of a light. Light that arrives from behind a
/// flat triangle is in the triangle's own shadow; on a smooth one it may still pass over the surface that the
/// triangle stands for.
bool is_shadowed(const ShadeScene& scene, const Light& light, const Frame& frame, const LightSample& sample) {
    if (!frame.smooth && dot(frame.geometric_normal, sample.toward) <= 0) return true;
    Segments segment;
    segment.add(frame.shadow_start, sample.target - frame.shadow_start);
    return (light.caustics ? scene.occluded_by_all(segment) : scene.occluded(segment)) != 0;
}

/// Adds the irradiance over pi of one light, or the ambient radiance.
void add_light(const ShadeScene& scene, std::size_t index, const Frame& frame, Vec3& arriving) {
    const Light& light = scene.lights[index];
    if (light.baked) return;
    const bool shadows = is_hindered(light) && scene.occluded;
    if (std::holds_alternative<AmbientLight>(light.kind) && !shadows) {
        arriving += light.intensity * light.color;
        return;
    }
    const LitPoint at{frame.position, frame.normal, scene.size};
    for (std::size_t k = 0; k < sample_count(scene, index); ++k) {
        const LightSample sample = light_sample(scene, index, k, at);
        const double cosine = dot(frame.normal, sample.toward);
        if (cosine <= 0 || sample.irradiance == 0) continue;
        if (shadows && is_shadowed(scene, light, frame, sample)) continue;
        double irradiance = std::numbers::inv_pi * sample.irradiance * cosine;
        if (shadows && scene.let_through)
            irradiance *= scene.let_through({frame.shadow_start, sample.target - frame.shadow_start});
        arriving += irradiance * (sample.color * light.color);
    }
}

}  // namespace

Vec3 shade_hit(const ShadeScene& scene, const Hit& hit, const Ray& ray) {
    const Material& material = scene.materials[scene.material[hit.triangle]];
    const SeenAlong seen{&hit, &ray};
    if (material.unlit) return texels_at(scene, seen).base;
    if (!is_plain(scene, hit)) {
        Vec3 light;
        shade_rays(scene, {&seen, 1}, {&light, 1});
        return light;
    }
    const Frame frame = frame_at(scene, hit, ray.direction);

    Vec3 arriving = baked_light_at(scene, hit, ray.direction);
    for (std::size_t l = 0; l < scene.lights.size(); ++l) add_light(scene, l, frame, arriving);
    Vec3 caustic(0);
    if (scene.caustic)
        for (std::size_t l = 0; l < scene.lights.size(); ++l)
            if (has_followed_light(scene.lights[l]))
                caustic +=
                    std::numbers::inv_pi *
                    scene.caustic(
                        l, {frame.position, frame.geometric_normal, frame.normal, frame.shadow_start, {}});
    return outgoing_radiance(look_at(scene, hit, texels_at(scene, seen)), {.matt = arriving + caustic});
}

Vec3 metal_reflectance(const Vec3& f0, double cos_incident) {
    const double grazing = 1 - std::clamp(cos_incident, 0.0, 1.0);
    const double power = grazing * grazing * grazing * grazing * grazing;
    return f0 + (Vec3(1) - f0) * power;
}

Vec3 volume_transmittance(const Material& material, double distance) {
    if (!(material.attenuation_distance > 0)) return Vec3(1);
    const double exponent = distance / material.attenuation_distance;
    return {std::pow(material.attenuation_color.x, exponent),
            std::pow(material.attenuation_color.y, exponent),
            std::pow(material.attenuation_color.z, exponent)};
}

}  // namespace trilens
