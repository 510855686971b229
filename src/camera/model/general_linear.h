// General linear cameras (Yu and McMillan 2004): which of them three rays make, and where rays touch their
// caustic.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "camera/model/camera_model.h"

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

/// The volume that the rays around one span, along it: det(dX/dx, dX/dy, dX/dt) of X = origin + t *
/// direction, a quadratic in t. Where it is 0 neighbouring rays meet: the ray touches the caustic there, and
/// the image of points there folds. Yu and McMillan, General Linear Cameras (2004), call it the
/// characteristic equation.
struct RaySpread {
    double constant = 0, linear = 0, quadratic = 0;

    double at(double t) const { return constant + t * (linear + t * quadratic); }
    /// The real roots, ascending; a double root once. None where the spread does not depend on t.
    std::vector<double> roots() const;
};

/// A ray and how it changes with two parameters.
struct RayChange {
    Ray ray, along_x, along_y;
};
RaySpread ray_spread(const RayChange& change);

/// Of the camera's exact rays around a place of the film, by differences of `step` pixels to either side; in
/// x and y pixels. None where some of the rays do not exist.
std::optional<RaySpread> film_spread(const CameraModel& model, const Vec2& at, double step);

}  // namespace trilens
