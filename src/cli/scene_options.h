// The options that say what to draw: shared by every command that loads a scene.
#pragma once

#include <trilens/render.h>
#include <trilens/scene.h>
#include <trilens/sweep.h>
#include <string>
#include <vector>

#include "terminal/command.h"
#include "terminal/option.h"

namespace trilens {

inline constexpr const char* kStandardInput = "standard input";

/// All that is there. Throws InputError where that is nothing, and says what is `expected`: "a scene is".
std::string standard_input(const std::string& expected);

struct SceneOptions {
    std::string scene;                    // a scene file, a glTF, an image that carries its scene, or "-"
    std::string camera;                   // empty: the image's own, or the first
    std::vector<std::string> resolution;  // "16" for every optic, "ball=16" for one; else as the scene says
    std::string size;                     // "640x480"; empty: as the scene says
    int spp = 0;                          // 0: as the scene says
    std::string filter;                   // empty: as the scene says
    int max_depth = -1;                   // < 0: as the scene says
    std::vector<std::string> set;         // "/json/pointer=VALUE"
    std::vector<std::string> optics;      // of a glTF: "Mirror*"
    std::string time;                     // of a glTF: seconds; empty: its animation's start
    std::string animation;                // of a glTF: its name; empty: the first
    std::string crop;                     // "x0,y0,x1,y1"
    std::string aov;                      // empty: the usual ones
};

/// The scene argument and its resolution.
std::vector<Option> scene_argument(SceneOptions& options);
/// The overrides alone: --size, --spp, --filter, --camera, --max-depth, --set; --optic, --time, --animation of
/// glTF.
std::vector<Option> scene_overrides(SceneOptions& options);
/// The same for commands whose own --optic names one of the scene's optics.
std::vector<Option> scene_overrides_but_optic(SceneOptions& options);
/// --crop and --aov.
std::vector<Option> window_options(SceneOptions& options);

/// The options as the library takes them. Throws UsageError for texts that say nothing.
SceneRequest scene_request(const SceneOptions& options);

/// The scene, with its warnings told; of "-" the text on standard input, whose relative paths start where the
/// program runs. What it read becomes an input of the console's files.
Scene load_scene(const SceneOptions& options, Console& console);

/// The scene made ready for drawing.
Renderer load_renderer(const SceneOptions& options, Console& console);

/// The window and layers asked for. Throws UsageError for texts that say none.
LayerRequest layer_request(const SceneOptions& options);

/// A sweep that talks on the console.
SweepObserver sweep_talk(Console& console);

}  // namespace trilens
