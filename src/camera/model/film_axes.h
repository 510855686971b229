// The axes of a film in the world, and how cameras refuse what leaves them none.
#pragma once

#include <string>

#include "base/math/vec.h"

namespace trilens {

/// Where a camera stands, world frame. `up` need not be unit nor at right angles to the view axis.
struct Placement {
    Vec3 eye{0, 0, 1}, at{0}, up{0, 1, 0};
};

/// The film's axes in the world: unit, at right angles; `up` here is exact, pointing to the film's top.
struct FilmAxes {
    Vec3 right{0}, up{0}, forward{0};

    Vec3 to_world(const Vec3& v) const { return v.x * right + v.y * up + v.z * forward; }
    Vec3 from_world(const Vec3& v) const { return {dot(v, right), dot(v, up), dot(v, forward)}; }
};

/// Where a camera's description stands, for messages; both may be empty.
struct CameraSite {
    std::string file, place;

    /// Throws InputError with the place of `field` inside the camera.
    [[noreturn]] void reject(const std::string& field, const std::string& message) const;
};

/// Throws InputError (field "lookAt") where eye and at coincide, up is parallel to the view axis, or anything
/// is not finite.
FilmAxes make_film_axes(const Placement& look_at, const CameraSite& site = {});

/// Throws InputError (field "film") for a film without pixels or without end.
void require_film(double width, double height, const CameraSite& site = {});

bool is_finite_vector(const Vec3& v);

}  // namespace trilens
