// The sweep room's door to nlohmann's JSON: results as text and back.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace trilens {

/// Keys stay in the order they are set, as people read them.
using Json = nlohmann::ordered_json;

/// A number for JSON: what is not finite becomes the string "nan", "inf" or "-inf"; none becomes null.
Json json_of_number(std::optional<double> value);

/// The inverse. Throws nlohmann's exceptions where `json` is something else.
std::optional<double> number_of_json(const Json& json);

/// Indented text with a line end; bytes that are no UTF-8 become U+FFFD.
std::string json_document(const Json& json);
/// The same on one line.
std::string json_line(const Json& json);

}  // namespace trilens
