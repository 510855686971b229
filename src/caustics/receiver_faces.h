// Flat parts of the receivers: triangles that lie next to each other in one plane.
#pragma once

#include <vector>

#include "base/raymesh/triangle_scene.h"

namespace trilens {

/// A plane and a ball around what light is asked for on it.
struct ReceiverFace {
    Vec3 point{0}, normal{0};  // unit; both of its sides receive
    Vec3 center{0};
    double radius = 0;
};

/// The faces of a scene's triangles. Triangles that follow each other are of one face where all their corners
/// lie in its plane, to rounding.
class ReceiverFaces {
  public:
    ReceiverFaces() = default;
    explicit ReceiverFaces(const TriangleScene& scene);

    const std::vector<ReceiverFace>& faces() const { return faces_; }
    /// kNone: the triangle has no area, or is none of the scene's.
    Id face_of(Id triangle) const { return triangle < face_of_.size() ? face_of_[triangle] : kNone; }

  private:
    std::vector<ReceiverFace> faces_;
    std::vector<Id> face_of_;  // by triangle
};

}  // namespace trilens
