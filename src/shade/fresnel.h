// How much light the interface between two dielectrics reflects.
#pragma once

namespace trilens {

/// The share of unpolarised light that the interface reflects, 0..1 (1 on total internal reflection).
/// cos_incident: cosine of the angle of incidence, 0..1; eta: refractive
/// index where the ray comes from over the index where it goes.
/// Source: the Fresnel equations, Born and Wolf, Principles of Optics, section 1.5.2.
double fresnel_reflectance(double cos_incident, double eta);

/// Whether no light goes through: total internal reflection, which there is only towards the thinner medium.
/// At grazing incidence on a denser one the interface reflects all as well, but light has a way through.
bool is_beyond_critical(double cos_incident, double eta);

}  // namespace trilens
