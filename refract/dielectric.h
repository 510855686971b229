// Snell's law and Fresnel's equations for one ray at the interface between two dielectrics.
#pragma once

#include <optional>

#include "base/math/vec.h"

namespace trilens {

/// The direction of the refracted ray, or none on total internal reflection. `incoming` points TO the
/// surface, any length, which the result keeps. `unit_normal` points to the side that the ray comes from
/// (incoming . normal <= 0); where rounding or interpolation turned it beyond grazing, the incidence counts
/// as grazing. eta: refractive index where the ray comes from over the index where it goes.
std::optional<Vec3> refracted(const Vec3& incoming, const Vec3& unit_normal, double eta);

/// The share of unpolarised light that the interface reflects, 0..1 (1 on total internal reflection).
/// cos_incident: cosine of the angle of incidence, 0..1; eta: refractive
/// index where the ray comes from over the index where it goes.
/// Source: the Fresnel equations, Born and Wolf, Principles of Optics, section 1.5.2.
double fresnel_reflectance(double cos_incident, double eta);

/// Whether no light goes through: total internal reflection, which there is only towards the thinner medium.
/// At grazing incidence on a denser one the interface reflects all as well, but light has a way through.
bool is_beyond_critical(double cos_incident, double eta);

}  // namespace trilens
