// The libraries underneath, by name and version.
#pragma once

#include <string>
#include <vector>

namespace trilens {

/// Ray tracing, surfaces, images: "Embree 4.3.3", ...
std::vector<std::string> versions_underneath();

}  // namespace trilens
