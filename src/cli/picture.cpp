#include "cli/picture.h"

#include <algorithm>
#include <chrono>

#include "cli/version.h"

namespace trilens {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string resolution_text(const World& world) {
    std::string text;
    for (const Optic& optic : world.optics)
        text += (text.empty() ? "" : ",") + std::to_string(optic.resolution);
    return text;
}

void tell(const World& world, const PictureRequest& request, const Picture& picture, Console& console) {
    const LayerRequest& window = request.layers;
    const bool whole =
        window.x1 - window.x0 == world.scene.film.width && window.y1 - window.y0 == world.scene.film.height;
    if (whole && !world.optics.empty() && picture.statistics.optic_pixels == 0)
        console.warn("no pixel sees an optic: they are off screen, behind the camera, or hidden");
    if (whole && world.optics.empty()) console.warn("the scene has no optic: only the direct view is drawn");
    if (whole && world.objects.size() == 0)
        console.warn("the scene has no objects: rays see only the background");
    if (picture.statistics.pixels_without_ray > 0)
        console.warn(std::to_string(picture.statistics.pixels_without_ray) +
                     " pixels see a facet without rays (total internal reflection at a corner, or no "
                     "normal); that path is black there");
}

}  // namespace

Picture draw_picture(const World& world, const PictureRequest& request, Console& console) {
    Picture picture;
    auto start = std::chrono::steady_clock::now();
    const Viewer viewer = make_viewer(world, request.camera, request.engine, console.warner());
    picture.prepare_seconds = seconds_since(start);

    start = std::chrono::steady_clock::now();
    picture.image =
        draw_layers(world, viewer, request.layers, console.progress(request.command), &picture.statistics);
    picture.draw_seconds = seconds_since(start);

    auto& header = picture.image.metadata;
    header["trilens:version"] = kVersion;
    header["trilens:command"] = request.command;
    header["trilens:engine"] = engine_name(request.engine.engine);
    if (request.engine.engine == Engine::kClassic)
        header["trilens:classic"] = classic_name(request.engine.classic);
    header["trilens:camera"] = world.scene.cameras[request.camera].name;
    header["trilens:resolution"] = resolution_text(world);
    std::size_t facets = 0;
    for (const Optic& optic : world.optics) facets += optic.facet_count();
    header["trilens:facets"] = std::to_string(facets);
    header["trilens:scene"] = world.scene.resolved;
    header["trilens:folder"] = world.scene.folder;
    tell(world, request, picture, console);
    return picture;
}

}  // namespace trilens
