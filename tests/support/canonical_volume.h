// The normalising matrices of Foley et al. and homogeneous clipping: a second way to say what a view volume
// shows.
#pragma once

#include <span>
#include <vector>

#include "base/description/camera_description.h"

namespace trilens_test {

using trilens::Mat4;
using trilens::Vec4;
using trilens::ViewVolume;

/// Npar: world to the canonical parallel volume -1 <= x, y <= 1, -1 <= z <= 0 (front plane at z = 0). S_par
/// T_par SH_par R T(-vrp) (Foley et al., Computer Graphics, section 6.5.1). Both planes must be finite.
Mat4 npar(const ViewVolume& volume);

/// Nper: world to the canonical perspective volume -z >= |x|, |y|, -1 <= z <= z_min (section 6.5.2).
/// S_per SH_per T(-prp) R T(-vrp).
Mat4 nper(const ViewVolume& volume);

/// z of the front plane after nper, in (-1, 0).
double nper_front(const ViewVolume& volume);

/// From the canonical perspective to the canonical parallel volume, in homogeneous coordinates (section
/// 6.5.4): what makes one clipper serve both. `z_min`: nper_front.
Mat4 parallel_from_perspective(double z_min);

/// The part of a polygon inside the canonical parallel volume -w <= x, y <= w, -w <= z <= 0, corners
/// homogeneous (Blinn and Newell, Clipping using homogeneous coordinates, 1978). Points with w < 0 are
/// clipped correctly, so that no division comes before. Empty where nothing is left.
std::vector<Vec4> clip_homogeneous(std::span<const Vec4> polygon);

}  // namespace trilens_test
