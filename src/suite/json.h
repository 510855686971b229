// The suite room's door to nlohmann's JSON.
#pragma once

#include <nlohmann/json.hpp>

namespace trilens {

/// Keys stay in the order they are written.
using Json = nlohmann::ordered_json;

}  // namespace trilens
