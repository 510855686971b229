// A scene triangle's edges as the parametric triangle cuts them: one point per t, the same for both of an
// edge's users.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "trilinear/facet/coplanarity.h"

namespace trilens {

/// A triangle of the scene, world frame.
struct SceneTriangle {
    std::array<Vec3, 3> corner;

    /// Edge e runs from corner e to corner (e + 1) % 3.
    const Vec3& from(std::size_t edge) const { return corner[edge]; }
    const Vec3& to(std::size_t edge) const { return corner[(edge + 1) % 3]; }
    Vec3 point(const Vec3& barycentric) const {
        return barycentric.x * corner[0] + barycentric.y * corner[1] + barycentric.z * corner[2];
    }
};

/// A point of a scene triangle as a facet images it.
struct ImageVertex {
    double t = 0;         // on the ray, in units of its direction
    Vec3 weights{0};      // of the facet's corners, sum 1
    Vec3 barycentric{0};  // of the scene triangle's corners, sum 1
};

/// A total order of points, so that what two users of an edge compute starts from the same end.
bool canonically_before(const Vec3& a, const Vec3& b);

/// A point of an edge: the weights of its two ends, which sum to 1, and the point.
struct EdgePoint {
    double from = 1, to = 0;
    Vec3 point{0};
};

/// Where the plane of the parametric triangle at `t` cuts the line through `a` and `b`, for cuts between
/// them: clamped to the edge. Exchanging a and b exchanges the weights and changes no bit.
EdgePoint cut_edge(const Coplanarity& facet, double t, const Vec3& a, const Vec3& b);

/// The image of the cut of a triangle's edge at `t`; none where the parametric triangle is degenerate.
std::optional<ImageVertex> edge_cut(const Coplanarity& facet, const SceneTriangle& triangle, std::size_t edge,
                                    double t);

}  // namespace trilens
