// The scene format as a JSON Schema.
#pragma once

namespace trilens {

/// The JSON Schema (draft 7) of a scene file, as text.
const char* scene_schema();

}  // namespace trilens
