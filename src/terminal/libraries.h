// The command room's doors to libfmt and to nlohmann's JSON.
#pragma once

#include <fmt/core.h>

#include <nlohmann/json.hpp>

namespace trilens {

// The command room's door to nlohmann's JSON.

/// Keys stay in the order they are set, as people read them.
using Json = nlohmann::ordered_json;

/// A number for JSON: what is not finite becomes the string "nan", "inf" or "-inf".
Json json_number(double value);

}  // namespace trilens

// The command room's door to libfmt.
