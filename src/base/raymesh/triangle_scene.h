// The scene as projector and truth see it, a structure of arrays of world-space triangles, and what a ray
// sees of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"

namespace trilens {

/// Triangles in the world frame. Three arrays of one length, one entry per triangle; `points` is shared.
/// Any winding; zero-area triangles are legal and never seen.
struct TriangleScene {
    std::vector<Vec3> points;
    std::vector<IdTriple> triangles;  // indices into points
    std::vector<Id> object;           // the mesh, in scene order
    std::vector<Id> primitive;        // the triangle's number inside its mesh

    std::size_t size() const { return triangles.size(); }
};

/// What a ray sees: the first triangle along it.
struct Hit {
    Id triangle = kNone;  // index into TriangleScene::triangles; kNone: nothing is seen, the rest is unset
    double t = 0;         // in units of the ray's direction, >= 0
    Vec2 barycentric{0};  // weights of the triangle's second and third corner

    bool seen() const { return triangle != kNone; }
};

/// The world point of a hit: the triangle's corners weighted by the hit's barycentrics.
inline Vec3 position(const TriangleScene& scene, const Hit& hit) {
    const IdTriple& corner = scene.triangles[hit.triangle];
    const double first = 1.0 - hit.barycentric.x - hit.barycentric.y;
    return first * scene.points[corner[0]] + hit.barycentric.x * scene.points[corner[1]] +
           hit.barycentric.y * scene.points[corner[2]];
}

/// Two hits whose t differ by less than this share of t are taken as one depth: the triangle with the
/// smaller (object, primitive) is then the one seen, in the projector and in the truth alike.
inline constexpr double kDepthTie = 1e-9;

/// As far apart as rounding puts two surfaces at one place. Of surfaces that let light through in part, what
/// one leg of a path leaves out where it ends, the next takes in, which starts there: both ask for one place.
inline double same_place(const Vec3& place) {
    constexpr double kShare = 1e-8;  // of the largest coordinate
    return kShare * std::max({std::fabs(place.x), std::fabs(place.y), std::fabs(place.z)});
}

/// Whether what lies at t, of `object`, is seen before what lies at than_t, of than_object, by that rule; for
/// two hits of different objects along one ray.
inline bool comes_before(double t, Id object, double than_t, Id than_object) {
    if (std::fabs(t - than_t) <= kDepthTie * std::fabs(std::min(t, than_t))) return object < than_object;
    return t < than_t;
}

/// The first triangle along a ray, not yet placed on it: an entry of a visibility buffer (Burns and Hunt,
/// "The Visibility Buffer", JCGT 2013).
struct Visible {
    Id triangle = kNone;  // index into TriangleScene::triangles; kNone: nothing is seen
    // Its t, in units of the ray's direction, lies between them; both infinite where nothing is seen.
    float t_low = std::numeric_limits<float>::infinity(), t_high = std::numeric_limits<float>::infinity();

    bool seen() const { return triangle != kNone; }
};

}  // namespace trilens
