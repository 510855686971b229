#include "cli/scene_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <filesystem>

#include "base/error.h"
#include "cli/json.h"
#include "image/image_io.h"
#include "scene/load.h"
#include "scene/nearest.h"

namespace trilens {
namespace {

const std::vector<std::string> kLayers{"Z", "optic", "direct", "reflect", "refract"};

TextureReader image_reader() {
    return {read_texture, decode_texture};
}

std::vector<SceneOverride> scene_overrides(const SceneOptions& options) {
    std::vector<SceneOverride> overrides;
    for (const std::string& text : options.set) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || text.empty() || text[0] != '/')
            throw UsageError("--set needs /json/pointer=VALUE, not \"" + text + "\"");
        overrides.push_back({text.substr(0, equals), text.substr(equals + 1)});
    }

    // Options that have a place in the file are overrides too, so that the resolved scene holds them.
    if (!options.size.empty()) {
        const std::vector<int> size = parse_integers(options.size, 'x', 2, "--size");
        if (size[0] < 1 || size[1] < 1) throw UsageError("--size " + options.size + " is no film");
        overrides.push_back({"/film/width", std::to_string(size[0])});
        overrides.push_back({"/film/height", std::to_string(size[1])});
    }
    if (options.spp > 0) overrides.push_back({"/film/spp", std::to_string(options.spp)});
    if (options.max_depth >= 0) overrides.push_back({"/render/maxDepth", std::to_string(options.max_depth)});
    return overrides;
}

/// Gives every optic the resolution, in the scene and in its resolved JSON.
void set_resolution(Scene& scene, int resolution) {
    Json resolved = Json::parse(scene.resolved);
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        if (scene.meshes[m].role != Role::kOptic) continue;
        scene.meshes[m].resolution = resolution;
        resolved["meshes"][m]["resolution"] = resolution;
    }
    scene.resolved = resolved.dump();
}

bool is_image(const std::string& file) {
    return file.size() > 4 && file.compare(file.size() - 4, 4, ".exr") == 0;
}

/// The scene that an image carries. Its camera is the scene's own; its files are looked for where the scene's
/// were, or beside the image where that folder is gone.
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
                                  image_reader());
    for (std::size_t c = 0; c < scene.cameras.size(); ++c)
        if (scene.cameras[c].name == camera) scene.own_camera = c;
    return scene;
}

}  // namespace

std::vector<int> parse_integers(const std::string& text, char separator, std::size_t count,
                                const std::string& option) {
    std::vector<int> values;
    const char *at = text.data(), *end = at + text.size();
    while (at <= end) {
        int value = 0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc()) break;
        values.push_back(value);
        at = next;
        if (at == end) break;
        if (*at != separator) break;
        ++at;
    }
    if (at != end || values.size() != count)
        throw UsageError(option + " needs " + std::to_string(count) + " integers separated by '" + separator +
                         "', not \"" + text + "\"");
    return values;
}

void add_scene_options(CLI::App& command, SceneOptions& options) {
    command.add_option("SCENE", options.scene, "scene file (JSON), or an image that carries its scene")
        ->required();
    command.add_option("-n,--resolution", options.resolution, "N x N facets per quad face of every optic")
        ->check(CLI::Range(1, 1024));
    add_scene_overrides(command, options);
}

void add_scene_overrides(CLI::App& command, SceneOptions& options) {
    command.add_option("--size", options.size, "film size in pixels")->type_name("WxH");
    command.add_option("--spp", options.spp, "S x S samples per pixel")
        ->check(CLI::Range(1, 64))
        ->type_name("S");
    command.add_option("--camera", options.camera, "camera by name; default: the first")->type_name("NAME");
    command.add_option("--max-depth", options.max_depth, "optic hits after the first")
        ->check(CLI::Range(0, 64));
    command.add_option("--set", options.set, "replace a value of the scene")
        ->type_name("/json/pointer=VALUE")
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->expected(1)
        ->take_all();
}

void add_window_options(CLI::App& command, SceneOptions& options) {
    command.add_option("--crop", options.crop, "draw this window of pixels only")->type_name("x0,y0,x1,y1");
    command
        .add_option("--aov", options.aov,
                    "layers beside RGBA: all, or a list of Z,optic,direct,reflect,refract")
        ->type_name("LIST");
}

Scene load_scene_with(const SceneOptions& options, Console& console) {
    const std::vector<SceneOverride> overrides = scene_overrides(options);
    Scene scene;
    if (is_image(options.scene)) {
        scene = load_scene_of_image(options.scene, overrides);
    } else {
        scene = load_scene(options.scene, overrides, image_reader());
    }
    for (const std::string& warning : scene.warnings) console.warn(warning);
    if (options.resolution > 0) set_resolution(scene, options.resolution);
    return scene;
}

std::unique_ptr<World> load_world(const SceneOptions& options, Console& console) {
    return make_world(load_scene_with(options, console), console.warner());
}

std::size_t chosen_camera(const SceneOptions& options, const Scene& scene) {
    if (options.camera.empty()) return scene.own_camera;
    std::vector<std::string> names;
    for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
        if (scene.cameras[c].name == options.camera) return c;
        names.push_back(scene.cameras[c].name);
    }
    throw UsageError("there is no camera \"" + options.camera + "\"" + suggestion(options.camera, names));
}

LayerRequest layer_request(const SceneOptions& options, const Film& film) {
    LayerRequest request{0, 0, film.width, film.height, {}};
    if (!options.crop.empty()) {
        const std::vector<int> window = parse_integers(options.crop, ',', 4, "--crop");
        if (window[0] < 0 || window[1] < 0 || window[2] > film.width || window[3] > film.height ||
            window[0] >= window[2] || window[1] >= window[3])
            throw UsageError("--crop " + options.crop + " is not a window of the " +
                             std::to_string(film.width) + " x " + std::to_string(film.height) + " film");
        request = {window[0], window[1], window[2], window[3], {}};
    }
    if (options.aov == "all") return request;
    std::size_t from = 0;
    while (from <= options.aov.size()) {
        const std::size_t comma = std::min(options.aov.find(',', from), options.aov.size());
        const std::string layer = options.aov.substr(from, comma - from);
        if (std::find(kLayers.begin(), kLayers.end(), layer) == kLayers.end())
            throw UsageError("--aov: there is no layer \"" + layer + "\"" + suggestion(layer, kLayers));
        request.aovs.push_back(layer);
        from = comma + 1;
    }
    return request;
}

}  // namespace trilens
