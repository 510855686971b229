#include "scene/data/light_objects.h"

#include <optional>

#include "scene/data/primitive_mesh.h"

namespace trilens {
namespace {

constexpr int kSides = 64;

ObjectPrimitive shape_of(const RectangleLight& light) {
    return {.center = light.position,
            .axis = light.direction,
            .tangent = normalize_or_zero(sides_of(light).width),
            .kind = PlanePrimitive{light.size}};
}

ObjectPrimitive shape_of(const DiskLight& light) {
    const RectangleLight square{.direction = light.direction};
    return {.center = light.position,
            .axis = light.direction,
            .tangent = normalize_or_zero(sides_of(square).width),
            .kind = DiskPrimitive{light.radius},
            .segments = kSides};
}

ObjectPrimitive shape_of(const SphereLight& light) {
    return {.center = light.position, .kind = SpherePrimitive{light.radius}, .segments = kSides};
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
