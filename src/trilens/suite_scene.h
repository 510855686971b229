// Draws the scene of a regression test through the public library.
#pragma once

#include "suite/suite.h"

namespace trilens {

/// Loads the scene of a test with what the test sets in it. Pictures tell `warn` what they leave out, and are
/// given up once `progress` says so. Throws what load_scene and Renderer throw, and InputError for a camera
/// that the scene lacks; the drawing throws what Renderer::draw throws, and InputError for an engine that
/// does not exist.
SuiteScene open_suite_scene(const RenderTest& test, const Progress& progress, const Warn& warn);

}  // namespace trilens
