// The first picture while the rest is still compiled: one scene by projection as PNG, by the rooms that draw and no others.
// trilens-first SCENE OUT.png: the same bytes as `trilens render SCENE -o OUT.png`.
#include <cstdio>
#include <exception>
#include <optional>

#include "base/files/files.h"
#include "image/png_strips.h"
#include "render/picture/picture.h"
#include "study/scenes.h"

namespace {

using namespace trilens;

void draw_first(const std::string& scene_file, const std::string& output) {
    SceneRequest from;
    from.file = scene_file;
    Scene scene = load_scene(from);
    check_writable(output, {scene_file});
    const Warn warn = [](const std::string& text) {
        std::fprintf(stderr, "trilens-first: warning: %s\n", text.c_str());
    };
    for (const std::string& warning : scene.warnings) warn(warning);
    PictureRequest request;
    request.frame.camera = scene.own_camera;
    request.frame.facets = FacetUse::kWorthwhile;
    request.layers.layers = {"Z"};
    const std::unique_ptr<World> world = make_world(std::move(scene), warn);
    std::optional<PngStrips> strips;
    const StripSink sink{
        [&](const Image& layout) { strips.emplace("PNG", layout, ToneMapping()); },
        [&](const std::vector<Channel>& channels, int rows) { strips->add(channels, rows); }};
    draw_picture(*world, request, {}, warn, &sink);
    NewFile file(output);
    file.write(0, strips->finish());
    file.commit();
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) {
        std::fprintf(stderr, "trilens-first SCENE OUT.png: draws a scene by projection\n");
        return 2;
    }
    try {
        draw_first(argv[1], argv[2]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "trilens-first: error: %s\n", error.what());
        return 3;
    }
    std::printf("%s\n", argv[2]);
    return 0;
}
