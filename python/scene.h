// What several subjects need of scenes.
#pragma once

#include <vector>

#include "bindings.h"

namespace trilens::python {

/// {"/json/pointer": value} as the library takes it; texts stay texts.
std::vector<SceneOverride> overrides_of(const py::dict& overrides);

}  // namespace trilens::python
