#include "vector/caustic.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/raymesh/sample_grid.h"
#include "base/util/error.h"
#include "camera/model/general_linear.h"

namespace trilens {
namespace {

constexpr double kDouble = 1e-3;  // share of the discriminant's terms by which roots may be complex
constexpr double kZero = 1e-9;    // share of the other terms below which a coefficient is zero
constexpr double kPoint = 1e-6;   // of the scene's size: rays meet in one place, but for the rounding of a
                                  // double root
constexpr double kThin = 1e-9;    // area over squared length of what is a line

/// Where a ray touches the caustic: size / distance along it, the first the larger; infinite at its start.
using Touches = std::array<std::optional<double>, 2>;

/// Of a t^2-equation with coefficients for t in units of the scene's size.
Touches touches(double constant, double linear, double quadratic) {
    const double most = std::max({std::fabs(constant), std::fabs(linear), std::fabs(quadratic)});
    if (!(most > 0)) return {};
    const double start = std::numeric_limits<double>::infinity();
    if (std::fabs(constant) <= kZero * most) {
        if (std::fabs(linear) <= kZero * most) return {start, start};
        return {start, -quadratic / linear};
    }
    const double half = -linear / (2 * constant),
                 terms = linear * linear + std::fabs(4 * constant * quadratic);
    const double discriminant = linear * linear - 4 * constant * quadratic;
    if (discriminant < -kDouble * terms) return {};
    const double root = std::sqrt(std::max(discriminant, 0.0)) / (2 * std::fabs(constant));
    return {half + root, half - root};
}

/// The places of one sheet at the mesh's corners, and on which side of the rays' starts each lies.
struct SheetCorner {
    Vec3 place{0};
    int side = 0;  // 1: along the ray, -1: behind its start, 0: there is none
};

std::array<SheetCorner, 2> at_corner(const Ray& ray, const RaySlope& slope, double size) {
    const double speed = length(ray.direction);
    if (!(speed > 0)) return {};
    const double unit = size / speed;  // t of one size
    const RaySpread spread =
        ray_spread({ray, {slope.origin_x, slope.direction_x}, {slope.origin_y, slope.direction_y}});
    const Touches found = touches(spread.constant, spread.linear * unit, spread.quadratic * unit * unit);
    std::array<SheetCorner, 2> corners;
    for (std::size_t k = 0; k < 2; ++k) {
        if (!found[k] || std::fabs(*found[k]) < 1 / kFarCaustic) continue;
        corners[k] = {ray.origin + unit / *found[k] * ray.direction, *found[k] > 0 ? 1 : -1};
    }
    return corners;
}

/// Whether a triangle is a line; `ends`: of its longest side.
bool is_thin(const std::array<Vec3, 3>& at, std::array<std::size_t, 2>& ends) {
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double side = length(at[(k + 1) % 3] - at[k]);
        if (side > longest) longest = side, ends = {k, (k + 1) % 3};
    }
    return length(cross(at[1] - at[0], at[2] - at[0])) <= kThin * longest * longest;
}

/// One sheet on one side, with points of its own.
CausticSheet gather(const CausticParams& params, const std::vector<std::array<SheetCorner, 2>>& corners,
                    int index, int side) {
    CausticSheet sheet{index, side < 0, {}, {}, {}};
    std::vector<Id> point_of(corners.size(), kNone);
    const auto point = [&](Id corner) {
        if (point_of[corner] == kNone) {
            point_of[corner] = static_cast<Id>(sheet.points.size());
            sheet.points.push_back(corners[corner][static_cast<std::size_t>(index)].place);
        }
        return point_of[corner];
    };
    for (std::size_t f = 0; f < params.mesh.facets.size(); ++f) {
        if (!params.mesh.has_rays(f) || (!params.seen.empty() && !params.seen[f])) continue;
        const IdTriple& facet = params.mesh.facets[f];
        std::array<Vec3, 3> at;
        bool whole = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const SheetCorner& corner = corners[facet[k]][static_cast<std::size_t>(index)];
            whole = whole && corner.side == side;
            at[k] = corner.place;
        }
        if (!whole) continue;
        std::array<std::size_t, 2> ends{};
        const bool thin = is_thin(at, ends);
        if (length(at[ends[1]] - at[ends[0]]) <= kPoint * params.size) continue;
        if (thin)
            sheet.segments.push_back({point(facet[ends[0]]), point(facet[ends[1]])});
        else
            sheet.triangles.push_back({point(facet[0]), point(facet[1]), point(facet[2])});
    }
    return sheet;
}

}  // namespace

std::vector<CausticSheet> caustic_sheets(const CausticParams& params) {
    check_facet_corners(params.mesh);
    if (!params.seen.empty() && params.seen.size() != params.mesh.facets.size())
        throw InputError("", "seen", "has not one entry per facet");
    const std::vector<RaySlope> slopes = corner_slopes(params.mesh);
    std::vector<std::array<SheetCorner, 2>> corners(slopes.size());
    for (std::size_t c = 0; c < corners.size(); ++c)
        corners[c] = at_corner(params.mesh.rays[c], slopes[c], params.size);
    std::vector<CausticSheet> sheets;
    for (const int index : {0, 1})
        for (const int side : {1, -1}) {
            CausticSheet sheet = gather(params, corners, index, side);
            if (!sheet.points.empty()) sheets.push_back(std::move(sheet));
        }
    return sheets;
}

RaySlope slope_in_facet(const RayMesh& mesh, std::size_t facet, const FacetWeights& weights, const Vec3& e) {
    const double whole = e.x + e.y + e.z;
    const auto change = [&](int axis) {  // of the weights
        const Vec3& column = weights.weights_from_screen[axis];
        return (column - e / whole * (column.x + column.y + column.z)) / whole;
    };
    const Vec3 x = change(0), y = change(1);
    RaySlope slope;
    for (int k = 0; k < 3; ++k) {
        const Ray& ray = mesh.rays[mesh.facets[facet][static_cast<std::size_t>(k)]];
        slope.add({ray.origin, Vec3(0), ray.direction, Vec3(0)}, x[k]);
        slope.add({Vec3(0), ray.origin, Vec3(0), ray.direction}, y[k]);
    }
    return slope;
}

std::vector<RaySlope> corner_slopes(const RayMesh& mesh) {
    std::vector<RaySlope> slopes(mesh.rays.size());
    std::vector<double> count(mesh.rays.size(), 0);
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (!mesh.has_rays(f)) continue;
        const FacetWeights weights = facet_weights(mesh, f);
        if (weights.edge_on) continue;
        for (const Id corner : mesh.facets[f]) {
            const Vec3& at = mesh.screen[corner];
            if (!(at.z > 0)) continue;
            const Vec3 e = weights.unnormalised(at.x / at.z, at.y / at.z);
            slopes[corner].add(slope_in_facet(mesh, f, weights, e), 1);
            ++count[corner];
        }
    }
    for (std::size_t c = 0; c < slopes.size(); ++c) {
        RaySlope mean;
        if (count[c] > 0) mean.add(slopes[c], 1 / count[c]);
        slopes[c] = mean;
    }
    return slopes;
}

}  // namespace trilens
