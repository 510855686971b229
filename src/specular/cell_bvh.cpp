// Groups are made at once, halves of cells when a search first comes to them.
#include "specular/cell_bvh.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/raymesh/face_neighbours.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

/// So many cells are halved at most (their halves take some 600 bytes).
constexpr std::size_t kMostHalved = 1u << 16;

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

SurfaceCell::~SurfaceCell() {
    delete halves_.load();
}

CellBvh::CellBvh(const Surface& surface, Occluder first_hit)
    : surface_(surface), bounder_(surface.make_bounder()), faces_(bounder_ ? surface.face_count() : 0) {
    if (faces_.empty()) return;
    if (first_hit && is_closed(surface)) occluder_ = std::move(first_hit);
    parallel_for(faces_.size(), 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) {
            faces_[f].box.face = static_cast<Id>(f);
            faces_[f].bounds = bounder_->bounds(static_cast<Id>(f), Vec2(0), Vec2(1));
        }
    });
    std::vector<std::size_t> order(faces_.size());
    for (std::size_t f = 0; f < order.size(); ++f) order[f] = f;
    add_groups(order);
}

const CellHalves* CellBvh::halves(const SurfaceCell& cell) const {
    if (const CellHalves* known = cell.halves_.load(std::memory_order_acquire)) return known;
    if (halved_.load(std::memory_order_relaxed) >= kMostHalved) return nullptr;
    auto made = std::make_unique<CellHalves>();
    std::tie((*made)[0].box, (*made)[1].box) = halves_of(cell.box, cell.bounds.middle);
    for (SurfaceCell& half : *made)
        if (!is_outside(surface_.domain(half.box.face), half.box))
            half.bounds = bounder_->bounds(half.box.face, half.box.low, half.box.high);
    // Of threads that come at once the first one's stay.
    const CellHalves* known = nullptr;
    if (!cell.halves_.compare_exchange_strong(known, made.get(), std::memory_order_acq_rel)) return known;
    halved_.fetch_add(1, std::memory_order_relaxed);
    return made.release();
}

std::size_t CellBvh::add_groups(std::span<std::size_t> faces) {
    CellGroup group;
    if (faces.size() == 1) {
        group.leaf = true;
        group.first = faces.front();
        group.place = place_of(faces_[group.first].bounds);
        groups_.push_back(group);
        return groups_.size() - 1;
    }
    // In two at the median, along the axis in which the faces' middles spread the most.
    Vec3 low(faces_[faces.front()].bounds.middle.position), high = low;
    for (const std::size_t f : faces) {
        low = glm::min(low, faces_[f].bounds.middle.position);
        high = glm::max(high, faces_[f].bounds.middle.position);
    }
    const Vec3 size = high - low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t half = faces.size() / 2;
    std::sort(faces.begin(), faces.end(), [&](std::size_t a, std::size_t b) {
        const double p = faces_[a].bounds.middle.position[axis], q = faces_[b].bounds.middle.position[axis];
        return p != q ? p < q : a < b;
    });
    group.first = add_groups(faces.first(half));
    group.second = add_groups(faces.subspan(half));
    group.place = joined(groups_[group.first].place, groups_[group.second].place);
    groups_.push_back(group);
    return groups_.size() - 1;
}

}  // namespace trilens
