// Keyframes: values between keys by interpolation and easing, and the frames that --frames names.
#pragma once

#include <string>
#include <vector>

#include "scene/json/json.h"

namespace trilens {

/// Throws InputError, with the place, for tracks whose keys do not rise, whose values cannot be interpolated,
/// or whose target names nothing. The document fits the schema.
void check_animation(const Node& root);

/// Puts every track's value at that frame into the scene, and takes the animation away.
void apply_animation(Json& scene, double frame, const std::string& file);

inline constexpr int kMostFrames = 100'000;

/// The frames of "A..B" or "A", ascending or descending as they are named. Throws UsageError for a text that
/// names none, or more than kMostFrames.
std::vector<int> parse_frames(const std::string& text);

/// The output's name for a frame: its run of # becomes the number, with zeros before it. Throws UsageError
/// where the name has no #, or several runs of them.
std::string frame_file(const std::string& output, int frame);

}  // namespace trilens
