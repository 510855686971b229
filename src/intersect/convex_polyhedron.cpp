#include "intersect/convex_polyhedron.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "base/raymesh/face_neighbours.h"
#include "intersect/patch_tree.h"

namespace trilens {
namespace {

constexpr std::size_t kMostPolyhedronFaces = 64;
constexpr double kFaceRounding = 1e-13;  // of the size: so far corners of other faces may lie before a plane
/// Hits nearer than this to an end of a stretch, or to each other, are left undecided; and how far rounding
/// moves a plane that is crossed: shares of the body's size and of its distance.
constexpr double kUndecided = 1e-11, kCrossingRounding = 1e-14;

constexpr double kNowhere = std::numeric_limits<double>::infinity();

/// Where a ray crosses the last of some planes. Each crossing is known to within rounding.
struct LastCrossing {
    double low = -kNowhere, high = -kNowhere;  // it lies between these
    std::size_t plane = 0;                     // the last by rounding
    double t = -kNowhere, off = 0;             // of that plane
    double others_high = -kNowhere;            // no other plane is crossed behind this

    void add(double at, double rounding, std::size_t number) {
        low = std::max(low, at - rounding), high = std::max(high, at + rounding);
        if (!(at > t)) {
            others_high = std::max(others_high, at + rounding);
            return;
        }
        others_high = std::max(others_high, t + off);
        plane = number, t = at, off = rounding;
    }
    bool is_sure() const { return others_high < t - off; }
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
        Plane plane{normalize_or_zero(at.normal), dot(at.position - body.middle_, at.normal), {}};
        if (plane.place < 0) {
            plane = {-plane.normal, -plane.place, {}};
            ++fronts_in;
        }
        if (!(plane.place > kFaceRounding * body.size_)) return std::nullopt;
        for (const Vec3& corner : corners)
            if (!(dot(corner - body.middle_, plane.normal) <= plane.place + kFaceRounding * body.size_))
                return std::nullopt;
        body.add_face(surface, face, plane);
    }
    if (fronts_in != 0 && fronts_in != count) return std::nullopt;
    return body;
}

/// Several faces may lie in one plane.
void ConvexPolyhedron::add_face(const Surface& surface, Id face, const Plane& in) {
    const std::vector<Vec3> corners = corners_of(surface, face);
    const auto holds = [&](const Plane& plane) {
        return std::all_of(corners.begin(), corners.end(), [&](const Vec3& corner) {
            return std::fabs(dot(corner - middle_, plane.normal) - plane.place) <= kFaceRounding * size_;
        });
    };
    auto plane = std::find_if(planes_.begin(), planes_.end(), holds);
    if (plane == planes_.end()) plane = planes_.insert(plane, in);
    if (const std::optional<FlatFace> flat = FlatFace::of(surface, face)) plane->faces.push_back({face, *flat});
}

/// A ray's way through the body: where it has crossed the last plane inwards, and, with the sign of t turned,
/// the first outwards.
struct ConvexPolyhedron::Clipped {
    LastCrossing enters, leaves;
    bool is_beside = false;  // it runs along a plane, before it
    bool is_known = true;    // it runs along none so near that rounding tells the side

    double leaves_low() const { return -leaves.high; }
    double leaves_high() const { return -leaves.low; }
    bool surely_misses() const { return is_beside || enters.low > leaves_high(); }
    bool surely_meets() const { return is_known && enters.high < leaves_low(); }
};

ConvexPolyhedron::Clipped ConvexPolyhedron::clip(const Ray& ray) const {
    const Vec3 from = ray.origin - middle_;
    const double room = kUndecided * (size_ + length(from)), slack = room / length(ray.direction);
    const double rounding = kCrossingRounding * (size_ + length(from));
    Clipped clipped;
    for (std::size_t i = 0; i < planes_.size(); ++i) {
        const Plane& plane = planes_[i];
        const double before = plane.place - dot(plane.normal, from), speed = dot(plane.normal, ray.direction);
        if (speed == 0) {
            if (before > room) continue;
            clipped.is_beside = before < -room;
            clipped.is_known = false;
            break;
        }
        const double t = before / speed, off = slack + rounding / std::fabs(speed);
        if (speed < 0)
            clipped.enters.add(t, off, i);
        else
            clipped.leaves.add(-t, off, i);
    }
    return clipped;
}

std::optional<bool> ConvexPolyhedron::meets(const Ray& ray, double t_min, double t_max) const {
    const Clipped clipped = clip(ray);
    if (clipped.surely_misses() && (clipped.is_beside || clipped.is_known)) return false;
    if (!clipped.surely_meets()) return std::nullopt;
    bool is_met = false;
    for (const auto& [low, high] : {std::pair(clipped.enters.low, clipped.enters.high),
                                    std::pair(clipped.leaves_low(), clipped.leaves_high())}) {
        const bool is_between = low > t_min && high < t_max;
        if (!is_between && !(high < t_min || low > t_max)) return std::nullopt;
        is_met = is_met || is_between;
    }
    return is_met;
}

bool ConvexPolyhedron::find_first_hit(const Ray& ray, double t_min, std::optional<SurfaceHit>& hit) const {
    const Clipped clipped = clip(ray);
    hit.reset();
    if (clipped.surely_misses() && (clipped.is_beside || clipped.is_known)) return true;
    if (!clipped.surely_meets()) return false;
    if (clipped.enters.low > t_min)
        return clipped.enters.is_sure() && find_hit(ray, planes_[clipped.enters.plane], clipped.enters.t, hit);
    if (!(clipped.enters.high < t_min)) return false;
    if (clipped.leaves_low() > t_min)
        return clipped.leaves.is_sure() &&
               find_hit(ray, planes_[clipped.leaves.plane], -clipped.leaves.t, hit);
    return clipped.leaves_high() < t_min;
}

bool ConvexPolyhedron::find_hit(const Ray& ray, const Plane& plane, double t,
                                std::optional<SurfaceHit>& hit) const {
    const Vec3 place = ray.origin + t * ray.direction;
    for (const Face& face : plane.faces) {
        const std::optional<Vec2> uv = face.flat.parameters_of(place);
        if (!uv) continue;
        SurfaceHit found{face.number, *uv, 0, face.flat.point(*uv)};
        const Vec3 way = found.point.position - ray.origin;
        const Vec3 unit = normalize_or_zero(ray.direction);
        found.t = dot(unit, way) / dot(unit, ray.direction);
        const double far = length(found.point.position) + length(ray.origin);
        if (!(length(way - found.t * ray.direction) <= kSurfaceResidual * far)) return false;
        hit = found;
        return true;
    }
    return false;
}

}  // namespace trilens
