// The frames of an animation or a turntable, drawn one after the other.
#pragma once

#include <string>

#include "cli/render_options.h"
#include "terminal/command.h"

namespace trilens {

/// Writes each frame into a file of its own, or all into one animated picture (format "apng"). Throws
/// UsageError, and as load_scene, Renderer::draw and write_output do.
Answer draw_frames(const RenderOptions& options, const std::string& format, const PictureRequest& request,
                   Console& console);

}  // namespace trilens
