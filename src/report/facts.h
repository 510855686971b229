// Names and values as text, as tables of two columns show them.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace trilens {

using Facts = std::vector<std::pair<std::string, std::string>>;

}  // namespace trilens
