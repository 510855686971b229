// The linear cameras of a scene with their clipping planes.
#pragma once

#include <limits>

#include "base/description/camera_description.h"
#include "base/raymesh/linear_camera.h"
#include "camera/model/camera_model.h"
#include "camera/model/film_axes.h"

namespace trilens {

/// What lies nearer than `near_depth` along the view axis (from the eye; parallel cameras: from where their
/// rays start) or farther than `far_depth` is not seen.
struct LinearView {
    LinearCamera camera;
    double near_depth = 0, far_depth = std::numeric_limits<double>::infinity();
};

/// A description with is_linear(type). Throws InputError with the field at fault.
LinearView make_linear_view(const CameraDescription& from, const FilmSize& film, const CameraSite& site);

}  // namespace trilens
