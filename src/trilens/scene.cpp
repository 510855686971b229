#include "trilens/scene.h"

#include <filesystem>
#include <map>
#include <sstream>

#include "base/error.h"
#include "base/nearest.h"
#include "image/image_io.h"

namespace trilens {
namespace {

TextureReader texture_reader() {
    return {read_texture, decode_texture};
}

bool is_image(const std::string& file) {
    return file.size() > 4 && file.compare(file.size() - 4, 4, ".exr") == 0;
}

/// A file that the image was drawn with may hold something else now. `recorded`: "hash path" per line.
void warn_of_changed_files(const std::string& image, const std::string& recorded, Scene& scene) {
    std::map<std::string, std::string> then;
    std::istringstream lines(recorded);
    for (std::string hash, path; lines >> hash && lines.get() && std::getline(lines, path);)
        then[path] = hash;
    for (const FileRead& now : scene.files) {
        const auto found = then.find(now.path);
        if (found != then.end() && found->second != now.hash)
            scene.warnings.push_back(image + ": " + now.path +
                                     " has changed since the image was drawn, which may look different now");
    }
}

Scene load_scene_of_image(const std::string& file, std::span<const SceneOverride> overrides) {
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
    Scene scene = load_scene_text(json, has_folder ? SceneSource(file, folder) : SceneSource(file), overrides,
                                  texture_reader());
    for (std::size_t c = 0; c < scene.cameras.size(); ++c)
        if (scene.cameras[c].name == camera) scene.own_camera = c;
    warn_of_changed_files(file, text("trilens:files"), scene);
    return scene;
}

}  // namespace

Scene load_scene(const SceneRequest& request) {
    Scene scene = is_image(request.file) ? load_scene_of_image(request.file, request.overrides)
                                         : load_scene(request.file, request.overrides, texture_reader());
    if (request.resolution != 0) set_resolution(scene, request.resolution);
    return scene;
}

Scene parse_scene(const std::string& json, const std::string& folder,
                  std::span<const SceneOverride> overrides) {
    return load_scene_text(json, SceneSource("", folder), overrides, texture_reader());
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
