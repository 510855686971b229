// How neighbouring rays spread: where along a ray they touch their caustic, and what kind of camera they
// make.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "base/raymesh/ray.h"
#include "camera/model/camera_model.h"

namespace trilens {

/// The volume that the rays around one span, along it: det(dX/dx, dX/dy, dX/dt) of X = origin + t *
/// direction, a quadratic in t. Where it is 0 neighbouring rays meet: the ray touches the caustic there, and
/// the image of points there folds. Yu and McMillan, General Linear Cameras (2004), call it the
/// characteristic equation.
struct RaySpread {
    double constant = 0, linear = 0, quadratic = 0;

    double at(double t) const { return constant + t * (linear + t * quadratic); }
    /// The real roots, ascending; a double root once. None where the spread does not depend on t.
    std::vector<double> roots() const;
};

/// A ray and how it changes with two parameters.
struct RayChange {
    Ray ray, along_x, along_y;
};
RaySpread ray_spread(const RayChange& change);

/// Of the camera's exact rays around a place of the film, by differences of `step` pixels to either side; in
/// x and y pixels. None where some of the rays do not exist.
std::optional<RaySpread> film_spread(const CameraModel& model, const Vec2& at, double step);

}  // namespace trilens
