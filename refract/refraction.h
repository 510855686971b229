// Snell's law and Fresnel's equations, and a surface grid's corner rays refracted.
#pragma once

#include <optional>
#include <span>

#include "base/math/vec.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/surface.h"

namespace trilens {

// What a camera sees through one interface: the surface grid's corners with refracted rays, as a RayMesh
// (thesis, chapter 7).

/// The RayMesh of `grid` seen by `camera` through the surface alone: one refraction, after which the rays go
/// on in the other medium. `ior`: index of the medium behind the surface's front over that before it
/// (glass: 1.5), > 0.
///
/// Facet f of the mesh is facet f of the grid. Its side is decided by its flat triangle: turned to the camera
/// by its front, rays go in (eta = 1 / ior); by its back, they come out (eta = ior). A corner may be needed
/// on both sides, so corner k of the mesh is the grid's corner k for facets seen from the front, and corners
/// for facets seen from the back follow after them, one per grid corner in use. Directions keep the incident
/// length, as in make_reflection.
///
/// A corner whose normal is turned beyond grazing (near the silhouette) counts as grazing. A facet gets no
/// rays where one of its corners has no normal, lies in the eye, or reflects totally.
RayMesh make_refraction(const SurfaceGrid& grid, const LinearCamera& camera, double ior);

/// The same for any camera, which sees each corner of the grid as `views` say.
RayMesh make_refraction(const SurfaceGrid& grid, std::span<const CornerView> views, double ior);

// Snell's law and Fresnel's equations for one ray at the interface between two dielectrics.

/// The direction of the refracted ray, or none on total internal reflection. `incoming` points TO the
/// surface, any length, which the result keeps. `unit_normal` points to the side that the ray comes from
/// (incoming . normal <= 0); where rounding or interpolation turned it beyond grazing, the incidence counts
/// as grazing. eta: refractive index where the ray comes from over the index where it goes.
std::optional<Vec3> refracted(const Vec3& incoming, const Vec3& unit_normal, double eta);

/// The share of unpolarised light that the interface reflects, 0..1 (1 on total internal reflection;
/// exactly 0 where both sides are one). cos_incident: cosine of the angle of incidence, 0..1; eta: refractive
/// index where the ray comes from over the index where it goes.
/// Source: the Fresnel equations, Born and Wolf, Principles of Optics, section 1.5.2.
double fresnel_reflectance(double cos_incident, double eta);

/// Whether no light goes through: total internal reflection, which there is only towards the thinner medium.
/// At grazing incidence on a denser one the interface reflects all as well, but light has a way through.
bool is_beyond_critical(double cos_incident, double eta);

}  // namespace trilens
