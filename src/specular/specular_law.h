// The law of one reflection or refraction as Fermat's principle gives it.
#pragma once

#include "base/raymesh/surface.h"
#include "specular/specular_point.h"

namespace trilens {

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
