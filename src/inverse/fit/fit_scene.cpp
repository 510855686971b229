#include "inverse/fit/fit_problem.h"

#include <algorithm>
#include <cmath>

#include "base/util/error.h"
#include "base/util/format.h"
#include "render/world/world.h"
#include "scene/read/reading.h"
#include "shade/optic_weights.h"
#include "surfaces/surfaces.h"

namespace trilens {
namespace {

/// Facets of the grid that finds the face under a ray, along a face and of a surface: enough for tracers
/// (n = 4 was never wrong, see LimitTracer), few enough to be built again at every step.
constexpr int kFewestTracedSquares = 4, kMostTracedSquares = 16;
constexpr std::size_t kTracedFacets = 20'000;

std::shared_ptr<const LimitTracer> make_tracer(const Surface& surface) {
    if (surface.has_closed_form()) return std::make_shared<const LimitTracer>(surface, SurfaceGrid{});
    const auto faces = static_cast<double>(std::max<std::size_t>(1, surface.face_count()));
    const int n = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(kTracedFacets) / (2 * faces))),
                             kFewestTracedSquares, kMostTracedSquares);
    return std::make_shared<const LimitTracer>(surface, make_grid(surface, n));
}

Transform inverse_of(const Transform& t) {
    const Mat3 linear = glm::inverse(t.linear);
    return {linear, -(linear * t.translation)};
}

double ior_of(const Json& material) {
    return material.contains("ior") ? material.at("ior").get<double>() : Material().ior;
}

/// Says which normals an optic has that are not those of its surface, and where the scene says so.
[[noreturn]] void refuse(const Scene& scene, std::size_t optic) {
    const Mesh& mesh = scene.meshes[optic];
    const std::string place = fmt::format("/meshes/{}/", optic);
    if (mesh.normals.type != NormalOverride::Type::kSmooth)
        throw InputError(scene_title(scene), place + "normals",
                         "an optic whose normals are overridden cannot be fitted");
    if (mesh.maps_normals)
        throw InputError(
            scene_title(scene), fmt::format("/materials/{}/normalTexture", mesh.material),
            fmt::format("turns the normals of optic \"{}\", which then cannot be fitted", mesh.name));
    throw InputError(scene_title(scene), place + "subdivisionScheme",
                     "\"none\" interpolates normals between the corners, and such an optic cannot be fitted; "
                     "with \"bilinear\" flat faces stay flat, and have their own");
}

const TextureReader& no_pictures() {
    static const TextureReader reader{
        [](const std::string& file) -> std::shared_ptr<const Texture> {
            throw InputError(file, "", "a picture is no part of what is fitted");
        },
        [](std::span<const unsigned char>, const std::string& name) -> std::shared_ptr<const Texture> {
            throw InputError(name, "", "a picture is no part of what is fitted");
        }};
    return reader;
}

}  // namespace

SurfacePoint moved_point(const FitOptic& optic, const SurfacePoint& as_built) {
    if (!optic.is_moved) return as_built;
    const Mat3& linear = optic.moved.linear;
    SurfacePoint point;
    point.position = map_point(optic.moved, as_built.position);
    point.du = linear * as_built.du, point.dv = linear * as_built.dv;
    point.duu = linear * as_built.duu, point.duv = linear * as_built.duv, point.dvv = linear * as_built.dvv;
    point.normal = normalize_or_zero(normal_map(optic.moved) * as_built.normal);
    return point;
}

FitSceneMaker::FitSceneMaker(const Scene& scene) : scene_(scene) {
    for (std::size_t m = 0; m < scene.meshes.size(); ++m)
        if (scene.meshes[m].role == Role::kOptic && !has_own_normals(scene.meshes[m])) refuse(scene, m);
}

FitScene FitSceneMaker::make(const Json& document, const std::vector<FitParameter>& parameters) {
    moves_only_.clear();
    // Behind the document's meshes are those of area lights.
    for (std::size_t m = 0; m < document.at("meshes").size(); ++m) {
        const Json& mesh = document.at("meshes").at(m);
        const bool moves = std::all_of(parameters.begin(), parameters.end(), [&](const FitParameter& p) {
            return p.part != ScenePart::kMesh || p.index != m || p.inside.starts_with("/transform/");
        });
        if (moves && !scene_.meshes[m].primitive && !mesh.contains("fit")) moves_only_.insert(m);
    }

    FitScene made;
    for (std::size_t c = 0; c < scene_.cameras.size(); ++c)
        made.cameras.push_back(camera_of(document.at("cameras").at(c), c));
    for (std::size_t m = 0; m < scene_.meshes.size(); ++m) {
        const Mesh& mesh = scene_.meshes[m];
        if (mesh.role != Role::kOptic) continue;
        FitOptic optic;
        optic.mesh = static_cast<Id>(m);
        optic.mirror = is_mirror(scene_.materials[mesh.material]);
        optic.priority = mesh.priority;
        optic.ior = ior_of(document.at("materials").at(mesh.material));
        const Json& json = document.at("meshes").at(m);
        const std::string name = file();
        optic.built = read_transform({json, "/meshes/" + std::to_string(m), name});
        build(optic, mesh, true);
        made.optics.push_back(std::move(optic));
    }
    ask_media(made);
    return made;
}

void FitSceneMaker::set_part(FitScene& scene, const FitParameter& parameter, const Json& part,
                             bool with_tracer) const {
    if (parameter.part == ScenePart::kCamera) {
        scene.cameras[parameter.index] = camera_of(part, parameter.index);
    } else if (parameter.part == ScenePart::kMaterial) {
        for (FitOptic& optic : scene.optics)
            if (scene_.meshes[optic.mesh].material == parameter.index) optic.ior = ior_of(part);
    } else {
        set_mesh(scene, parameter.index, part, with_tracer);
    }
}

Camera FitSceneMaker::camera_of(const Json& json, std::size_t index) const {
    const std::string name = file();
    Reading reading(name, scene_.folder, no_pictures());
    const std::string place = "/cameras/" + std::to_string(index);
    CameraDescription description = read_camera({json, place, name}, index, reading);
    description.tolerance = 0;
    description.facets = 1;  // nobody looks through its RayMesh
    Camera camera = make_camera(
        description, {static_cast<double>(scene_.film.width), static_cast<double>(scene_.film.height)},
        {name, place});
    if (!camera.linear && !(camera.model && camera.model->eye()))
        throw InputError(name, place,
                         "a camera whose rays neither meet in one eye nor are parallel cannot be fitted");
    return camera;
}

void FitSceneMaker::set_mesh(FitScene& scene, std::size_t index, const Json& json, bool with_tracer) const {
    const auto optic = std::find_if(scene.optics.begin(), scene.optics.end(),
                                    [&](const FitOptic& one) { return one.mesh == index; });
    if (optic == scene.optics.end()) return;  // an object: no image of a point depends on it
    const std::string name = file();
    const Node node{json, "/meshes/" + std::to_string(index), name};
    if (moves_only_.count(index) > 0) {
        optic->moved = compose(read_transform(node), inverse_of(optic->built));
        optic->unmoved = inverse_of(optic->moved);
        optic->is_moved = true;
        return;
    }
    Reading reading(name, scene_.folder, no_pictures());
    reading.scene.materials = scene_.materials;
    reading.named_materials = scene_.materials.size();
    build(*optic, read_mesh(node, index, reading), with_tracer);
}

void FitSceneMaker::build(FitOptic& optic, const Mesh& mesh, bool with_tracer) const {
    optic.surface = make_plain_surface(mesh, {});
    optic.tracer = with_tracer ? make_tracer(*optic.surface) : nullptr;
    optic.outline = with_tracer && !optic.mirror
                        ? std::make_shared<const std::vector<Vec3>>(outline_of(*optic.surface))
                        : nullptr;
    optic.moved = optic.unmoved = {};
    optic.is_moved = false;
}

}  // namespace trilens
