// Whether paths that end at the first optic may be interpolated over whole facets, without any exact ray.
#pragma once

#include <cstddef>

#include "render/frame.h"

namespace trilens {

/// True where every facet of this optic has one history by its place alone: rays of the camera start in air and
/// outside of the optic, and meet a mirror, or glass from its front, where no refraction is total; and its
/// normals turn no faster than its surface. False says that exact paths are to be looked at.
bool ends_at_first(const World& world, const Frame& frame, std::size_t optic);

}  // namespace trilens
