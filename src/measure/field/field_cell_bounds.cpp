#include "measure/field/field_pyramid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "measure/field/patch.h"

namespace trilens {
namespace {

constexpr float kUnbounded = std::numeric_limits<float>::infinity();
constexpr double kFar = std::numeric_limits<double>::infinity();

float rounded_down(double x) {
    return std::nextafter(static_cast<float>(x), -kUnbounded);
}
float rounded_up(double x) {
    return std::nextafter(static_cast<float>(x), kUnbounded);
}

double along(const float (&direction)[3], const Vec3& p) {
    return static_cast<double>(direction[0]) * p.x + static_cast<double>(direction[1]) * p.y +
           static_cast<double>(direction[2]) * p.z;
}

void set_direction(const Vec3& direction, FieldCellBounds::Slab& slab) {
    const Vec3 unit = normalize_or_zero(direction);
    for (int k = 0; k < 3; ++k) slab.direction[k] = static_cast<float>(unit[k]);
}

/// Across each of the patch's own tangents, within its plane.
void set_directions(const Patch& patch, FieldCellBounds& reach) {
    const auto& n = patch.nodes;
    const Vec3 du = n[6] - n[5] + n[10] - n[9], dv = n[9] - n[5] + n[10] - n[6], normal = cross(du, dv);
    set_direction(cross(dv, normal), reach.slabs[0]);
    set_direction(cross(normal, du), reach.slabs[1]);
}

/// The bounds while they grow, not yet rounded.
struct GrowingReach {
    FieldCellBounds& reach;
    Box box = {};
    double low[2] = {kFar, kFar}, high[2] = {-kFar, -kFar};  // of the slabs
    bool any = false;

    void include(const Patch& patch) {
        if (!any) set_directions(patch, reach);
        any = true;
        const PatchHull hull = hull_of(patch);
        // The direction is no longer than 1 but for its rounding to float; what a patch shows lies within a
        // few times its own size from the origin, and `around` is more than the products' rounding there.
        const double around = hull.around * (1 + 1e-6);
        Box points;
        for (std::size_t i = 0; i < hull.count; ++i) points.include(hull.points[i]);
        box.include(points.low - Vec3(around));
        box.include(points.high + Vec3(around));
        for (std::size_t k = 0; k < 2; ++k) {
            for (std::size_t i = 0; i < hull.count; ++i) {
                const double at = along(reach.slabs[k].direction, hull.points[i]);
                low[k] = std::min(low[k], at - around);
                high[k] = std::max(high[k], at + around);
            }
        }
    }
    void round() const {
        for (int k = 0; k < 3; ++k) {
            reach.low[k] = any ? rounded_down(box.low[k]) : kUnbounded;
            reach.high[k] = any ? rounded_up(box.high[k]) : -kUnbounded;
        }
        for (std::size_t k = 0; k < 2; ++k) {
            reach.slabs[k].low = any ? rounded_down(low[k]) : kUnbounded;
            reach.slabs[k].high = any ? rounded_up(high[k]) : -kUnbounded;
        }
    }
};

/// The patches of a cell, each once, by triangles or whole.
void include_pieces(const PositionField& field, const PositionField& other, const PatchPlace& cell,
                    bool by_triangle, GrowingReach& reach) {
    std::uint16_t seen = 0;
    for (int corner = 0; corner < 4; ++corner) {
        const int x = cell.column + corner % 2, y = cell.row + corner / 2;
        if (!field.contains(x, y) || (seen >> kCellCorner[static_cast<std::size_t>(corner)]) & 1) continue;
        const FieldSample point = field.seen_point(field.index(x, y));
        SurfaceId piece{point.object, point.optic, std::nullopt};
        if (by_triangle) piece.primitive = point.primitive;
        const std::optional<Patch> patch = make_patch(field, other, {cell.column, cell.row, corner}, piece);
        if (!patch) continue;
        seen |= patch->measured;
        reach.include(*patch);
    }
}

}  // namespace

bool FieldCellBounds::may_hold(const Vec3& point) const {
    for (int k = 0; k < 3; ++k)
        if (point[k] < static_cast<double>(low[k]) || point[k] > static_cast<double>(high[k])) return false;
    for (const Slab& slab : slabs) {
        const double at = along(slab.direction, point);
        if (at < static_cast<double>(slab.low) || at > static_cast<double>(slab.high)) return false;
    }
    return true;
}

FieldCellBounds reach_of_cell(const FieldPyramid& index, const PositionField& other, int column, int row) {
    FieldCellBounds reach;
    GrowingReach growing{reach};
    const std::uint8_t wholeness = index.wholeness(column, row);
    const PatchPlace cell{column, row, 0};
    if (wholeness & FieldPyramid::kWhole)
        growing.include(index.whole_patch(column, row));
    else
        include_pieces(index.field, other, cell, false, growing);
    // By triangles the same again where there is but one.
    if (!(wholeness & FieldPyramid::kWholeTriangle)) include_pieces(index.field, other, cell, true, growing);
    growing.round();
    return reach;
}

}  // namespace trilens
