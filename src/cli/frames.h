// The frames of an animation or a turntable: which they are, and what their files are called.
#pragma once

#include <string>
#include <vector>

#include "terminal/option.h"

namespace trilens {

struct FrameOptions {
    std::string frames;  // "A..B" or "A"; empty: none asked for, or as many as the turntable has
    int turntable = 0;   // frames of one whole turn; 0: the camera stays

    bool asks() const { return !frames.empty() || turntable > 0; }
};

std::vector<Option> frame_options(FrameOptions& options);

/// The frames asked for, ascending or descending as they are named. Throws UsageError for a text that names
/// none, or more than 100,000.
std::vector<int> frame_numbers(const FrameOptions& options);

/// The output's name for a frame: its run of # becomes the number, with zeros before it. Throws UsageError
/// where the name has no #, or several runs of them.
std::string frame_file(const std::string& output, int frame);

}  // namespace trilens
