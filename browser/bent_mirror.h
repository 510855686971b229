// A mirror that can be bent: a bicubic Bezier patch (Farin, Curves and Surfaces for CAGD), and its grid of
// facets.
#pragma once

#include <array>

#include "base/raymesh/surface.h"

namespace trilens::browser {

struct BentMirror {
    double width = 3.4, height = 2.4;  // flat, scene units
    Vec3 middle{0, 1.5, 0};            // world frame
    double turn = 0;                   // degrees about the vertical through its middle
    std::array<double, 16>
        bulge{};  // of the control points, in rows from the lower left: out of the plane to the front
};

/// The mirror's point at (u, v), each 0..1 from the lower left, world frame; du x dv points to the front.
SurfacePoint eval(const BentMirror& mirror, const Vec2& uv);

/// n x n squares of two facets; facet_uv are places of the whole mirror. n >= 1.
SurfaceGrid make_grid(const BentMirror& mirror, int n);

}  // namespace trilens::browser
