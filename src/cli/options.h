// The options of the commands: what to draw, how, and what is swept.
#pragma once

#include <trilens/image.h>
#include <trilens/maps.h>
#include <trilens/project.h>
#include <trilens/render.h>
#include <trilens/scene.h>
#include <trilens/sweep.h>
#include <optional>
#include <string>
#include <vector>

#include "terminal/command.h"

namespace trilens {

// The options that say what to draw: shared by every command that loads a scene.

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
/// The overrides alone: --size, --spp, --filter, --camera, --max-depth, --set; --optic, --time, --animation
/// of glTF.
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

/// The same for answers that know no roughness: see warn_of_roughness.
Renderer load_smooth_renderer(const SceneOptions& options, Console& console);

/// A warning for each optic that is rough: what is asked of the scene is answered as of smooth ones.
void warn_of_roughness(const Scene& scene, Console& console);

/// The window and layers asked for. Throws UsageError for texts that say none.
LayerRequest layer_request(const SceneOptions& options);

/// A sweep that talks on the console.
SweepObserver sweep_talk(Console& console);

// What unwrap, map and anamorph have in common: an optic by name, a centre of directions, a path.

/// --center, --proxy, --optic and --path.
struct DirectionOptions {
    std::string center = "optic", proxy = "scene", optic, path;
};

std::vector<Option> direction_options(DirectionOptions& options);

/// What unwrap and map ask a target by; `to`: the target's text, `tolerance`: pixels. Throws UsageError.
TargetRequest target_request(const Renderer& renderer, const DirectionOptions& options, const std::string& to,
                             double tolerance);

/// The optic's index; none where the name is empty. Throws UsageError with the nearest name.
std::optional<std::size_t> optic_named(const Renderer& renderer, const std::string& name);

/// None for "optic". Throws UsageError where the text is no point.
std::optional<Vec3> center_given(const std::string& text);

/// None where the text is empty.
std::optional<Path> path_given(const std::string& text);

// What `trilens render` and `trilens trace` take.

struct FrameOptions {
    std::string frames;  // "A..B" or "A"; empty: none asked for, or as many as the turntable has
    int turntable = 0;   // frames of one whole turn; 0: the camera stays

    bool asks() const { return !frames.empty() || turntable > 0; }
};

struct RenderOptions {
    SceneOptions scene;
    std::string output;
    std::string pixel;  // "x,y"
    std::string engine = "exact";
    std::string shading = "fragment";
    std::string clip = "scene";
    int slices = 0, tessellate = 0;  // 0: not asked for
    std::string surface = "limit";
    std::string display_server;  // "HOST:PORT"; empty: none
    std::string format;          // empty: by the output's ending
    bool wire = false, folds = false;
    std::string rays;       // empty: each optic's own
    std::string facets;     // empty: those that are worthwhile
    double max_error = -1;  // < 0: as the scene says
    bool certify = false;
    std::string grid;     // empty: as the scene says
    double exposure = 0;  // stops
    std::string tone = "none";
    FrameOptions frames;
    double white = ToneMapping().white;

    bool filter_shown = false;

    ToneMapping tone_mapping() const { return {exposure, tone_curve(tone), white}; }
    /// Of what is drawn, when it is written: none where the filter has averaged what is shown.
    ToneMapping written_tones() const { return filter_shown ? ToneMapping() : tone_mapping(); }
    bool maps_tones() const { return exposure != 0 || tone != "none" || white != ToneMapping().white; }
};

/// The options that both have; `formats`: what an output may be.
std::vector<Option> picture_options(RenderOptions& options, const std::string& formats);
/// --frames and --turntable.
std::vector<Option> frame_options(FrameOptions& options);
/// --rays, --facets and --max-error.
std::vector<Option> facet_options(RenderOptions& options);
/// --engine and the classic engine's own.
std::vector<Option> engine_options(RenderOptions& options);

/// What an output is, by --format or its name's ending: "exr", "png", "svg", "obj" or, of frames, "apng".
/// Standard output gets OpenEXR where nothing else is asked for. Throws UsageError.
std::string output_format(const RenderOptions& options, const std::string& command);

/// Whether a format has lines or surfaces instead of pixels.
inline bool is_vector(const std::string& format) {
    return format == "svg" || format == "obj";
}

/// The engine that the options name. Throws UsageError for the classic engine's options without it.
EngineChoice chosen_engine(const RenderOptions& options);

/// What the frame and its layers are asked to be, but for the camera. Throws UsageError.
PictureRequest picture_request(const RenderOptions& options, const EngineChoice& engine);

/// Throws UsageError where options do not go together with the format or the engine.
void check_options(const RenderOptions& options, const std::string& format, const EngineChoice& engine);

/// Throws UsageError with the option's name for a window or a pixel that the film does not have.
void check_on_film(const RenderOptions& options, const LayerRequest& window, const Film& film);

// What `trilens sweep run`, `plan` and `submit` take, and the sweeps that it asks for.

struct SweepOptions {
    SceneOptions scene;
    std::vector<std::string> scenes;
    std::vector<std::string> over;
    std::string output;
    std::string truth;
    std::string shard = "0/1";
    bool zip = false, replace = false;
    int jobs = 1, repeats = 0;
    double memory = 0;  // MiB
};

/// The options as data; `options` must outlive them.
std::vector<Option> sweep_options(SweepOptions& options);

/// The words of the command that makes a sweep again, without the parts that are defaults; `scene` may be
/// empty.
std::vector<std::string> command_words(const SweepOptions& options, const std::string& scene);

/// One sweep per scene, one for a sweep file, one for scenes that are an axis. Throws UsageError where they
/// are named twice or not at all, or two have one name.
std::vector<SweepRequest> sweep_requests(const SweepOptions& options);

}  // namespace trilens
