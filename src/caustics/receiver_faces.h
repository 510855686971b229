// Flat parts of the receivers: triangles that lie next to each other in one plane.
#pragma once

#include <compare>
#include <vector>

#include "base/raymesh/triangle_scene.h"

namespace trilens {

/// A plane and a ball around what light is asked for on it.
struct ReceiverFace {
    Vec3 point{0}, normal{0};  // unit; both of its sides receive
    Vec3 center{0};            // in the plane
    double radius = 0;
    // A rectangle in the plane around the center that holds it.
    Vec3 along{0};  // unit: its first triangle's side of middle length
    Vec2 half{0};   // of its sides, along and across
    double area = 0;
};

/// One side of one of them.
struct ReceiverSide {
    Id face = kNone;       // kNone: none of them
    bool is_back = false;  // where the face's normal does not point to

    auto operator<=>(const ReceiverSide&) const = default;
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
    /// Whether a place in the face's plane lies on the face; false also where it is no rectangle.
    bool holds(Id face, const Vec3& place) const;
    /// On the side to which `outward` points.
    ReceiverSide side_of(Id triangle, const Vec3& outward) const {
        const Id face = face_of(triangle);
        return {face, face != kNone && dot(faces_[face].normal, outward) < 0};
    }

  private:
    std::vector<ReceiverFace> faces_;
    std::vector<Id> face_of_;  // by triangle
};

}  // namespace trilens
