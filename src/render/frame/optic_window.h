// Conservative screen bounds of an optic.
#pragma once

#include "render/frame/frame.h"

namespace trilens {

/// The pixels of the film that the optic's facets may cover. All of them where its corners do not say: the
/// camera is not linear, or some lie behind it.
SampleGrid optic_window(const FramedOptic& optic, const CameraRays& camera);

/// The part of a grid in a window's pixels, with the grid's own samples; of size 0 where they share none.
SampleGrid part_in(const SampleGrid& grid, const SampleGrid& window);

}  // namespace trilens
