// Linear views in the standard terms: the view volume, its normalising matrices, homogeneous clipping.
#pragma once

#include <span>
#include <vector>

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

/// Npar: world to the canonical parallel volume -1 <= x, y <= 1, -1 <= z <= 0 (front plane at z = 0). S_par
/// T_par SH_par R T(-vrp) (Foley et al., Computer Graphics, section 6.5.1). Throws InputError as
/// check_view_volume does for a parallel volume, and (places "front", "back") where one of the planes is not
/// finite, as in a default ViewVolume.
Mat4 npar(const ViewVolume& volume);

/// Nper: world to the canonical perspective volume -z >= |x|, |y|, -1 <= z <= z_min (section 6.5.2).
/// S_per SH_per T(-prp) R T(-vrp). Throws as npar, for a perspective volume.
Mat4 nper(const ViewVolume& volume);

/// z of the front plane after nper, in (-1, 0). Throws as nper.
double nper_front(const ViewVolume& volume);

/// From the canonical perspective to the canonical parallel volume, in homogeneous coordinates (section
/// 6.5.4): what makes one clipper serve both. `z_min`: nper_front. Throws InputError unless it is in
/// (-1, 0).
Mat4 parallel_from_perspective(double z_min);

/// The part of a polygon inside the canonical parallel volume -w <= x, y <= w, -w <= z <= 0, corners
/// homogeneous (Blinn and Newell, Clipping using homogeneous coordinates, 1978). Points with w < 0 are
/// clipped correctly, so that no division comes before. Empty where nothing is left.
std::vector<Vec4> clip_homogeneous(std::span<const Vec4> polygon);

}  // namespace trilens
