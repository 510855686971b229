// First derivatives of a camera's rays over its film, and of how far they pass a point by: for Newton's
// method.
#pragma once

#include <optional>

#include "camera/model/camera_model.h"

namespace trilens {

/// A ray, and what a pixel to the right and one down add to it.
using RaySlopes = LinearRays;

/// By differences over `step` pixels, but where the model's rays are linear. None where one of its rays is
/// missing.
std::optional<RaySlopes> ray_slopes(const CameraModel& model, const Vec2& at, double step);

/// A number on the film, and what a pixel to the right and one down add to it.
struct WeightSlopes {
    double here = 0;
    Vec2 per_pixel{0};
};

/// Adds the product of the weight and the rays.
void add_product(RaySlopes& sum, const WeightSlopes& weight, const RaySlopes& rays);

/// How far a point lies from a ray, as a share of its distance along the ray, and what a pixel to the right
/// and one down add to that.
struct MissSlopes {
    Vec3 here{0}, per_x{0}, per_y{0};
};

MissSlopes miss_slopes(const RaySlopes& rays, const Vec3& point);

}  // namespace trilens
