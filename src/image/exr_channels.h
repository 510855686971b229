// In which order the channels of an OpenEXR file are presented.
#pragma once

#include <string>
#include <vector>

namespace trilens {

/// The same names, layer by layer (what stands before the last dot); in a layer R G B, then where it has an
/// X beside a Y or a Z these three, then A Z, then all others by name. Where it has no such X, A and Z come
/// after B and Y. Long and other usual names (Red, Alpha, Depth ...) stand with the short ones.
std::vector<std::string> in_layers(std::vector<std::string> names);

}  // namespace trilens
