// How the image of a point moves with the point and with a scene's parameters: the implicit function theorem
// on Fermat's stationary path.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "inverse/fit/shot_path.h"

namespace trilens {

/// A scene with one parameter moved back and forth by `step` of its unit; surfaces keep their parameters.
struct ParameterDifference {
    FitScene minus, plus;
    double step = 1;
    bool moves_camera = false;  // some camera
};

/// Of the image of a point on a path's last ray.
struct PathDerivatives {
    std::array<Vec3, 2> by_point{};                   // of x and of y, pixels per scene unit
    std::vector<std::array<double, 2>> by_parameter;  // pixels per unit of each parameter
};

/// A place on the film and the camera that it is of.
struct ShownPlace {
    std::size_t camera = 0;
    Vec2 pixel{0};
};

/// Of the image at `place`, whose path to `point` goes over the events. None at a caustic, where the image
/// moves infinitely fast, and where the camera does not show the first event.
///
/// Events P_i(u_i) between the eye P_0 and the point; n_i the index between P_i and P_i+1, e_i the unit
/// direction, H_i = n_i / l_i (1 - e_i e_i^T). The path is stationary: F_i = (dP_i/du)^T (n_i-1 e_i-1 -
/// n_i e_i) = 0, with symmetric block tridiagonal Hessian A = dF/du; so du/dtheta = -A^-1 dF/dtheta, at fixed
/// u. Only the first event's u moves the image, so two solutions with A serve any number of parameters.
std::optional<PathDerivatives> path_derivatives(const FitScene& scene, const ShownPlace& place,
                                                std::span<const OpticEvent> events, const Vec3& point,
                                                std::span<const ParameterDifference> parameters);

/// Where the camera shows a world point, nearest to `near`; none where it does not.
std::optional<Vec2> pixel_of_point(const Camera& camera, const Vec3& point, const Vec2& near);

}  // namespace trilens
