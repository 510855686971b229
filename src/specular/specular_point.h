// Where a world point appears in a curved mirror or through an interface, exactly (Fermat's principle).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/surface.h"

namespace trilens {

enum class SpecularEvent { kReflect, kRefract };

/// Which side of the surface the camera is to look at.
enum class ViewedSide { kEither, kFront, kBack };

/// One question: by which points of a surface does light go from `point` to the camera with one reflection or
/// refraction?
struct SpecularQuery {
    LinearCamera camera;
    Vec3 point{0};  // world frame
    SpecularEvent event = SpecularEvent::kReflect;
    double eye_index = 1,
           point_index = 1;  // kRefract: refractive indices of the media that camera and point lie in, > 0
    bool own_normals =
        true;  // the surface's normals are along du x dv; false where a normal field overrides them
    ViewedSide viewed = ViewedSide::kEither;  // images on another side do not count

    bool operator==(const SpecularQuery&) const = default;
};

/// One image of the point.
struct SpecularPoint {
    SurfaceParameter at;
    Vec3 position{0};     // world frame, on the surface
    Vec3 normal{0};       // there: unit, the surface's
    Vec2 pixel{0};        // where the camera sees it, from the film's top left; may lie outside the film
    double distance = 0;  // from position to the point, scene units
    double t = 0;         // the same in units of the incident direction's length, as along a corner ray
    bool front = true;    // the camera looks at the surface's front
    double residual = 0;  // what is left of the law, see refine_specular_point
    int iterations = 0;
};

/// The image nearest to `start`, or none where the iteration ends elsewhere: no solution nearby, one outside
/// this face (start again on the neighbour), a point of the wrong kind (a "reflection" through the surface,
/// or seen from another side than `viewed`), or one behind the camera. Occlusion is not looked at: whether
/// the light reaches the surface and the eye is for a tracer to say.
///
/// The law, for both kinds: h = n1 e + n2 x is parallel to the normal, where e and x are the unit directions
/// from the camera and from the point to the surface (a mirror has n1 = n2 = 1). For own normals, h . du = h
/// . dv = 0 is where the optical path n1 |P - E| + n2 |P - X| is stationary, solved with its exact second
/// derivatives; for overridden normals du and dv are first laid into the plane at right angles to the normal,
/// and the Jacobian is by differences. Levenberg-Marquardt in the surface's metric; the residual is the
/// length of h along the surface, in 0..n1 + n2, and always falls.
std::optional<SpecularPoint> refine_specular_point(const Surface& surface, const SurfaceParameter& start,
                                                   const SpecularQuery& query);

/// The same for a start in the face's domain, of which surface.eval(start.face, start.uv) is known.
std::optional<SpecularPoint> refine_specular_point(const Surface& surface, const SurfaceParameter& start,
                                                   const SurfacePoint& point, const SpecularQuery& query);

/// All images that refining from `starts` finds, each once, by ascending t. Starts near the images suffice: a
/// facet's image of the point; regular_starts where nothing is known.
std::vector<SpecularPoint> specular_points(const Surface& surface, std::span<const SurfaceParameter> starts,
                                           const SpecularQuery& query);

/// The middles of an n x n division of every face's domain (of n(n + 1)/2 of the cells for triangles), face
/// by face.
std::vector<SurfaceParameter> regular_starts(const Surface& surface, int n);
/// Those of one face.
void append_regular_starts(const Surface& surface, Id face, int n, std::vector<SurfaceParameter>& starts);

/// Images of one optic, each once, by ascending t: two are one when the camera sees them within kSamePixels
/// pixels of each other on one crossing of the surface (the same side, positions alike to kSameCrossing of
/// the distance). Of duplicates the smallest residual stays.
std::vector<SpecularPoint> distinct_images(std::vector<SpecularPoint> images);

inline constexpr double kSamePixels = 1e-6;
inline constexpr double kSameCrossing = 1e-3;

// The law of one reflection or refraction as Fermat's principle gives it: directions, their turning, and the
// second derivatives of the optical path.

/// The light's path over one point of the surface.
struct SpecularPath {
    Vec3 from_eye{0}, from_point{0};              // unit: e and x
    double eye_distance = 0, point_distance = 0;  // eye_distance infinite for parallel cameras
    Vec3 bend{0};                                 // h = n1 e + n2 x
};

struct PathIndices {
    double eye = 1, point = 1;
};

PathIndices path_indices(const SpecularQuery& query);

SpecularPath specular_path(const SpecularQuery& query, const Vec3& position);

/// The Hessian of the optical path: the turning of e and x along the tangents, plus h along the surface's
/// bending. For own normals.
Mat2 path_hessian(const SpecularQuery& query, const SurfacePoint& point);

/// The same where specular_path(query, point.position) is known.
Mat2 path_hessian(const SpecularQuery& query, const SpecularPath& path, const SurfacePoint& point);

/// Whether eye and point lie on the sides of the surface that the event and `viewed` ask for.
bool sides_fit(const SpecularQuery& query, const SpecularPath& path, const Vec3& normal);

}  // namespace trilens
