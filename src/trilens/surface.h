// Curved surfaces: limit surfaces of cages, exact primitives, and N x N grids on them; and lenses by their
// prescriptions: first order, Seidel's sums, exact rays and spots.
//
//     #include <trilens/scene.h>
//     trilens::Cage cage;
//     cage.points = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
//     cage.face_vertex_counts = {4};
//     cage.face_vertex_indices = {0, 1, 2, 3};
//     const auto surface = trilens::make_surface(cage);
//     const trilens::SurfacePoint middle = surface->eval(0, {0.5, 0.5});
//     const trilens::SurfaceGrid grid = trilens::make_surface_grid(*surface, 8);
//
//     const trilens::LensPrescription lens = trilens::load_lens("triplet.zmx");
//     const double focal_length = trilens::first_order(lens).focal_length;
#pragma once

#include <memory>
#include <string>

#include "base/description/optic_description.h"
#include "base/raymesh/surface.h"
#include "base/util/error.h"
#include "lens/first_order.h"
#include "lens/prescription.h"
#include "lens/sequential_rays.h"

namespace trilens {

/// The limit surface of a cage, in the cage's frame: one face per quad, one per corner of other polygons
/// (Loop: one per triangle). `name` stands in messages; `warn` is told of what is repaired or left out.
/// Throws InputError where the cage has none.
std::unique_ptr<Surface> make_surface(const Cage& cage, const std::string& name = "cage",
                                      const Warn& warn = {});

/// The exact surface of a primitive. Throws InputError for sizes that are not positive.
std::unique_ptr<Surface> make_surface(const Primitive& primitive);

/// n x n squares of two facets on each face of four sides, n^2 facets on each triangular one; points on
/// shared edges exist once. Throws InputError unless n is in 1..1024.
SurfaceGrid make_surface_grid(const Surface& surface, int n);

}  // namespace trilens
