// Which of the general linear cameras three rays make, by the names of Yu and McMillan.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "base/raymesh/ray.h"
#include "camera/model/ray_spread.h"

namespace trilens {

/// Yu and McMillan, General Linear Cameras (ECCV 2004), table 1: all affine combinations of three rays
/// between two parallel planes are one of these, told apart by the real roots of the characteristic equation
/// A t^2 + B t + C = 0 (depths at which the three rays' points lie on one line) and by whether the triangles
/// that the rays make on both planes have parallel edges.
enum class GeneralLinearKind {
    kPinhole,              // A != 0, one root, edges parallel: all rays through a point
    kOrthographic,         // A = B = 0, edges parallel: all rays parallel
    kPushbroom,            // A = 0, one root: all rays through a line and parallel to a plane
    kCrossedSlits,         // A != 0, two roots: all rays through two lines (XSlit)
    kPencil,               // A != 0, one root: through a line, each point of which has a plane of rays
    kTwistedOrthographic,  // A = B = 0, edges not parallel: parallel to a plane, turning
    kBilinear,             // A != 0, no root: no two rays meet
    kPlane                 // A = B = C = 0: all rays in one plane (an epipolar plane image)
};

inline constexpr std::size_t kGeneralLinearKindCount = 8;

/// "pinhole", "orthographic", "pushbroom", "crossedSlits", "pencil", "twistedOrthographic", "bilinear",
/// "plane".
const char* general_linear_kind_name(GeneralLinearKind kind);

struct GeneralLinearCamera {
    GeneralLinearKind kind = GeneralLinearKind::kPinhole;
    /// World points on the middle ray (through the mean of the three, first plane to second) at the roots:
    /// where it meets the slits, the line or the point.
    std::vector<Vec3> meets;
};

/// The camera of three rays, whose directions may have any length, between two planes across `axis` (of any
/// length; the same rays between other planes make another camera). Sizes below `tolerance` of the rays' own
/// count as zero. None where a ray does not go the way of the axis, or two of them are one.
std::optional<GeneralLinearCamera> general_linear_camera(const std::array<Ray, 3>& rays, const Vec3& axis,
                                                         double tolerance = 1e-9);

}  // namespace trilens
