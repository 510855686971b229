// Builds the tree level by level, all faces at once.
#include "specular/cell_bvh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/util/parallel.h"

namespace trilens {
namespace {

/// Cells whose normals turn less than this are halved no further in advance.
constexpr double kFlatEnough = 0.05;
/// Nor any once there are this many for each face, and this many in all (some 300 bytes each).
constexpr std::size_t kCellsPerFace = 256, kMostCells = 1u << 17;

PlaceBounds joined(const PlaceBounds& a, const PlaceBounds& b) {
    PlaceBounds both;
    // The smallest ball around two balls.
    const Vec3 way = b.position - a.position;
    const double distance = length(way);
    if (distance + b.position_radius <= a.position_radius) {
        both.position = a.position;
        both.position_radius = a.position_radius;
    } else if (distance + a.position_radius <= b.position_radius) {
        both.position = b.position;
        both.position_radius = b.position_radius;
    } else {
        both.position_radius = 0.5 * (distance + a.position_radius + b.position_radius) * (1 + 1e-14);
        both.position = a.position + way * ((both.position_radius - a.position_radius) / distance);
    }
    both.normal = normalize_or_zero(a.normal + b.normal);
    both.normal_radius = std::min(2.0, std::max(length(both.normal - a.normal) + a.normal_radius,
                                                length(both.normal - b.normal) + b.normal_radius));
    return both;
}

}  // namespace

bool is_outside(FaceDomain domain, const CellBox& box) {
    return domain == FaceDomain::kTriangle && box.low.x + box.low.y >= 1;
}

std::pair<CellBox, CellBox> halves_of(const CellBox& box, const SurfacePoint& middle) {
    const Vec2 half = box.half();
    // Sides differ by no more than 2^6, however the derivatives do (both zero, at worst).
    const double u = length(middle.du) * half.x, v = length(middle.dv) * half.y;
    const bool across_u =
        half.x > 64 * half.y || (half.y <= 64 * half.x && (u == v ? half.x >= half.y : u > v));
    const int axis = across_u ? 0 : 1;
    std::pair<CellBox, CellBox> halves{box, box};
    halves.first.high[axis] = halves.second.low[axis] = box.middle()[axis];
    return halves;
}

CellBvh::CellBvh(const Surface& surface) : surface_(surface), bounder_(surface.make_bounder()) {
    if (!bounder_ || surface.face_count() == 0) return;
    const std::size_t faces = surface.face_count();
    cells_.resize(faces);
    parallel_for(faces, 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) {
            cells_[f].box.face = static_cast<Id>(f);
            cells_[f].bounds = bounder_->bounds(static_cast<Id>(f), Vec2(0), Vec2(1));
        }
    });
    const std::size_t most = std::min(kCellsPerFace * faces, kMostCells);
    for (std::size_t from = 0; from < cells_.size() && cells_.size() < most;) {
        const std::size_t to = cells_.size();
        add_halves(from, to);
        from = to;
    }
    std::vector<std::size_t> order(faces);
    for (std::size_t f = 0; f < faces; ++f) order[f] = f;
    add_groups(order);
}

void CellBvh::add_halves(std::size_t from, std::size_t to) {
    for (std::size_t c = from; c < to; ++c) {
        const SurfaceBounds& bounds = cells_[c].bounds;
        const FaceDomain domain = surface_.domain(cells_[c].box.face);
        const bool is_flat = bounds.normal_radius < kFlatEnough && std::isfinite(bounds.duu_radius);
        if (bounds.is_finest || is_flat || is_outside(domain, cells_[c].box)) continue;
        const auto halves = halves_of(cells_[c].box, bounds.middle);
        cells_[c].halves = cells_.size();
        cells_.push_back({halves.first, {}, 0});
        cells_.push_back({halves.second, {}, 0});
    }
    parallel_for(cells_.size() - to, 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t c = to + first; c < to + last; ++c) {
            SurfaceCell& cell = cells_[c];
            if (is_outside(surface_.domain(cell.box.face), cell.box)) continue;
            cell.bounds = bounder_->bounds(cell.box.face, cell.box.low, cell.box.high);
        }
    });
}

std::size_t CellBvh::add_groups(std::span<std::size_t> faces) {
    CellGroup group;
    if (faces.size() == 1) {
        group.leaf = true;
        group.first = faces.front();
        group.place = place_of(cells_[group.first].bounds);
        groups_.push_back(group);
        return groups_.size() - 1;
    }
    // In two at the median, along the axis in which the faces' middles spread the most.
    Vec3 low(cells_[faces.front()].bounds.middle.position), high = low;
    for (const std::size_t f : faces) {
        low = glm::min(low, cells_[f].bounds.middle.position);
        high = glm::max(high, cells_[f].bounds.middle.position);
    }
    const Vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t half = faces.size() / 2;
    std::sort(faces.begin(), faces.end(), [&](std::size_t a, std::size_t b) {
        const double p = cells_[a].bounds.middle.position[axis], q = cells_[b].bounds.middle.position[axis];
        return p != q ? p < q : a < b;
    });
    group.first = add_groups(faces.first(half));
    group.second = add_groups(faces.subspan(half));
    group.place = joined(groups_[group.first].place, groups_[group.second].place);
    groups_.push_back(group);
    return groups_.size() - 1;
}

}  // namespace trilens
