// Keyframes: values between keys by interpolation and easing.
#pragma once

#include <string>

#include "json/json.h"

namespace trilens {

/// Throws InputError, with the place, for tracks whose keys do not rise, whose values cannot be interpolated,
/// or whose target names nothing. The document fits the schema.
void check_animation(const Node& root);

/// Puts every track's value at that frame into the scene, and takes the animation away.
void apply_animation(Json& scene, double frame, const std::string& file);

}  // namespace trilens
