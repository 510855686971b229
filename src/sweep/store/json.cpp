// The sweep room's door to nlohmann's JSON: results as text and back.
#include "sweep/store/json.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "report/text.h"

namespace trilens {

Json json_of_number(std::optional<double> value) {
    if (!value) return nullptr;
    if (std::isfinite(*value)) return *value;
    return shortest_text(*value);
}

std::optional<double> number_of_json(const Json& json) {
    if (json.is_null()) return std::nullopt;
    if (!json.is_string()) return json.get<double>();
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    for (const double value : {std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity})
        if (json == shortest_text(value)) return value;
    throw std::invalid_argument("\"" + json.get<std::string>() + "\" is no number");
}

std::string json_document(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string json_line(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace trilens
