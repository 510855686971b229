// The files that a scene names, with what was in them: how an image knows later that one has changed.
#pragma once

#include <string>
#include <vector>

#include "scene/data/scene.h"

namespace trilens {

/// One line per file, "hash path", the path from the scene's folder; the scene file itself is left out.
std::string named_files_text(const Scene& scene);

/// The files that the scene names now whose hash was another one in `text`, which named_files_text wrote.
std::vector<std::string> changed_files(const Scene& scene, const std::string& text);

}  // namespace trilens
