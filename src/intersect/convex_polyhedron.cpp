#include "intersect/convex_polyhedron.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "base/raymesh/face_neighbours.h"

namespace trilens {
namespace {

constexpr std::size_t kMostPolyhedronFaces = 64;
constexpr double kFaceRounding = 1e-13;  // of the size: so far corners of other faces may lie before a plane
/// Hits nearer than this to an end of a stretch, or to each other, are left undecided; and how far rounding
/// moves a plane that is crossed: shares of the body's size and of its distance.
constexpr double kUndecided = 1e-11, kCrossingRounding = 1e-14;

struct PlaneCrossing {
    double low = 0, high = 0;
};

std::vector<Vec3> corners_of(const Surface& surface, Id face) {
    std::vector<Vec3> corners;
    for (const Vec2& uv : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)})
        if (surface.domain(face) == FaceDomain::kSquare || uv.x + uv.y < 2)
            corners.push_back(surface.eval_first_order(face, uv).position);
    return corners;
}

/// Whether the faces that share an edge run along it in opposite ways.
bool is_oriented(const Surface& surface) {
    std::unordered_map<Id, std::array<int, 2>>
        edges;  // along the first half of each less against it; the second
    for (Id face = 0; face < surface.face_count(); ++face)
        for (const FaceSide& side : surface.border(face).sides) {
            if (side.edge == kNone) continue;
            std::array<int, 2>& halves = edges[side.edge];
            const int way = side.reversed ? -1 : 1;
            if (side.part != FaceSide::Part::kSecondHalf) halves[0] += way;
            if (side.part != FaceSide::Part::kFirstHalf) halves[1] += way;
        }
    return std::all_of(edges.begin(), edges.end(), [](const auto& edge) {
        return edge.second == std::array<int, 2>{0, 0};
    });
}

}  // namespace

/// An oriented closed surface whose faces lie in planes that support it, all of them with their fronts out or
/// all in, covers the whole boundary of its convex hull.
std::optional<ConvexPolyhedron> ConvexPolyhedron::of(const Surface& surface) {
    const std::size_t count = surface.face_count();
    if (count < 4 || count > kMostPolyhedronFaces) return std::nullopt;
    std::vector<Vec3> corners;
    for (Id face = 0; face < count; ++face) {
        if (!surface.is_flat(face)) return std::nullopt;
        const std::vector<Vec3> some = corners_of(surface, face);
        corners.insert(corners.end(), some.begin(), some.end());
    }
    if (!is_closed(surface) || !is_oriented(surface)) return std::nullopt;
    ConvexPolyhedron body;
    for (const Vec3& corner : corners) body.middle_ += corner / static_cast<double>(corners.size());
    for (const Vec3& corner : corners) body.size_ = std::max(body.size_, length(corner - body.middle_));
    std::size_t fronts_in = 0;
    for (Id face = 0; face < count; ++face) {
        const SurfacePoint at = surface.eval_first_order(face, Vec2(0.25));
        Plane plane{normalize_or_zero(at.normal), dot(at.position - body.middle_, at.normal)};
        if (plane.place < 0) {
            plane = {-plane.normal, -plane.place};
            ++fronts_in;
        }
        if (!(plane.place > kFaceRounding * body.size_)) return std::nullopt;
        for (const Vec3& corner : corners)
            if (!(dot(corner - body.middle_, plane.normal) <= plane.place + kFaceRounding * body.size_))
                return std::nullopt;
        body.planes_.push_back(plane);
    }
    if (fronts_in != 0 && fronts_in != count) return std::nullopt;
    return body;
}

/// Where the ray crosses each plane is known to within rounding, so where it enters the body, the last of the
/// planes that it crosses inwards, and where it leaves it are intervals.
std::optional<bool> ConvexPolyhedron::meets(const Ray& ray, double t_min, double t_max) const {
    const Vec3 from = ray.origin - middle_;
    const double room = kUndecided * (size_ + length(from)), slack = room / length(ray.direction);
    const double rounding = kCrossingRounding * (size_ + length(from));
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    PlaneCrossing enters{-kInfinity, -kInfinity}, leaves{kInfinity, kInfinity};
    for (const Plane& plane : planes_) {
        const double before = plane.place - dot(plane.normal, from), speed = dot(plane.normal, ray.direction);
        if (speed == 0) {
            if (before > room) continue;
            return before < -room ? std::optional(false) : std::nullopt;
        }
        const double t = before / speed, off = slack + rounding / std::fabs(speed);
        if (speed < 0)
            enters = {std::max(enters.low, t - off), std::max(enters.high, t + off)};
        else
            leaves = {std::min(leaves.low, t - off), std::min(leaves.high, t + off)};
    }
    if (enters.low > leaves.high) return false;
    if (!(enters.high < leaves.low)) return std::nullopt;
    bool is_met = false;
    for (const PlaneCrossing& crossing : {enters, leaves}) {
        const bool is_between = crossing.low > t_min && crossing.high < t_max;
        if (!is_between && !(crossing.high < t_min || crossing.low > t_max)) return std::nullopt;
        is_met = is_met || is_between;
    }
    return is_met;
}

}  // namespace trilens
