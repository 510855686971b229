// Random optics, objects and volumes of a scene.
#pragma once

#include "fuzz/grammar.h"

namespace trilens_fuzz {

/// A mesh of the scene file, `number` counting those of its role. Materials: chrome, glass, thick, flint.
std::string random_optic(Grammar& g, int number);

/// Materials: a, b, c, by the number.
std::string random_object(Grammar& g, int number);

/// A grid of 2 x 3 x 2 samples.
std::string random_volume(Grammar& g);

}  // namespace trilens_fuzz
