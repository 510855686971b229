// The command room's door to nlohmann's JSON.
#pragma once

#include <nlohmann/json.hpp>

namespace trilens {

/// Keys stay in the order they are set, as people read them.
using Json = nlohmann::ordered_json;

/// A number for JSON: what is not finite becomes the string "nan", "inf" or "-inf".
Json json_number(double value);

}  // namespace trilens
