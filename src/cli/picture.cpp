#include "cli/picture.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "base/error.h"
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

/// Refuses a film whose layers alone would fill the machine's memory: the system would end the program
/// without a word.
void check_film_fits(const World& world, const LayerRequest& window) {
    constexpr double kBytesPerPixel = 2 * 34 * 4;  // up to 34 channels, once more while they are encoded
    const double needed = kBytesPerPixel * (window.x1 - window.x0) * (window.y1 - window.y0);
    const double memory =
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    if (needed < memory) return;
    char text[200];
    std::snprintf(text, sizeof text, "an image of %d x %d pixels needs about %.0f GiB; this machine has %.0f",
                  window.x1 - window.x0, window.y1 - window.y0, needed / (1 << 30), memory / (1 << 30));
    throw InputError(world.scene.file, "/film", text);
}

}  // namespace

Picture draw_picture(const World& world, const PictureRequest& request, Console& console) {
    check_film_fits(world, request.layers);
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
