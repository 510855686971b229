#include "base/raymesh/face_neighbours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <unordered_map>

namespace trilens {
namespace {

int side_count(FaceDomain domain) {
    return domain == FaceDomain::kSquare ? 4 : 3;
}

Vec2 corner_uv(FaceDomain domain, int corner) {
    static constexpr std::array<Vec2, 4> kSquare{Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
    static constexpr std::array<Vec2, 3> kTriangle{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
    const auto k = static_cast<std::size_t>(corner % side_count(domain));
    return domain == FaceDomain::kSquare ? kSquare[k] : kTriangle[k];
}

/// How far inside of a side a place is, in parameters.
double inside_of(FaceDomain domain, int side, const Vec2& uv) {
    if (domain == FaceDomain::kTriangle) return side == 0 ? uv.y : side == 1 ? 1 - uv.x - uv.y : uv.x;
    return side == 0 ? uv.y : side == 1 ? 1 - uv.x : side == 2 ? 1 - uv.y : uv.x;
}

/// From the place along a side, 0 to 1, to that along its edge, and back.
double along_edge(const FaceSide& side, double s) {
    const double own = side.reversed ? 1 - s : s;
    if (side.part == FaceSide::Part::kWhole) return own;
    return 0.5 * own + (side.part == FaceSide::Part::kSecondHalf ? 0.5 : 0);
}
double along_side(const FaceSide& side, double e) {
    double own = e;
    if (side.part != FaceSide::Part::kWhole) own = 2 * e - (side.part == FaceSide::Part::kSecondHalf ? 1 : 0);
    return side.reversed ? 1 - own : own;
}

/// The step in (u, v) to the foot of a point on the tangent plane; none where there is no plane.
std::optional<Vec2> step_to_foot(const SurfacePoint& at, const Vec3& towards) {
    const Vec3 way = towards - at.position;
    const double uu = dot(at.du, at.du), uv = dot(at.du, at.dv), vv = dot(at.dv, at.dv);
    const double u = dot(at.du, way), v = dot(at.dv, way), determinant = uu * vv - uv * uv;
    const Vec2 step = Vec2(vv * u - uv * v, uu * v - uv * u) / determinant;
    return std::isfinite(step.x + step.y) ? std::optional(step) : std::nullopt;
}

/// The side by which a step leaves the face first; the place on it goes to `uv`. -1: it stays on the face.
int leaves_by(FaceDomain domain, const Vec2& step, Vec2& uv) {
    int first = -1;
    double share = 1;
    for (int side = 0; side < side_count(domain); ++side) {
        const double before = std::max(0.0, inside_of(domain, side, uv));
        const double after = inside_of(domain, side, uv + step);
        if (!(after < 0) || before / (before - after) >= share) continue;
        first = side;
        share = before / (before - after);
    }
    uv = clamped_to(domain, uv + share * step);
    return first;
}

}  // namespace

bool is_closed(const Surface& surface) {
    std::unordered_map<Id, std::array<int, 2>> edges;  // sides along the first half of each, and the second
    for (Id face = 0; face < surface.face_count(); ++face) {
        const FaceBorder border = surface.border(face);
        for (int k = 0; k < side_count(surface.domain(face)); ++k) {
            const FaceSide& side = border.sides[static_cast<std::size_t>(k)];
            if (side.edge == kNone) return false;
            std::array<int, 2>& halves = edges[side.edge];
            halves[0] += side.part != FaceSide::Part::kSecondHalf;
            halves[1] += side.part != FaceSide::Part::kFirstHalf;
        }
    }
    return !edges.empty() && std::all_of(edges.begin(), edges.end(), [](const auto& edge) {
        return edge.second == std::array<int, 2>{2, 2};
    });
}

FaceNeighbours::FaceNeighbours(const Surface& surface) : surface_(surface) {
    for (Id face = 0; face < surface.face_count(); ++face) {
        const FaceBorder border = surface.border(face);
        for (int side = 0; side < side_count(surface.domain(face)); ++side) {
            const Id edge = border.sides[static_cast<std::size_t>(side)].edge;
            if (edge != kNone) sides_.push_back({edge, face, side});
        }
    }
    std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) {
        return std::tie(a.edge, a.face, a.side) < std::tie(b.edge, b.face, b.side);
    });
}

/// The same point of space on the first other face that shares the side there.
std::optional<SurfaceParameter> FaceNeighbours::opposite(const SurfaceParameter& at, int side) const {
    const FaceDomain domain = surface_.domain(at.face);
    const FaceSide own = surface_.border(at.face).sides[static_cast<std::size_t>(side)];
    const Vec2 from = corner_uv(domain, side), along = corner_uv(domain, side + 1) - from;
    const double s = dot(at.uv - from, along) / dot(along, along);
    const double e = along_edge(own, std::clamp(s, 0.0, 1.0));
    auto other = std::lower_bound(sides_.begin(), sides_.end(), own.edge,
                                  [](const Side& one, Id edge) { return one.edge < edge; });
    for (; other != sides_.end() && other->edge == own.edge; ++other) {
        if (other->face == at.face && other->side == side) continue;
        const FaceDomain there = surface_.domain(other->face);
        const double t =
            along_side(surface_.border(other->face).sides[static_cast<std::size_t>(other->side)], e);
        if (t < 0 || t > 1) continue;  // it has the edge's other half
        const Vec2 begin = corner_uv(there, other->side);
        return SurfaceParameter{other->face,
                                clamped_to(there, begin + t * (corner_uv(there, other->side + 1) - begin))};
    }
    return std::nullopt;
}

std::optional<SurfaceParameter> FaceNeighbours::over_edge(const SurfaceParameter& at,
                                                          const Vec3& towards) const {
    SurfaceParameter place = at;
    for (int faces = 0; faces <= kMostFaces; ++faces) {
        const std::optional<Vec2> step =
            step_to_foot(surface_.eval_first_order(place.face, place.uv), towards);
        if (!step) break;
        const int side = leaves_by(surface_.domain(place.face), *step, place.uv);
        if (side < 0) break;
        const std::optional<SurfaceParameter> next =
            surface_.border(place.face).sides[static_cast<std::size_t>(side)].edge == kNone
                ? std::nullopt
                : opposite(place, side);
        if (!next) break;
        place = *next;
    }
    return place.face != at.face ? std::optional(place) : std::nullopt;
}

}  // namespace trilens
