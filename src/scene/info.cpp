// Counts and bounds of a scene.
#include "scene/info.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/description/lens_sag.h"
#include "scene/data/check_scene.h"

namespace trilens {
namespace {

/// The box of a disk: its half-width along e is radius * sqrt(1 - (axis . e)^2).
void grow_by_disk(Box& box, const Vec3& center, const Vec3& axis, double radius) {
    Vec3 half;
    for (int k = 0; k < 3; ++k) half[k] = radius * std::sqrt(std::max(0.0, 1 - axis[k] * axis[k]));
    box.include(center - half);
    box.include(center + half);
}

void grow_by(Box& box, const SpherePrimitive& sphere, const Primitive& at) {
    box.include(at.center - Vec3(sphere.radius));
    box.include(at.center + Vec3(sphere.radius));
}

/// Apex and rim; between them the surface lies in the box of the solid cylinder around it.
void grow_by(Box& box, const ParaboloidPrimitive& paraboloid, const Primitive& at) {
    const double radius = paraboloid.radius;
    grow_by_disk(box, at.center, at.axis, radius);
    grow_by_disk(box, at.center + radius * radius / (4 * paraboloid.focal_length) * at.axis, at.axis, radius);
}

void grow_by(Box& box, const CylinderPrimitive& cylinder, const Primitive& at) {
    grow_by_disk(box, at.center - 0.5 * cylinder.height * at.axis, at.axis, cylinder.radius);
    grow_by_disk(box, at.center + 0.5 * cylinder.height * at.axis, at.axis, cylinder.radius);
}

void grow_by(Box& box, const ConePrimitive& cone, const Primitive& at) {
    grow_by_disk(box, at.center, at.axis, cone.radius);
    box.include(at.center + cone.height * at.axis);
}

/// Rings of both sides, from the vertex to the rim.
void grow_by(Box& box, const LensPrimitive& lens, const Primitive& at) {
    constexpr int kRings = 64, kTurns = 256;
    for (const bool is_front : {true, false}) {
        const LensSide& side = is_front ? lens.front : lens.back;
        const auto z = [&](const Vec2& p) { return sag_over(side, p).z + (is_front ? 0 : lens.thickness); };
        for (int i = 0; i <= kRings; ++i) {
            const double r = side.aperture * i / kRings;
            if (is_round(side)) grow_by_disk(box, at.center + z({r, 0}) * at.axis, at.axis, r);
            for (int k = 0; k < (is_round(side) ? 0 : kTurns); ++k) {
                const double turn = 2 * std::numbers::pi * k / kTurns;
                const Vec2 p = r * Vec2(std::cos(turn), std::sin(turn));
                box.include(at.center + p.x * at.tangent + p.y * cross(at.axis, at.tangent) + z(p) * at.axis);
            }
        }
    }
}

void grow_by(Box& box, const PlanePrimitive& plane, const Primitive& at) {
    const Vec3 u = 0.5 * plane.size.x * at.tangent, v = 0.5 * plane.size.y * cross(at.axis, at.tangent);
    for (const Vec3& corner : {u + v, u - v, -u + v, -u - v}) box.include(at.center + corner);
}

Box primitive_box(const Primitive& primitive) {
    Box box;
    std::visit([&](const auto& kind) { grow_by(box, kind, primitive); }, primitive.kind);
    return box;
}

std::string shape_name(const Mesh& mesh) {
    if (mesh.of_patches) return "patches";
    if (mesh.role == Role::kObject) return mesh.terrain ? "terrain" : "polygons";
    return mesh.primitive ? kind_name(*mesh.primitive) : name_of(mesh.cage.scheme);
}

MeshInfo make_mesh_info(const Mesh& mesh, const Scene& scene) {
    MeshInfo info;
    info.name = mesh.name;
    info.role = mesh.role;
    info.shape = shape_name(mesh);
    info.material = mesh.material == kNone ? "inherit" : scene.materials[mesh.material].name;
    info.faces = mesh.face_count;
    const bool is_object = mesh.role == Role::kObject;
    const std::vector<Vec3>& points = is_object ? mesh.object.points : mesh.cage.points;
    info.points = points.size();
    info.triangles = mesh.object.triangles.size();
    info.creases = mesh.cage.crease_indices.size() -
                   std::min(mesh.cage.crease_indices.size(), mesh.cage.crease_lengths.size());
    info.corners = mesh.cage.corner_indices.size();
    info.holes = mesh.cage.hole_indices.size();
    info.resolution = is_object ? 0 : mesh.resolution;
    if (mesh.primitive) info.bounds = primitive_box(*mesh.primitive);
    for (const RationalPatch& patch : mesh.patches) {
        info.points += patch.points.size();
        info.bounds.include(bounds_of(patch));
    }
    for (const Vec3& point : points) info.bounds.include(point);
    if (mesh.terrain) {
        const Terrain& terrain = *mesh.terrain;
        info.terrain = TerrainInfo{terrain.heights->columns, terrain.heights->rows,  terrain.missing_heights,
                                   terrain.whole_triangles,  terrain.greatest_error, terrain.rms_error};
    }
    return info;
}

MaterialInfo make_material_info(Id index, const Scene& scene) {
    const Material& material = scene.materials[index];
    MaterialInfo info;
    info.name = material.name;
    info.kind = material.metallic_factor == 1       ? "mirror"
                : material.transmission_factor == 1 ? "glass"
                : material.unlit                    ? "unlit"
                                                    : "plain";
    info.has_texture = material.base_color_texture != nullptr;
    for (const Mesh& mesh : scene.meshes) {
        const std::vector<Id>& used = mesh.object.material;
        if (mesh.material == index || std::find(used.begin(), used.end(), index) != used.end()) ++info.meshes;
    }
    return info;
}

VolumeInfo make_volume_info(const Volume& volume) {
    VolumeInfo info;
    info.name = volume.name;
    info.field = volume.field;
    info.cells = volume.cells->counts.cells;
    info.tetrahedra = volume.cells->cells.size();
    info.points = volume.cells->points.size();
    const auto [least, most] =
        std::minmax_element(volume.cells->scalars.begin(), volume.cells->scalars.end());
    info.least = *least;
    info.most = *most;
    for (const Vec3& point : volume.cells->points) info.bounds.include(point);
    return info;
}

}  // namespace

SceneInfo make_scene_info(const Scene& scene) {
    check_scene(scene);
    SceneInfo info;
    for (const CameraDescription& camera : scene.cameras) {
        info.cameras.push_back(camera.name);
        info.camera_types.push_back(kind_name(camera));
    }
    for (const Mesh& mesh : scene.meshes) {
        info.meshes.push_back(make_mesh_info(mesh, scene));
        ++(mesh.role == Role::kObject ? info.objects : info.optics);
        info.triangles += info.meshes.back().triangles;
        info.bounds.include(info.meshes.back().bounds);
    }
    for (Id i = 0; i < scene.materials.size(); ++i) info.materials.push_back(make_material_info(i, scene));
    for (const Volume& volume : scene.volumes) {
        info.volumes.push_back(make_volume_info(volume));
        info.bounds.include(info.volumes.back().bounds);
    }
    for (const PointCloud& cloud : scene.points) {
        CloudInfo& of =
            info.points.emplace_back(CloudInfo{cloud.name, cloud.places.size(), !cloud.colors.empty(), {}});
        for (const Vec3& place : cloud.places) of.bounds.include(place);
        info.bounds.include(of.bounds);
    }
    for (const Label& label : scene.labels) {
        info.labels.push_back(label.style.text);
        info.bounds.include(label.place);
    }
    info.lights = scene.lights.size();
    return info;
}

}  // namespace trilens
