// Snell's law for one ray at one interface between dielectrics.
#pragma once

#include <optional>

#include "base/math/vec.h"

namespace trilens {

/// The direction of the refracted ray, or none on total internal reflection. `incoming` points TO the
/// surface, any length, which the result keeps. `unit_normal` points to the side that the ray comes from
/// (incoming . normal <= 0); where rounding or interpolation turned it beyond grazing, the incidence counts
/// as grazing. eta: refractive index where the ray comes from over the index where it goes.
std::optional<Vec3> refracted(const Vec3& incoming, const Vec3& unit_normal, double eta);

}  // namespace trilens
