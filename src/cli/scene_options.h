// The options that say what to draw: shared by every command that loads a scene.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/layers.h"
#include "cli/world.h"

namespace CLI {
class App;
}

namespace trilens {

struct SceneOptions {
    std::string scene;             // a scene file, or an image that carries its scene
    std::string camera;            // empty: the image's own, or the first
    int resolution = 0;            // 0: as the scene says
    std::string size;              // "640x480"; empty: as the scene says
    int spp = 0;                   // 0: as the scene says
    int max_depth = -1;            // < 0: as the scene says
    std::vector<std::string> set;  // "/json/pointer=VALUE"
    std::string crop;              // "x0,y0,x1,y1"
    std::string aov = "all";
};

/// Adds the scene argument, its resolution, and what overrides it.
void add_scene_options(CLI::App& command, SceneOptions& options);
/// Adds the overrides alone: --size, --spp, --camera, --max-depth, --set.
void add_scene_overrides(CLI::App& command, SceneOptions& options);
/// Adds --crop and --aov.
void add_window_options(CLI::App& command, SceneOptions& options);

/// Loads the scene with the overrides and builds its world. Warnings go to the console.
std::unique_ptr<World> load_world(const SceneOptions& options, Console& console);

/// The same from an already loaded scene.
Scene load_scene_with(const SceneOptions& options, Console& console);

/// The camera named by the options, or the first. Throws UsageError with the nearest name.
std::size_t chosen_camera(const SceneOptions& options, const Scene& scene);

/// The window and layers asked for. Throws UsageError where they do not fit the film.
LayerRequest layer_request(const SceneOptions& options, const Film& film);

/// Integers separated by `separator`. Throws UsageError naming `option` unless there are exactly `count`.
std::vector<int> parse_integers(const std::string& text, char separator, std::size_t count,
                                const std::string& option);

}  // namespace trilens
