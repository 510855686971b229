#include "study/scenes.h"

#include <filesystem>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/names.h"
#include "image/image_io.h"
#include "image/zlib_stream.h"
#include "render/project/film_moves.h"
#include "scene/animation.h"
#include "scene/load.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

/// gzip by its first bytes, else zlib.
bool inflate_stream(std::string_view packed, std::span<char> to) {
    std::vector<unsigned char> from(packed.begin(), packed.end());
    const std::span<unsigned char> room(reinterpret_cast<unsigned char*>(to.data()), to.size());
    return packed.starts_with("\x1f\x8b") ? inflate_gzip(from, room) : inflate(from, room);
}

TextureReader texture_reader(const Progress& progress = {}) {
    return {[](const std::string& file) { return read_texture(file); },
            [](std::span<const unsigned char> encoded, const std::string& name) {
                return decode_texture(encoded, name);
            },
            read_heights,
            draw_letters,
            film_moves,
            inflate_stream,
            progress};
}

bool is_image(const std::string& file) {
    return file_ending(file) == ".exr";
}

Scene load_scene_of_image(const SceneRequest& request) {
    const std::string& file = request.file;
    const Image image = read_exr(file);
    const auto text = [&](const char* name) {
        const auto found = image.metadata.find(name);
        return found == image.metadata.end() ? std::string() : found->second;
    };
    const std::string json = text("trilens:scene"), folder = text("trilens:folder"),
                      camera = text("trilens:camera");
    if (json.empty()) throw InputError(file, "", "the image carries no scene (trilens:scene)");
    std::error_code none;
    const bool has_folder = !folder.empty() && std::filesystem::is_directory(folder, none);
    Scene scene = load_scene_text(json, has_folder ? SceneSource(file, folder) : SceneSource(file),
                                  request.overrides, texture_reader(request.progress), request.import);
    for (std::size_t c = 0; c < scene.cameras.size(); ++c)
        if (scene.cameras[c].name == camera) scene.own_camera = c;
    for (const std::string& changed : changed_files(scene, text("trilens:files")))
        scene.warnings.push_back(file + ": " + changed +
                                 " has changed since the image was drawn, which may look different now");
    return scene;
}

}  // namespace

Scene load_scene(const SceneRequest& request) {
    Scene scene = is_image(request.file) ? load_scene_of_image(request)
                                         : load_scene(request.file, request.overrides,
                                                      texture_reader(request.progress), request.import);
    if (request.resolution != 0) set_resolution(scene, request.resolution);
    return scene;
}

Scene parse_scene(const std::string& json, const std::string& folder,
                  std::span<const SceneOverride> overrides, const std::string& label,
                  const ImportOptions& import) {
    Scene scene = load_scene_text(json, SceneSource(label.empty() ? kSceneLabel : label, folder), overrides,
                                  texture_reader(), import);
    scene.file.clear();
    scene.label = label;
    return scene;
}

Scene scene_at_frame(const Scene& scene, double frame, std::span<const SceneOverride> changes) {
    return load_frame(scene, frame, changes, texture_reader());
}

Scene scene_on_turntable(const Scene& scene, double frame, std::size_t camera, int frames) {
    const bool moves = find_animation(scene).has_value();
    const std::vector<SceneOverride> turned =
        turntable(moves ? scene_at_frame(scene, frame) : scene, camera, static_cast<int>(frame), frames);
    return scene_at_frame(scene, frame, turned);
}

std::size_t find_camera(const Scene& scene, const std::string& name) {
    if (name.empty()) return scene.own_camera;
    std::vector<std::string> names;
    for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
        if (scene.cameras[c].name == name) return c;
        names.push_back(scene.cameras[c].name);
    }
    throw UsageError("there is no camera \"" + name + "\"" + suggestion(name, names));
}

}  // namespace trilens
