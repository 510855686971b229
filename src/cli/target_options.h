// What unwrap, map and anamorph have in common: an optic by name, a centre of directions, a path.
#pragma once

#include <trilens/project.h>
#include <trilens/render.h>
#include <optional>
#include <string>

#include "terminal/option.h"

namespace trilens {

/// --center, --proxy, --optic and --path.
struct DirectionOptions {
    std::string center = "optic", proxy = "scene", optic, path;
};

std::vector<Option> direction_options(DirectionOptions& options);

/// The optic's index; none where the name is empty. Throws UsageError with the nearest name.
std::optional<std::size_t> optic_named(const Renderer& renderer, const std::string& name);

/// None for "optic". Throws UsageError where the text is no point.
std::optional<Vec3> center_given(const std::string& text);

/// None where the text is empty.
std::optional<Path> path_given(const std::string& text);

}  // namespace trilens
