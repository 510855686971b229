// Looks midway between the ray's first two crossings, where the surface is farthest from what it hides.
#include "specular/self_occlusion.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace trilens {
namespace {

/// A crossing is one where ray and surface form a sine of at least this.
constexpr double kClearCrossing = 0.02;
/// Of the way to the piece: crossings this near to each other are not told apart.
constexpr double kApart = 1e-6;
/// Room for rounding, as a share of the coordinates.
constexpr double kRounding = 1e-12;
/// So many cells are compared with one piece.
constexpr int kMostCells = 64;

/// How far a cell's places lie off the plane through its middle: every way over the surface is at right
/// angles to its normals.
double thickness_of(const CellBox& box, const SurfaceBounds& bounds) {
    const Vec2 half = box.half();
    const double way = (length(bounds.middle.du) + bounds.du_radius) * half.x +
                       (length(bounds.middle.dv) + bounds.dv_radius) * half.y;
    return std::min(bounds.position_radius, bounds.normal_radius * way);
}

/// A piece of surface: within a ball, and near a plane through its middle.
struct Plate {
    Vec3 middle{0}, normal{0};
    double radius = 0, thickness = 0;
};

Plate plate_of(const CellBox& box, const SurfaceBounds& bounds) {
    return {bounds.middle.position, bounds.middle.normal, bounds.position_radius, thickness_of(box, bounds)};
}

/// How far the plate reaches from its middle along a unit vector.
double reach_along(const Plate& plate, const Vec3& axis) {
    const double off = std::min(length(axis - plate.normal), length(axis + plate.normal));
    return std::min(plate.radius, plate.thickness + plate.radius * off);
}

bool are_apart(const Plate& a, const Plate& b) {
    const Vec3 way = b.middle - a.middle;
    const double room = a.radius + b.radius;
    if (dot(way, way) > room * room) return true;
    return std::fabs(dot(way, a.normal)) > a.thickness + reach_along(b, a.normal) ||
           std::fabs(dot(way, b.normal)) > b.thickness + reach_along(a, b.normal);
}

/// Whether a point of the surface, the middle of one of its cells, lies in the plate.
bool holds(const Plate& plate, const Vec3& point) {
    const Vec3 way = point - plate.middle;
    return std::fabs(dot(way, plate.normal)) <= plate.thickness &&
           dot(way, way) <= plate.radius * plate.radius;
}

/// Compares a plate with the whole surface.
class Clearance {
  public:
    Clearance(const Surface& surface, const CellBvh& cells, const Plate& plate)
        : surface_(surface), cells_(cells), plate_(plate) {}

    bool is_clear_of(std::size_t index) {
        const CellGroup& group = cells_.groups()[index];
        const double room = plate_.radius + group.place.position_radius;
        const Vec3 way = group.place.position - plate_.middle;
        if (dot(way, way) > room * room) return true;
        if (!group.leaf) return is_clear_of(group.first) && is_clear_of(group.second);
        const SurfaceCell& face = cells_.faces()[group.first];
        return is_clear_of(face.box, face.bounds, &face);
    }

  private:
    bool is_clear_of(const CellBox& box, const SurfaceBounds& bounds, const SurfaceCell* stored) {
        if (is_outside(surface_.domain(box.face), box)) return true;
        if (are_apart(plate_, plate_of(box, bounds))) return true;
        if (bounds.is_finest || ++compared_ > kMostCells || holds(plate_, bounds.middle.position))
            return false;
        if (const CellHalves* halves = stored ? cells_.halves(*stored) : nullptr)
            return std::all_of(halves->begin(), halves->end(), [&](const SurfaceCell& half) {
                return is_clear_of(half.box, half.bounds, &half);
            });
        const auto [first, second] = halves_of(box, bounds.middle);
        return is_clear_of_fresh(first) && is_clear_of_fresh(second);
    }
    bool is_clear_of_fresh(const CellBox& box) {
        if (is_outside(surface_.domain(box.face), box)) return true;
        return is_clear_of(box, cells_.bounder()->bounds(box.face, box.low, box.high), nullptr);
    }

    const Surface& surface_;
    const CellBvh& cells_;
    const Plate plate_;
    int compared_ = 0;
};

}  // namespace

InSight SelfOcclusion::look(const Vec3& eye, const CellBox& box, const SurfaceBounds& bounds) const {
    const Plate cell = plate_of(box, bounds);
    const Ray ray{eye, cell.middle - eye};
    const double way = length(ray.direction);
    if (!(way > cell.radius)) return InSight::kUnknown;
    const auto side_of = [&](const SurfaceHit& hit) { return dot(hit.point.normal, ray.direction) / way; };
    const std::optional<SurfaceHit> first = cells_.occluder()(ray, 0);
    if (!first || first->t > 1 - kApart) return InSight::kSeen;
    const std::optional<SurfaceHit> second = cells_.occluder()(ray, first->t + kApart);
    // In at the one and out at the other: else there may be another crossing so near that it was not seen.
    if (!second || !(std::fabs(side_of(*first)) > kClearCrossing) ||
        !(side_of(*first) * side_of(*second) < 0))
        return InSight::kUnknown;

    const double at = 0.5 * (first->t + std::min(second->t, 1.0));
    const double rounding = kRounding * (way + largest_coordinate(eye));
    const Plate nearer{eye + at * ray.direction, cell.normal, at * cell.radius + rounding,
                       at * cell.thickness + rounding};
    const bool is_hidden = Clearance(surface_, cells_, nearer).is_clear_of(cells_.groups().size() - 1);
    return is_hidden ? InSight::kHidden : InSight::kUnknown;
}

}  // namespace trilens
