// Example scenes of cameras: their texts.
#pragma once

namespace trilens {

extern const char* const kCamerasExample;
extern const char* const kCausticExample;

}  // namespace trilens
