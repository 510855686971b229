// Triangles as they are, with interpolated normals.
#pragma once

#include <memory>
#include <string>

#include "base/description/optic_description.h"
#include "base/raymesh/surface.h"

namespace trilens {

/// The triangles of a cage whose scheme is kUnsubdivided, one face each, of the triangular domain. Normals
/// are the cage's, interpolated and made unit; a corner without one has its triangle's own. Normals are
/// turned to the front, where the corners run counter-clockwise. Throws InputError(name) for faces that are
/// no triangles, indices out of range, points that are not finite, and no faces.
std::unique_ptr<Surface> make_polygon_surface(const Cage& cage, const std::string& name);

}  // namespace trilens
