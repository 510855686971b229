// The numbers of a scene by their JSON pointers, and the range that the scene's JSON Schema gives each.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "terminal/libraries.h"

namespace trilens {

/// What a slider needs to know of a number.
struct NumberRange {
    bool known = false;                                       // the schema has a number there
    bool whole = false;                                       // integers alone
    double least = -std::numeric_limits<double>::infinity();  // what a scene may have; infinite: anything
    double most = std::numeric_limits<double>::infinity();
    std::string help;  // the schema's description, or its title; may be empty
};

/// What the schema says of the number at a pointer of this scene: the first branch of its oneOf and anyOf
/// that the scene's own keys fit.
NumberRange number_range(const Json& scene, const std::string& pointer);

/// Both ends of a slider for it: what the schema allows where that is narrow, else a span about the value
/// that grows with it. `least` < `most`, both finite and allowed.
struct SliderSpan {
    double least = 0, most = 1;
};
SliderSpan slider_span(const NumberRange& range, double value);

/// Pointers to all numbers of a scene, in its order. Arrays of more than `most_items` items are left out.
std::vector<std::string> scene_numbers(const Json& scene, std::size_t most_items = 64);

}  // namespace trilens
