// Vectors, numbers of things, and names of enumerators: what all other headers speak of.
//
//     const trilens::Vec3 up(0, 1, 0);
//     trilens::Id facet = trilens::kNone;
#pragma once

#include "base/math/vec.h"
#include "base/util/ids.h"
#include "base/util/names.h"
