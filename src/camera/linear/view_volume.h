// Linear views in the standard terms of Foley et al.: a view volume as a camera.
#pragma once

#include <limits>

#include "base/description/camera_description.h"
#include "base/raymesh/linear_camera.h"
#include "camera/model/camera_model.h"
#include "camera/model/film_axes.h"

namespace trilens {

/// Throws InputError where the volume is none: a zero vpn, vup along it, a window without area, a prp in the
/// view plane, planes out of order, or for perspective a front plane at or behind the prp.
void check_view_volume(const ViewVolume& volume, const CameraSite& site = {});

/// The volume as a camera whose window fills the film (its pixels need not be square).
/// Perspective: the eye is the prp. Parallel: rays start at the depth of the prp.
LinearCamera make_view_volume(const ViewVolume& volume, const FilmSize& film, const CameraSite& site = {});

/// Depths of the clipping planes along the view axis from the prp, as t along the film's rays; near is 0 and
/// far infinite where the volume has none. A parallel front plane may lie before the prp's depth: negative.
struct DepthRange {
    double near_depth = 0, far_depth = std::numeric_limits<double>::infinity();
};
DepthRange depth_range(const ViewVolume& volume);

}  // namespace trilens
