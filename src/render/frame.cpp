#include "render/frame.h"

#include <algorithm>

namespace trilens {
namespace {

FramedOptic frame_optic(const World& world, std::size_t index, const LinearCamera& camera, int resolution) {
    const Optic& optic = world.optics[index];
    const RenderSettings& settings = world.scene.render;
    FramedOptic framed;
    framed.facets = optic_facets(world, index, grid_resolution(optic, resolution));
    const auto add = [&](Path path) {
        framed.paths.push_back(
            make_path_mesh(path, framed.facets->grid(), camera, world.scene.materials[optic.material].ior));
    };
    if (settings.reflect) add(Path::kReflect);
    if (settings.refract && !optic.mirror) add(Path::kRefract);
    return framed;
}

}  // namespace

Frame make_frame(const World& world, const FrameParams& params, const Warn& warn) {
    return make_frame(world, make_camera_rays(world.scene, params.camera), params.resolution, warn);
}

Frame make_frame(const World& world, CameraRays camera, int resolution, const Warn& warn) {
    Frame frame;
    frame.camera = std::move(camera);
    check_facet_count(world, resolution);
    for (std::size_t i = 0; i < world.optics.size(); ++i) {
        frame.optics.push_back(frame_optic(world, i, *frame.camera.linear, resolution));
        const std::vector<Vec3>& normals = frame.optics.back().facets->grid().corner_normal;
        const auto bad = std::count(normals.begin(), normals.end(), Vec3(0));
        if (bad > 0 && warn)
            warn(world.names[world.optics[i].mesh] + ": " + std::to_string(bad) +
                 " grid corners have no normal; the facets there show nothing");
    }
    return frame;
}

PathCamera path_camera(const LinearCamera& camera) {
    PathCamera of_paths;
    of_paths.parallel = camera.parallel;
    of_paths.screen = [&camera](const Vec3& point) { return screen_from_world(camera, point); };
    of_paths.ray = [&camera](const Vec3&, const Vec3& chord) {
        const Vec3 incident = incident_direction(camera, chord);
        return Ray{chord - incident, incident};
    };
    return of_paths;
}

std::unique_ptr<OpticPaths> make_optic_paths(const World& world, const Frame& frame, std::size_t optic) {
    const FramedOptic& framed = frame.optics[optic];
    const Looking looking{&path_world(world), static_cast<Id>(optic), world.optics[optic].surface.get(),
                          path_camera(*frame.camera.linear)};
    const SurfaceGrid& grid = framed.facets->grid();
    if (world.scene.render.max_depth > 0) return std::make_unique<OpticPaths>(looking, grid, DivideParams{});
    return std::make_unique<OpticPaths>(looking, grid, find_path(framed, Path::kReflect),
                                        find_path(framed, Path::kRefract));
}

const RayMesh* find_path(const FramedOptic& optic, Path path) {
    for (const PathMesh& one : optic.paths)
        if (one.path == path) return &one.mesh;
    return nullptr;
}

}  // namespace trilens
