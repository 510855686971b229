// The digest of a scene changes with whatever a picture could depend on, and with nothing else.
#include "scene/data/scene_digest.h"

#include <functional>
#include <set>
#include <vector>

#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::shared_ptr<const Texture> texture(float value) {
    return std::make_shared<Texture>(Texture{1, 1, {value, 0, 0}, {}});
}

/// One of every kind of thing, with no list empty.
Scene full_scene() {
    Scene scene;
    CameraDescription camera;
    scene.cameras = {camera, camera};
    scene.cameras[1].kind = RayMeshCamera{{{1, 2, 3}}, {{1, 2, 3}}, {{0, 1}}, {{0, 0, 0}}};
    Material material;
    material.base_color_texture = texture(1);
    scene.materials = {material};
    Mesh mesh;
    mesh.object = {{{1, 2, 3}}, {{0, 0, 0}}, {{}}, {{}}, {{}}, {{}}, {{}}, {0}, {}};
    mesh.primitive = Primitive{};
    mesh.cage = {{{1, 2, 3}}, {3}, {0, 0, 0}, {}, {}, {0}, {2}, {1.5}, {0}, {2.5}, {0}, {}};
    scene.meshes = {mesh, mesh};
    Light sun;
    sun.kind = DirectionalLight{};
    scene.lights = {sun};
    return scene;
}

using Change = std::function<void(Scene&)>;

std::vector<Change> changes_of_looks() {
    return {[](Scene& s) { s.film.width = 7; },
            [](Scene& s) { s.film.height = 7; },
            [](Scene& s) { s.film.spp = 7; },
            [](Scene& s) { s.own_camera = 1; },
            [](Scene& s) { s.background.color.z = 0.5; },
            [](Scene& s) { s.background.environment = texture(1); },
            [](Scene& s) { s.background.environment = texture(2); },
            [](Scene& s) { s.background.rotate_cos = 0; },
            [](Scene& s) { s.background.rotate_sin = 1; },
            [](Scene& s) { s.materials[0].name = "a"; },
            [](Scene& s) { s.materials[0].base_color_factor.y = 0.25; },
            [](Scene& s) { s.materials[0].base_color_texture = nullptr; },
            [](Scene& s) { s.materials[0].base_color_texture = texture(2); },
            [](Scene& s) { s.materials[0].base_color_sampler.uv_set = 1; },
            [](Scene& s) { s.materials[0].unlit = true; },
            [](Scene& s) { s.materials[0].metallic_factor = 1; },
            [](Scene& s) { s.materials[0].roughness_factor = 1; },
            [](Scene& s) { s.materials[0].brdf = Brdf::kLambert; },
            [](Scene& s) { s.materials[0].transmission_factor = 1; },
            [](Scene& s) { s.materials[0].ior = 1.25; },
            [](Scene& s) { s.materials[0].dispersion = 1; },
            [](Scene& s) { s.materials[0].attenuation_color.x = 0; },
            [](Scene& s) { s.materials[0].attenuation_distance = 1; },
            [](Scene& s) { s.materials[0].alpha_mode = AlphaMode::kMask; },
            [](Scene& s) { s.materials[0].alpha_cutoff = 0.25; },
            [](Scene& s) { s.materials[0].alpha_factor = 0.25; },
            [](Scene& s) { s.materials[0].double_sided = false; },
            [](Scene& s) { s.lights[0].kind = PointLight{}; },
            [](Scene& s) {
                s.lights[0].kind = PointLight{{0, 1, 0}};
            },
            [](Scene& s) { s.lights[0].kind = SpotLight{}; },
            [](Scene& s) { s.lights[0].kind = SpotLight{.outer_cone_angle = 30}; },
            [](Scene& s) { s.lights[0].kind = RectangleLight{}; },
            [](Scene& s) {
                s.lights[0].kind = RectangleLight{.size = {1, 2}};
            },
            [](Scene& s) { s.lights[0].kind = DiskLight{}; },
            [](Scene& s) { s.lights[0].kind = DiskLight{.samples = 4}; },
            [](Scene& s) { s.lights[0].kind = SphereLight{}; },
            [](Scene& s) { s.lights[0].kind = SphereLight{.visible = false}; },
            [](Scene& s) { s.lights[0].kind = AmbientLight{}; },
            [](Scene& s) { s.lights[0].kind = AmbientLight{.distance = 1}; },
            [](Scene& s) { s.lights[0].kind = EnvironmentLight{}; },
            [](Scene& s) { s.lights[0].kind = EnvironmentLight{.samples = 1}; },
            [](Scene& s) { s.lights[0].name = "a"; },
            [](Scene& s) { s.lights[0].color.x = 0; },
            [](Scene& s) { s.lights[0].intensity = 2; },
            [](Scene& s) {
                s.lights[0].kind = DirectionalLight{.direction = {1, 0, 0}};
            },
            [](Scene& s) { s.lights[0].kind = DirectionalLight{.angle = 1}; },
            [](Scene& s) { s.lights[0].shadows = true; },
            [](Scene& s) { s.lights.clear(); },
            [](Scene& s) { s.render.max_depth = 1; },
            [](Scene& s) { s.render.direct = false; },
            [](Scene& s) { s.render.reflect = false; },
            [](Scene& s) { s.render.refract = false; },
            [](Scene& s) { s.render.fresnel = false; }};
}

std::vector<Change> changes_of_shapes() {
    return {[](Scene& s) { s.cameras[0].name = "a"; },
            [](Scene& s) { s.cameras[1].name = "a"; },
            [](Scene& s) { s.cameras[0].kind = RayMeshCamera{}; },
            [](Scene& s) { s.cameras[0].kind = PerspectiveCamera{.yfov = 30}; },
            [](Scene& s) { s.cameras[0].eye.x = 1; },
            [](Scene& s) { s.cameras[0].at.x = 1; },
            [](Scene& s) { s.cameras[0].up.x = 1; },
            [](Scene& s) { s.cameras[0].kind = SphericalCamera{}; },
            [](Scene& s) { s.cameras[0].facets = 9; },
            [](Scene& s) { s.cameras[0].tolerance = 9; },
            [](Scene& s) { std::get<RayMeshCamera>(s.cameras[1].kind).points[0].x = 9; },
            [](Scene& s) { std::get<RayMeshCamera>(s.cameras[1].kind).directions[0].x = 9; },
            [](Scene& s) { std::get<RayMeshCamera>(s.cameras[1].kind).screen[0].x = 9; },
            [](Scene& s) { std::get<RayMeshCamera>(s.cameras[1].kind).triangles[0][2] = 9; },
            [](Scene& s) { s.meshes[0].name = "a"; },
            [](Scene& s) { s.meshes[1].name = "a"; },
            [](Scene& s) { s.meshes[0].role = Role::kOptic; },
            [](Scene& s) { s.meshes[0].material = 0; },
            [](Scene& s) { s.meshes[0].resolution = 9; },
            [](Scene& s) { s.meshes[0].face_count = 9; },
            [](Scene& s) { s.meshes[0].normals.type = NormalOverride::Type::kSphere; },
            [](Scene& s) { s.meshes[0].normals.center.x = 1; },
            [](Scene& s) { s.meshes[0].normals.seed = 1; },
            [](Scene& s) { s.meshes[0].normals.amplitude = 1; },
            [](Scene& s) { s.meshes[0].normals.scale = 2; },
            [](Scene& s) { s.meshes[0].object.points[0].x = 9; },
            [](Scene& s) { s.meshes[0].object.triangles[0][0] = 9; },
            [](Scene& s) { s.meshes[0].object.uvs[0][2].y = 9; },
            [](Scene& s) { s.meshes[0].object.colors[0][2].w = 0.5; },
            [](Scene& s) { s.meshes[0].object.normals[0][2].y = 9; },
            [](Scene& s) { s.meshes[0].object.tangents[0][2].y = 9; },
            [](Scene& s) { s.meshes[0].object.material[0] = 9; },
            [](Scene& s) { s.meshes[0].cage.normals = {Vec3(1, 0, 0)}; },
            [](Scene& s) { s.meshes[0].cage_tangents = {Vec4(1, 0, 0, -1)}; },
            [](Scene& s) { s.meshes[0].primitive.reset(); },
            [](Scene& s) { s.meshes[0].primitive->kind = PlanePrimitive(); },
            [](Scene& s) { s.meshes[0].primitive->center.x = 1; },
            [](Scene& s) { s.meshes[0].primitive->axis.x = 1; },
            [](Scene& s) { s.meshes[0].primitive->tangent.x = 2; },
            [](Scene& s) { s.meshes[0].primitive->kind = SpherePrimitive{2}; },
            [](Scene& s) { s.meshes[0].primitive->kind = ParaboloidPrimitive(); },
            [](Scene& s) {
                s.meshes[0].primitive->kind = ParaboloidPrimitive{2, 1};
            },
            [](Scene& s) {
                s.meshes[0].primitive->kind = ParaboloidPrimitive{1, 2};
            },
            [](Scene& s) {
                s.meshes[0].primitive->kind = CylinderPrimitive{1, 2};
            },
            [](Scene& s) {
                s.meshes[0].primitive->kind = CylinderPrimitive{1, 3};
            },
            [](Scene& s) {
                s.meshes[0].primitive->kind = ConePrimitive{1, 2};
            },
            [](Scene& s) {
                s.meshes[0].primitive->kind = PlanePrimitive{{2, 3}};
            },
            [](Scene& s) { s.meshes[0].cage.points[0].x = 9; },
            [](Scene& s) { s.meshes[0].cage.face_vertex_counts[0] = 4; },
            [](Scene& s) { s.meshes[0].cage.face_vertex_indices[2] = 1; },
            [](Scene& s) { s.meshes[0].cage.scheme = SubdivisionScheme::kLoop; },
            [](Scene& s) { s.meshes[0].cage.interpolate_boundary = InterpolateBoundary::kEdgeOnly; },
            [](Scene& s) { s.meshes[0].cage.crease_indices[0] = 1; },
            [](Scene& s) { s.meshes[0].cage.crease_lengths[0] = 3; },
            [](Scene& s) { s.meshes[0].cage.crease_sharpnesses[0] = 3; },
            [](Scene& s) { s.meshes[0].cage.corner_indices[0] = 1; },
            [](Scene& s) { s.meshes[0].cage.corner_sharpnesses[0] = 3; },
            [](Scene& s) { s.meshes[0].cage.hole_indices.clear(); }};
}

}  // namespace

TEST_CASE("the digest of a scene differs after every change", "[scene]") {
    std::set<std::string> digests{scene_digest(full_scene())};
    std::vector<Change> changes = changes_of_looks();
    for (const Change& change : changes_of_shapes()) changes.push_back(change);
    for (std::size_t i = 0; i < changes.size(); ++i) {
        INFO("change " << i);
        Scene scene = full_scene();
        changes[i](scene);
        CHECK(digests.insert(scene_digest(scene)).second);
    }
    CHECK(digests.size() == changes.size() + 1);
}

TEST_CASE("the digest of a scene does not tell where it came from", "[scene]") {
    const std::string digest = scene_digest(load_text(kRoom));
    CHECK(scene_digest(load_text(kRoom)) == digest);
    Scene scene = load_text(kRoom);
    scene.file = scene.folder = scene.label = scene.resolved = "elsewhere";
    scene.files = {{"a", "b"}};
    scene.warnings = {"c"};
    CHECK(scene_digest(scene) == digest);
    // Equal pictures are equal, wherever they lie in memory.
    CHECK(scene_digest(full_scene()) == scene_digest(full_scene()));
}
