// What `trilens render` and `trilens trace` take.
#pragma once

#include <trilens/image.h>
#include <trilens/render.h>
#include <optional>
#include <string>
#include <vector>

#include "cli/scene_options.h"
#include "terminal/option.h"

namespace trilens {

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
    std::string grid;       // empty: as the scene says
    double exposure = 0;    // stops
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

}  // namespace trilens
