#include "scene/data/scene_digest.h"

#include "base/description/digest.h"

namespace trilens {
namespace {

// Each structure is taken apart by all of its members: one that is added does not compile until it is named
// here.

void add(const std::shared_ptr<const Texture>& texture, Digest& digest) {
    digest.add(texture != nullptr);
    if (!texture) return;
    const auto& [width, height, rgb, alpha, is_premultiplied] = *texture;
    digest.add_all(width, height, rgb, alpha, is_premultiplied);
}

void add(const PerspectiveCamera& camera, Digest& digest) {
    const auto& [yfov, shift, near_depth, far_depth] = camera;
    digest.add_all(yfov, shift, near_depth, far_depth);
}

void add(const OrthographicCamera& camera, Digest& digest) {
    const auto& [ymag] = camera;
    digest.add(ymag);
}

void add(const ObliqueCamera& camera, Digest& digest) {
    const auto& [ymag, angle, scale] = camera;
    digest.add_all(ymag, angle, scale);
}

void add(const ViewVolume& camera, Digest& digest) {
    const auto& [vrp, vpn, vup, prp, window, parallel, front, back] = camera;
    digest.add_all(vrp, vpn, vup, prp, window, parallel, front, back);
}

void add(const CylindricalCamera& camera, Digest& digest) {
    const auto& [yfov, hfov] = camera;
    digest.add_all(yfov, hfov);
}

void add(const SphericalCamera& camera, Digest& digest) {
    const auto& [hfov, vfov] = camera;
    digest.add_all(hfov, vfov);
}

void add(const FisheyeCamera& camera, Digest& digest) {
    const auto& [mapping, fov] = camera;
    digest.add_all(mapping, fov);
}

void add(const OpencvLens& camera, Digest& digest) {
    const auto& [fisheye, fx, fy, cx, cy, distortion] = camera;
    digest.add_all(fisheye, fx, fy, cx, cy, distortion);
}

void add(const PushbroomCamera& camera, Digest& digest) {
    const auto& [yfov, travel] = camera;
    digest.add_all(yfov, travel);
}

void add(const CrossedSlitsCamera& camera, Digest& digest) {
    const auto& [slits, window] = camera;
    digest.add(window);
    for (const auto& [point, direction] : slits) digest.add_all(point, direction);
}

void add(const ThreeRayCamera& camera, Digest& digest) {
    const auto& [placed_rays] = camera;
    for (const auto& [point, direction, place] : placed_rays) digest.add_all(point, direction, place);
}

void add(const DistortionCamera& camera, Digest& digest) {
    const auto& [yfov, detail, context_fov] = camera;
    digest.add_all(yfov, detail, context_fov);
}

void add(const CameraDescription& camera, Digest& digest);

void add(const MultiPerspectiveCamera& camera, Digest& digest) {
    const auto& [views, blend] = camera;
    digest.add_all(blend, views.size());
    for (const auto& [one, of_film] : views) {
        add(one, digest);
        digest.add(of_film);
    }
}

void add(const InwardSphereCamera& camera, Digest& digest) {
    const auto& [hfov, vfov, center, radius] = camera;
    digest.add_all(hfov, vfov, center, radius);
}

void add(const PlanarContextCamera& camera, Digest& digest) {
    const auto& [yfov, angle, ground_point, ground_normal, bend] = camera;
    digest.add_all(yfov, angle, ground_point, ground_normal, bend);
}

void add(const RayMeshCamera& camera, Digest& digest) {
    const auto& [points, directions, screen, triangles] = camera;
    digest.add_all(points, directions, screen, triangles);
}

void add(const CameraDescription& camera, Digest& digest) {
    const auto& [name, eye, at, up, facets, tolerance, kind] = camera;
    digest.add_all(name, eye, at, up, facets, tolerance, kind.index());
    std::visit([&](const auto& one) { add(one, digest); }, kind);
}

void add(const Background& background, Digest& digest) {
    const auto& [color, environment, rotate_cos, rotate_sin] = background;
    digest.add_all(color, rotate_cos, rotate_sin);
    add(environment, digest);
}

void add(const TextureSampler& sampler, Digest& digest) {
    const auto& [wrap_s, wrap_t, at_zero, along_u, along_v, uv_set] = sampler;
    digest.add_all(wrap_s, wrap_t, at_zero, along_u, along_v, uv_set);
}

void add(const PlacedTexture& texture, Digest& digest) {
    const auto& [picture, sampler] = texture;
    add(picture, digest);
    add(sampler, digest);
}

void add(const Material& material, Digest& digest) {
    const auto& [name, color, texture, sampler, unlit, metallic, roughness, transmission, ior, dispersion,
                 attenuation, distance, brdf, specular, specular_color, emissive, normal_scale,
                 occlusion_strength, metallic_roughness_map, normal_map, occlusion_map, emissive_map,
                 alpha_mode, alpha_cutoff, alpha_factor, double_sided] = material;
    digest.add_all(name, color, unlit, metallic, roughness, transmission, ior, dispersion, attenuation,
                   distance, brdf, specular, specular_color, emissive, normal_scale, occlusion_strength,
                   alpha_mode, alpha_cutoff, alpha_factor);
    add(texture, digest);
    add(sampler, digest);
    for (const PlacedTexture* map : {&metallic_roughness_map, &normal_map, &occlusion_map, &emissive_map})
        add(*map, digest);
    if (!double_sided) digest.add(double_sided);  // keys of older sweeps stay
}

void add(const DirectionalLight& light, Digest& digest) {
    const auto& [direction, angle, samples] = light;
    digest.add_all(direction, angle, samples);
}

void add(const PointLight& light, Digest& digest) {
    const auto& [position] = light;
    digest.add(position);
}

void add(const SpotLight& light, Digest& digest) {
    const auto& [position, direction, inner, outer] = light;
    digest.add_all(position, direction, inner, outer);
}

void add(const RectangleLight& light, Digest& digest) {
    const auto& [position, direction, size, up, samples, visible] = light;
    digest.add_all(position, direction, size, up, samples, visible);
}

void add(const DiskLight& light, Digest& digest) {
    const auto& [position, direction, radius, samples, visible] = light;
    digest.add_all(position, direction, radius, samples, visible);
}

void add(const SphereLight& light, Digest& digest) {
    const auto& [position, radius, samples, visible] = light;
    digest.add_all(position, radius, samples, visible);
}

void add(const AmbientLight& light, Digest& digest) {
    const auto& [distance, samples] = light;
    digest.add_all(distance, samples);
}

void add(const EnvironmentLight& light, Digest& digest) {
    const auto& [samples] = light;
    digest.add(samples);
}

void add(const Light& light, Digest& digest) {
    const auto& [name, color, intensity, shadows, caustics, baked, kind] = light;
    digest.add_all(name, color, intensity, shadows, caustics, kind.index());
    if (baked) digest.add(baked);  // keys of older sweeps stay
    std::visit([&](const auto& one) { add(one, digest); }, kind);
}

void add(const Primitive& primitive, Digest& digest) {
    auto [center, axis, tangent, kind, is_mirrored] = primitive;
    digest.add_all(center, axis, tangent, kind.index());
    if (is_mirrored) digest.add(is_mirrored);  // keys of older sweeps stay
    const auto add_length = [&](double length, const char*) { digest.add(length); };
    std::visit([&](auto& one) { for_each_length(one, add_length); }, kind);
    if (const auto* lens = std::get_if<LensPrimitive>(&kind)) {
        for (const LensSide& side : {lens->front, lens->back}) {
            const auto& [curvature, conic, coefficients, aperture, normal_departures, form, across_curvature,
                         across_conic, terms_radius] = side;  // the last one: for warnings alone
            digest.add_all(curvature, conic, coefficients, aperture, normal_departures);
            if (!is_round(side))  // keys of older sweeps stay
                digest.add_all(static_cast<std::size_t>(form), across_curvature, across_conic);
        }
        digest.add(lens->hole);
    }
}

void add(const Cage& cage, Digest& digest) {
    const auto& [points, counts, indices, scheme, boundary, crease_indices, crease_lengths, creases,
                 corner_indices, corners, holes, normals] = cage;
    digest.add_all(points, counts, indices, scheme, boundary, crease_indices, crease_lengths, creases,
                   corner_indices, corners, holes, normals);
}

void add(const Mesh& mesh, Digest& digest) {
    [[maybe_unused]] const auto& [name, role, material, resolution, grid, rays, layered, face_count, normals,
                                  priority, object, primitive, cage, cage_uvs, cage_tangents, maps_normals,
                                  of_patches, patches, terrain] = mesh;
    digest.add_all(name, role, material, resolution, grid, rays, layered, face_count, priority);
    const auto& [type, center, seed, amplitude, scale] = normals;
    digest.add_all(type, center, seed, amplitude, scale);
    const auto& [points, triangles, uvs, second_uvs, colors, corner_normals, tangents, materials, baked] =
        object;
    digest.add_all(points, triangles, uvs, second_uvs, colors, corner_normals, materials);
    if (!tangents.empty()) digest.add(tangents);  // keys of older sweeps stay
    if (!baked.empty()) digest.add(baked);
    digest.add(primitive.has_value());
    if (primitive) add(*primitive, digest);
    add(cage, digest);
    digest.add_all(cage_uvs, maps_normals);  // a terrain is its triangles
    if (!cage_tangents.empty()) digest.add(cage_tangents);
    for (const RationalPatch& patch : patches) {
        const auto& [degree_u, degree_v, origin, controls] = patch;
        digest.add_all(degree_u, degree_v, origin, controls);
    }
}

void add(const TransferPoint& point, Digest& digest) {
    const auto& [value, color, extinction] = point;
    digest.add_all(value, color, extinction);
}

void add(const Volume& volume, Digest& digest) {
    const auto& [name, field, cells, transfer] = volume;
    digest.add_all(name, field, transfer.points.size());
    for (const TransferPoint& point : transfer.points) add(point, digest);
    digest.add(cells != nullptr);
    if (cells) digest.add_all(cells->points, cells->scalars, cells->cells);
}

void add(const PointCloud& cloud, Digest& digest) {
    const auto& [name, places, colors, color, radius, size, min_weight] = cloud;
    digest.add_all(name, places, colors, color, radius, size, min_weight);
}

void add(const Label& label, Digest& digest) {
    [[maybe_unused]] const auto& [style, place, color, offset, dot, min_weight, gives_way, priority,
                                  letters] = label;
    digest.add_all(style.text, style.size, style.font, place, color, offset, dot, min_weight);
    if (gives_way) digest.add(priority);  // keys of older sweeps stay
}

template <typename T>
void add(const std::vector<T>& list, Digest& digest) {
    digest.add(list.size());
    for (const T& one : list) add(one, digest);
}

}  // namespace

std::string mesh_digest(const Mesh& mesh) {
    Digest digest;
    add(mesh, digest);
    return digest.digits();
}

std::string camera_digest(const CameraDescription& camera) {
    Digest digest;
    add(camera, digest);
    return digest.digits();
}

std::string scene_digest(const Scene& scene) {
    [[maybe_unused]] const auto& [file, folder, label, resolved, film, cameras, own_camera, background,
                                  materials, meshes, lights, volumes, points, labels, render, files,
                                  warnings] = scene;
    Digest digest;
    const auto& [width, height, spp, filter] = film;
    digest.add_all(width, height, spp, filter, own_camera);
    add(cameras, digest);
    add(background, digest);
    add(materials, digest);
    add(meshes, digest);
    add(lights, digest);
    add(volumes, digest);
    const auto& [max_depth, direct, reflect, refract, fresnel, max_error, rough_samples, rough_truth_samples,
                 certify] = render;
    digest.add_all(max_depth, direct, reflect, refract, fresnel, max_error);
    // What older scenes could not have is added where it is there, so that their keys stay.
    if (rough_samples != RenderSettings().rough_samples ||
        rough_truth_samples != RenderSettings().rough_truth_samples)
        digest.add_all(rough_samples, rough_truth_samples);
    if (certify) digest.add(certify);
    if (!points.empty()) add(points, digest);
    if (!labels.empty()) add(labels, digest);
    return digest.digits();
}

}  // namespace trilens
