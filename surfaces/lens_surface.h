// Lenses as closed surfaces: two sides about an axis and a straight edge from rim to rim.
#pragma once

#include <memory>

#include "base/description/optic_description.h"
#include "base/raymesh/surface.h"

namespace trilens {

/// The skin of a checked lens whose frame has its z along the axis and its origin at `center`. Faces: the
/// front side's 5 (a square and four sides mapped onto its disk; with a hole 4 quarters of a ring), the
/// back's as many, 4 quarters of the edge (u around, v from the front's rim to the back's), and with a hole
/// as many of its wall. Front is outside. In closed form where both sides are conicoids. Rims are creases.
std::unique_ptr<Surface> make_lens_surface(const LensPrimitive& lens, const Vec3& center,
                                           const Mat3& world_from_local);

}  // namespace trilens
