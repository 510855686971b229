// Parts of the scene's JSON Schema that fill files of their own.
#pragma once

namespace trilens {

/// The definitions of cameras and of what they are made of, each followed by a comma.
const char* camera_schema();

}  // namespace trilens
