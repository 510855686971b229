// Faces of revolution that OpenCASCADE reads without their pole.
#pragma once

#include <optional>

class TopoDS_Face;

namespace trilens {

/// A face that closes on its axis of revolution where no range of its surface's parameters ends, as the last
/// of a turned lens often does, is read as its rim alone, without area. This is the whole face, with the
/// surface and orientation of `face`, up to the first place after the rim where the meridian meets the axis;
/// none where `face` is no such face.
std::optional<TopoDS_Face> with_pole(const TopoDS_Face& face);

}  // namespace trilens
