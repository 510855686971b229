// Frames of an animation as people write them, and what their files are called.
#pragma once

#include <string>
#include <vector>

namespace trilens {

inline constexpr int kMostFrames = 100'000;

/// The frames of "A..B" or "A", ascending or descending as they are named. Throws UsageError for a text that
/// names none, or more than kMostFrames.
std::vector<int> parse_frames(const std::string& text);

/// The output's name for a frame: its run of # becomes the number, with zeros before it. Throws UsageError
/// where the name has no #, or several runs of them.
std::string frame_file(const std::string& output, int frame);

}  // namespace trilens
