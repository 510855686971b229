#include "cli/scene_options.h"

#include <trilens/error.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>

namespace trilens {
namespace {

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

SceneRequest scene_request(const SceneOptions& options) {
    return {options.scene, scene_overrides(options), options.resolution};
}

Scene load_scene(const SceneOptions& options, Console& console) {
    Scene scene = load_scene(scene_request(options));
    for (const std::string& warning : scene.warnings) console.warn(warning);
    return scene;
}

Renderer load_renderer(const SceneOptions& options, Console& console) {
    return Renderer(load_scene(options, console), console.warner());
}

LayerRequest layer_request(const SceneOptions& options) {
    LayerRequest request;
    if (!options.crop.empty()) {
        const std::vector<int> window = parse_integers(options.crop, ',', 4, "--crop");
        if (window == std::vector<int>(4, 0))
            throw UsageError("--crop " + options.crop + " is no window of the film");
        request = {window[0], window[1], window[2], window[3], {}};
    }
    if (options.aov == "all") return request;
    std::size_t from = 0;
    while (from <= options.aov.size()) {
        const std::size_t comma = std::min(options.aov.find(',', from), options.aov.size());
        request.layers.push_back(options.aov.substr(from, comma - from));
        from = comma + 1;
    }
    return request;
}

SweepTalk sweep_talk(Console& console) {
    return {[&console](const std::string& job) { return console.progress(job); }, console.warner()};
}

}  // namespace trilens
