#include "scene/data/light_objects.h"

#include <optional>

#include "scene/data/primitive_mesh.h"

namespace trilens {
namespace {

constexpr int kSides = 64;

ObjectPrimitive shape_of(const RectangleLight& light) {
    // A plane's size is along tangent and axis x tangent.
    ObjectPrimitive plane{ObjectShape::kPlane, light.position, light.direction};
    plane.tangent = normalize_or_zero(sides_of(light).width);
    plane.size = {light.size.x, light.size.y, 0};
    return plane;
}

ObjectPrimitive shape_of(const DiskLight& light) {
    ObjectPrimitive disk{ObjectShape::kDisk, light.position, light.direction};
    disk.tangent = normalize_or_zero(sides_of(RectangleLight{.direction = light.direction}).width);
    disk.radius = light.radius;
    disk.segments = kSides;
    return disk;
}

ObjectPrimitive shape_of(const SphereLight& light) {
    ObjectPrimitive sphere{ObjectShape::kSphere, light.position};
    sphere.radius = light.radius;
    sphere.segments = kSides;
    return sphere;
}

std::optional<ObjectPrimitive> shape_of(const Light& light) {
    return std::visit(
        [](const auto& kind) -> std::optional<ObjectPrimitive> {
            if constexpr (requires { shape_of(kind); }) return shape_of(kind);
            return std::nullopt;
        },
        light.kind);
}

}  // namespace

void add_light_objects(Scene& scene) {
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        const Light& light = scene.lights[l];
        const std::optional<ObjectPrimitive> shape = shape_of(light);
        if (!shape || !is_visible(light)) continue;
        Material material;
        material.name = light.name.empty() ? "light" + std::to_string(l) : light.name;
        material.base_color_factor = light.intensity * light.color;
        material.unlit = true;

        const PolygonMesh polygons = tessellate(*shape);
        Mesh mesh;
        mesh.name = material.name;
        mesh.material = static_cast<Id>(scene.materials.size());
        mesh.face_count = polygons.cage.face_vertex_counts.size();
        mesh.object = triangulate(polygons).object;
        mesh.object.material.assign(mesh.object.triangles.size(), mesh.material);
        scene.materials.push_back(std::move(material));
        scene.meshes.push_back(std::move(mesh));
    }
}

}  // namespace trilens
