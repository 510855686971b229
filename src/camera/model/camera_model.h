// The camera interface: exact ray of a film position, and projection of a world point; the axes of a film in
// the world.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/raymesh/ray_mesh.h"

namespace trilens {

/// One image of a world point on a film.
struct FilmImage {
    Vec2 pixel{0};   // from the film's top left; may lie off the film
    double t = 0;    // point = origin + t * direction of the exact ray there; negative: behind it
    Vec3 origin{0};  // of that ray
};

/// Rays whose origin and direction are linear functions of the film's place, as those of a pinhole and of
/// parallel rays are: the ray at the film's top left, and what a pixel to the right and one down add to it.
struct LinearRays {
    Ray corner, per_x, per_y;

    Ray at(const Vec2& pixel) const {
        return {corner.origin + pixel.x * per_x.origin + pixel.y * per_y.origin,
                corner.direction + pixel.x * per_x.direction + pixel.y * per_y.direction};
    }
};

/// A film in pixels.
struct FilmSize {
    double width = 1, height = 1;
};

/// A camera whose rays are not linear over the film. Thread-safe to read.
///
/// The film may show the world by several branches, each a one-to-one map from world points to film places
/// that goes on smoothly beyond the part of the film that it owns (the views of a picture with several; the
/// near and the far side of a sphere seen from all around). Most cameras have one.
class CameraModel {
  public:
    virtual ~CameraModel() = default;

    /// The exact ray of a place on the film, world frame, in pixels from its top left; the direction's
    /// length is the unit of t (unit, or of unit depth along the view axis where there is one). None where
    /// the camera has no ray. Defined a little beyond the film too, where the formula goes on.
    virtual std::optional<Ray> ray(const Vec2& at) const = 0;

    /// The rays of all places, where these are linear functions of the place; else null.
    virtual const LinearRays* linear_rays() const { return nullptr; }

    virtual std::size_t branch_count() const { return 1; }
    /// Where the branch shows the point, or would, were the film larger. None where its formula has no place
    /// for it (behind a pinhole).
    virtual std::optional<FilmImage> place(const Vec3& point, std::size_t branch) const = 0;
    /// All places at which the branch, or its smooth continuation, shows the point: several where its image
    /// folds.
    virtual std::vector<FilmImage> places(const Vec3& point, std::size_t branch) const {
        const std::optional<FilmImage> one = place(point, branch);
        return one ? std::vector<FilmImage>{*one} : std::vector<FilmImage>{};
    }
    /// Whether the branch is the one (or one of those) that the film shows there.
    virtual bool shows(std::size_t /*branch*/, const Vec2& /*at*/) const { return true; }

    /// Pixels in x after which the film shows the same again (a full turn of a panorama); 0: it does not.
    virtual double period() const { return 0; }

    /// The point through which all rays go, where there is one.
    virtual std::optional<Vec3> eye() const { return std::nullopt; }

    /// Places x, or y, in pixels inside the film where the rays or their derivatives jump: facets end there.
    virtual std::vector<double> breaks_x() const { return {}; }
    virtual std::vector<double> breaks_y() const { return {}; }

    /// How many pixels in x one pixel's worth of angle fills there, where a whole row shows one direction
    /// (the poles of a panorama); 1 elsewhere. Errors along x are counted in pixels' worth.
    virtual double stretch(const Vec2& /*at*/) const { return 1; }

    /// Where along its rays a camera's users look, in units of t; the film's error is judged there.
    virtual double focus() const = 0;
};

/// All images of the point with t >= 0: those that the film of this size shows, by branch, and for a camera
/// of one branch, where none is on the film, the one beyond it.
std::vector<FilmImage> film_images(const CameraModel& model, const FilmSize& film, const Vec3& point);

// The axes of a film in the world, and how cameras refuse what leaves them none.

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
