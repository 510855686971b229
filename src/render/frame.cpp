#include "render/frame.h"

#include <algorithm>

namespace trilens {
namespace {

FramedOptic frame_optic(const World& world, std::size_t index, const CameraRays& camera, int resolution) {
    const Optic& optic = world.optics[index];
    const RenderSettings& settings = world.scene.render;
    FramedOptic framed;
    framed.facets = optic_facets(world, index, grid_resolution(optic, resolution));
    if (camera.model) {
        framed.model = camera.model;
        framed.film_grid =
            std::make_shared<FilmGrid>(make_film_grid(framed.facets->grid(), *camera.model, camera.film));
    }
    const auto add = [&](Path path) {
        const double ior = world.scene.materials[optic.material].ior;
        framed.paths.push_back(
            camera.linear ? make_path_mesh(path, framed.facets->grid(), *camera.linear, ior)
                          : make_path_mesh(path, framed.film_grid->grid, framed.film_grid->views, ior));
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
        frame.optics.push_back(frame_optic(world, i, frame.camera, resolution));
        const std::vector<Vec3>& normals = frame.optics.back().facets->grid().corner_normal;
        const auto bad = std::count(normals.begin(), normals.end(), Vec3(0));
        if (bad > 0 && warn)
            warn(world.names[world.optics[i].mesh] + ": " + std::to_string(bad) +
                 " grid corners have no normal; the facets there show nothing");
        const std::shared_ptr<const FilmGrid>& placed = frame.optics.back().film_grid;
        if (placed && placed->lost > 0 && warn)
            warn(world.names[world.optics[i].mesh] + ": " + std::to_string(placed->lost) +
                 " facets lie across a pole of the camera or reach where it has no image; what they reflect "
                 "or refract is not drawn");
    }
    return frame;
}

const RayMesh* find_path(const FramedOptic& optic, Path path) {
    for (const PathMesh& one : optic.paths)
        if (one.path == path) return &one.mesh;
    return nullptr;
}

}  // namespace trilens
