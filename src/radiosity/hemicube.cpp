#include "radiosity/hemicube.h"

#include <array>
#include <cmath>
#include <numbers>

#include "base/raymesh/rasterize.h"
#include "base/util/check.h"

namespace trilens {
namespace {

constexpr std::size_t kFaces = 5;

/// The form factor from a point to the rectangle [0, x] x [0, y] of the plane one unit above it.
double factor_above(double x, double y) {
    const double a = std::sqrt(1 + x * x), b = std::sqrt(1 + y * y);
    return (x / a * std::atan(y / a) + y / b * std::atan(x / b)) / (2 * std::numbers::pi);
}

/// The same of [0, x] along and [0, z] up an upright plane one unit beside it.
double factor_beside(double x, double z) {
    const double a = std::sqrt(1 + z * z);
    return (std::atan(x) - std::atan(x / a) / a) / (2 * std::numbers::pi);
}

template <typename Corner>
double over_rectangle(const Corner& corner, const Vec2& low, const Vec2& high) {
    return corner(high.x, high.y) - corner(low.x, high.y) - corner(high.x, low.y) + corner(low.x, low.y);
}

/// Corners of a face on the film and the directions through them, clockwise from its top left.
struct HemicubeFace {
    std::array<Vec3, 4> directions;
    double top = 0, height = 0;
};

std::array<HemicubeFace, kFaces> faces_of(const HemicubePlace& place, double resolution) {
    const Vec3 &n = place.normal, &t = place.tangent, b = cross(n, t);
    std::array<HemicubeFace, kFaces> faces;
    faces[0] = {{n - t + b, n + t + b, n + t - b, n - t - b}, 0, resolution};
    const std::array<Vec3, 4> beside{t, b, -t, -b};
    for (std::size_t k = 0; k < beside.size(); ++k) {
        const Vec3& middle = beside[k];
        const Vec3 right = cross(middle, n);
        faces[k + 1] = {{middle - right + n, middle + right + n, middle + right, middle - right},
                        resolution * (1 + 0.5 * static_cast<double>(k)),
                        resolution / 2};
    }
    return faces;
}

}  // namespace

Hemicube::Hemicube(int resolution) {
    TRILENS_CHECK(resolution > 0 && resolution % 2 == 0, "a hemicube's resolution is even and positive");
    grid_.x1 = resolution;
    grid_.y1 = 3 * resolution;
    owned_ = rasterize_facets(mesh({}), grid_);
    const double size = 2.0 / resolution;  // of a pixel, where the cube's edge is 2
    factors_.resize(grid_.size());
    for (std::size_t s = 0; s < factors_.size(); ++s) {
        const int x = static_cast<int>(grid_.position(s).x), y = static_cast<int>(grid_.position(s).y);
        const int row = y < resolution ? y : (y - resolution) % (resolution / 2);
        const double left = -1 + size * x;
        if (y < resolution) {
            const double low = 1 - size * (row + 1);
            factors_[s] = over_rectangle(factor_above, {left, low}, {left + size, low + size});
        } else {
            const double low = 1 - size * (row + 1);  // the last row ends at the horizon
            factors_[s] = over_rectangle(factor_beside, {left, low}, {left + size, low + size});
        }
    }
}

RayMesh Hemicube::mesh(const HemicubePlace& place) const {
    const double width = grid_.x1;
    RayMesh mesh;
    for (const HemicubeFace& face : faces_of(place, width)) {
        const auto first = static_cast<Id>(mesh.rays.size());
        const double bottom = face.top + face.height;
        const std::array<Vec3, 4> screen{Vec3(0, face.top, 1), Vec3(width, face.top, 1),
                                         Vec3(width, bottom, 1), Vec3(0, bottom, 1)};
        for (std::size_t k = 0; k < 4; ++k) {
            mesh.rays.push_back({place.origin, face.directions[k]});
            mesh.screen.push_back(screen[k]);
        }
        mesh.facets.push_back({first, first + 1, first + 2});
        mesh.facets.push_back({first, first + 2, first + 3});
    }
    return mesh;
}

}  // namespace trilens
