// Example scenes that are files of scenes/, too: their texts.
#pragma once

namespace trilens {

extern const char* const kCamerasExample;
extern const char* const kCausticExample;

}  // namespace trilens
