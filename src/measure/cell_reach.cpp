#include "measure/cell_reach.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "measure/patch.h"

namespace trilens {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

float rounded_down(double x) {
    return std::nextafter(static_cast<float>(x), -kInfinity);
}
float rounded_up(double x) {
    return std::nextafter(static_cast<float>(x), kInfinity);
}

double along(const float (&direction)[3], const Vec3& p) {
    return static_cast<double>(direction[0]) * p.x + static_cast<double>(direction[1]) * p.y +
           static_cast<double>(direction[2]) * p.z;
}

void set_direction(const Vec3& direction, CellReach::Slab& slab) {
    const Vec3 unit = normalize_or_zero(direction);
    for (int k = 0; k < 3; ++k) slab.direction[k] = static_cast<float>(unit[k]);
}

/// Across each of the patch's own tangents, within its plane.
void set_directions(const Patch& patch, CellReach& reach) {
    const auto& n = patch.nodes;
    const Vec3 du = n[6] - n[5] + n[10] - n[9], dv = n[9] - n[5] + n[10] - n[6], normal = cross(du, dv);
    set_direction(cross(dv, normal), reach.slabs[0]);
    set_direction(cross(normal, du), reach.slabs[1]);
}

void include(const PatchHull& hull, CellReach& reach) {
    // The direction is no longer than 1 but for its rounding to float; what a patch shows lies within a few
    // times its own size from the origin, and `around` is more than the products' rounding there.
    const double around = hull.around * (1 + 1e-6);
    for (std::size_t i = 0; i < hull.count; ++i) {
        const Vec3& p = hull.points[i];
        for (int k = 0; k < 3; ++k) {
            reach.low[k] = std::min(reach.low[k], rounded_down(p[k] - hull.around));
            reach.high[k] = std::max(reach.high[k], rounded_up(p[k] + hull.around));
        }
        for (CellReach::Slab& slab : reach.slabs) {
            const double at = along(slab.direction, p);
            slab.low = std::min(slab.low, rounded_down(at - around));
            slab.high = std::max(slab.high, rounded_up(at + around));
        }
    }
}

/// The patches of a cell, each once.
struct CellPatches {
    const SeenField &field, &other;
    int column, row;
    CellReach& reach;
    bool any = false;

    /// By triangles, or whole.
    void add(bool by_triangle) {
        std::uint16_t seen = 0;
        for (int corner = 0; corner < 4; ++corner) {
            const int x = column + corner % 2, y = row + corner / 2;
            if (!field.contains(x, y) || (seen >> kCellCorner[static_cast<std::size_t>(corner)]) & 1)
                continue;
            const SeenPoint point = field.seen_point(field.index(x, y));
            Piece piece{point.object, point.optic, std::nullopt};
            if (by_triangle) piece.primitive = point.primitive;
            const std::optional<Patch> patch = make_patch(field, other, {column, row, corner}, piece);
            if (!patch) continue;
            seen |= patch->measured;
            if (!any) set_directions(*patch, reach);
            any = true;
            include(hull_of(*patch), reach);
        }
    }
};

}  // namespace

bool CellReach::may_hold(const Vec3& point) const {
    for (int k = 0; k < 3; ++k)
        if (point[k] < static_cast<double>(low[k]) || point[k] > static_cast<double>(high[k])) return false;
    for (const Slab& slab : slabs) {
        const double at = along(slab.direction, point);
        if (at < static_cast<double>(slab.low) || at > static_cast<double>(slab.high)) return false;
    }
    return true;
}

CellReach reach_of_cell(const FieldIndex& index, const SeenField& other, int column, int row) {
    CellReach reach;
    std::fill_n(reach.low, 3, kInfinity);
    std::fill_n(reach.high, 3, -kInfinity);
    for (CellReach::Slab& slab : reach.slabs) slab = {{0, 0, 0}, kInfinity, -kInfinity};
    CellPatches patches{index.field, other, column, row, reach};
    patches.add(false);
    // By triangles the same again where there is but one.
    if (!(index.wholeness(column, row) & FieldIndex::kWholeTriangle)) patches.add(true);
    return reach;
}

}  // namespace trilens
