#include "projector/squares/square_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "projector/scene/bvh.h"

namespace trilens {
namespace {

// Shares of what a value is made of, far beyond what double arithmetic loses: what lies within is not
// decided.
constexpr double kSignSlack = 1e-11;
constexpr double kDepthSlack = 1e-8;  // beyond kDepthTie
// Below this share, the plane of a triangle says less of t than its corners do.
constexpr double kGrazing = 1e-4;
constexpr double kEndless = std::numeric_limits<double>::infinity();

struct Spread {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    void include(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    double largest() const { return std::max(std::fabs(low), std::fabs(high)); }
};

}  // namespace

SquareRays::SquareRays(const FacetRays& facet, const Vec2& low, const Vec2& high) {
    const SampleRay middle = facet.at((low + high) * 0.5);
    if (!(middle.weight > 0)) return;
    shift_ = middle.origin / middle.weight;
    middle_ray_ = middle;
    middle_ = middle.direction;
    const std::array<Vec2, 4> place{low, Vec2(high.x, low.y), high, Vec2(low.x, high.y)};
    for (std::size_t k = 0; k < 4; ++k) {
        const SampleRay ray = facet.at(place[k]);
        if (!(ray.weight > 0) || !(dot(ray.direction, middle_) > 0)) return;
        origin_[k] = ray.origin - ray.weight * shift_;
        direction_[k] = ray.direction;
        weight_[k] = ray.weight;
    }
    has_rays_ = true;
    std::size_t pair = 0;
    for (std::size_t a = 0; a < 4; ++a) {
        largest_step_ = std::max(largest_step_, length(direction_[a]));
        for (std::size_t b = a; b < 4; ++b, ++pair) {
            line_direction_[pair] = 0.5 * (weight_[b] * direction_[a] + weight_[a] * direction_[b]);
            line_moment_[pair] = 0.5 * (cross(origin_[a], direction_[b]) + cross(origin_[b], direction_[a]));
            largest_direction_ = std::max(largest_direction_, length(line_direction_[pair]));
            largest_moment_ = std::max(largest_moment_, length(origin_[a]) * length(direction_[b]) +
                                                            length(origin_[b]) * length(direction_[a]));
        }
    }
    // A point at t of a ray inside is a mean of the corner rays' points at that t: what holds for these holds
    // for it.
    add_side(middle_);
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t next = (k + 1) % 4;
        const Vec3 apart = origin_[next] / weight_[next] - origin_[k] / weight_[k];
        const Vec3 across = apart + direction_[next] / weight_[next] - direction_[k] / weight_[k];
        const Vec3 normal = cross(direction_[k], across);
        add_side(dot(normal, direction_[(k + 2) % 4]) < 0 ? -normal : normal);
    }
}

/// Where all corner rays lead to its positive side.
void SquareRays::add_side(const Vec3& normal) {
    if (side_count_ == sides_.size() || !(dot(normal, normal) > 0)) return;
    constexpr double kTurned = 1e-13;
    Side side{normal, std::numeric_limits<double>::infinity(), length(normal)};
    for (std::size_t k = 0; k < 4; ++k) {
        if (dot(normal, direction_[k]) < -kTurned * side.size * length(direction_[k])) return;
        side.offset = std::min(side.offset, dot(normal, origin_[k]) / weight_[k]);
    }
    sides_[side_count_++] = side;
}

bool SquareRays::may_meet(const Vec3& low, const Vec3& high) const {
    for (std::size_t s = 0; s < side_count_; ++s) {
        const Side& side = sides_[s];
        double most = 0, size = std::fabs(side.offset);
        for (int axis = 0; axis < 3; ++axis) {
            const double from = side.normal[axis] * (low[axis] - shift_[axis]),
                         to = side.normal[axis] * (high[axis] - shift_[axis]);
            most += std::max(from, to);
            size += std::max(std::fabs(from), std::fabs(to)) + std::fabs(side.normal[axis] * shift_[axis]);
        }
        if (most < side.offset - kSignSlack * size) return false;
    }
    return true;
}

bool SquareRays::is_outside(const std::array<Vec3, 3>& corner, double size) const {
    return std::any_of(
        sides_.begin(), sides_.begin() + static_cast<std::ptrdiff_t>(side_count_), [&](const Side& side) {
            const double most = std::max(
                {dot(side.normal, corner[0]), dot(side.normal, corner[1]), dot(side.normal, corner[2])});
            return most < side.offset - kSignSlack * (std::fabs(side.offset) + side.size * size);
        });
}

SquareMeeting::SquareMeeting(const SquareRays& rays, const std::array<Vec3, 3>& from_centre, double reach) {
    std::array<Vec3, 3> corner;
    std::array<double, 3> far;
    const double shift = length(rays.shift_);
    for (std::size_t k = 0; k < 3; ++k) {
        corner[k] = from_centre[k] - rays.shift_;
        far[k] = length(corner[k]) + kSignSlack * shift;
    }

    // Without area: never seen.
    if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) return;
    if (rays.is_outside(corner, std::max({far[0], far[1], far[2]}) + shift)) return;

    // Where along the rays: between the corners', and as the plane has it.
    Spread t;
    for (std::size_t p = 0; p < 4; ++p)
        for (const Vec3& c : corner)
            t.include(dot(rays.middle_, rays.weight_[p] * c - rays.origin_[p]) /
                      dot(rays.middle_, rays.direction_[p]));
    const Vec3 normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double area = length(corner[1] - corner[0]) * length(corner[2] - corner[0]);
    Spread along, plane;
    for (std::size_t p = 0; p < 4; ++p) {
        along.include(dot(normal, rays.direction_[p]));
        plane.include(dot(normal, rays.weight_[p] * corner[0] - rays.origin_[p]) /
                      dot(normal, rays.direction_[p]));
    }
    const double flat = kSignSlack * area * rays.largest_step_,
                 grazing = kGrazing * area * rays.largest_step_;
    orientation = along.low > flat ? 1 : along.high < -flat ? -1 : 0;
    const double slack = kDepthSlack * t.largest();
    if (along.low > grazing || along.high < -grazing) {
        t.low = std::max(t.low, plane.low);
        t.high = std::min(t.high, plane.high);
    }
    low = t.low - slack;
    high = t.high + slack;
    if (high < 0 || low > reach) return;
    clipped = low <= 0 || high >= reach;

    // On which side of the edges.
    bool before = false, behind = false;
    for (std::size_t e = 0; e < 3; ++e) {
        const std::size_t next = (e + 1) % 3;
        const Vec3 l = corner[next] - corner[e], m = cross(corner[e], corner[next]);
        Spread side;
        for (std::size_t k = 0; k < 10; ++k)
            side.include(dot(rays.line_direction_[k], m) + dot(rays.line_moment_[k], l));
        const double doubt = kSignSlack * (rays.largest_direction_ * far[e] * far[next] +
                                           rays.largest_moment_ * (far[e] + far[next]));
        if (side.low > doubt)
            before = true;
        else if (side.high < -doubt)
            behind = true;
        else
            open |= static_cast<std::uint8_t>(1u << e);
    }
    if ((before && behind) || (orientation > 0 && behind) || (orientation < 0 && before)) return;
    state = open == 0 && orientation != 0 && !clipped ? State::kWhole : State::kPartly;
}

bool SquareRays::middle_meets(const std::array<Vec3, 3>& corner) const {
    const std::optional<LineHit> hit = exact_hit(middle_ray_, corner);
    return hit && hit->t > 0;
}

void collect_triangles(const PreparedScene& scene, const Vec3& centre, const SquareRays& rays,
                       const std::function<Id(Id triangle)>& surface_of,
                       std::vector<SquareTriangle>& triangles) {
    const PreparedScene::Data& data = scene.data();
    const Bvh& bvh = data.bvh();
    std::vector<Id> stack;
    if (!bvh.nodes.empty()) stack.push_back(0);
    while (!stack.empty()) {
        const BvhNode& node = bvh.nodes[stack.back()];
        stack.pop_back();
        if (!rays.may_meet(node.box.low - centre, node.box.high - centre)) continue;
        for (Id i = node.first; i < node.first + node.count; ++i) {
            const Id at = bvh.order[i];
            const SquareTriangle triangle{
                {data.corner(0, at, centre), data.corner(1, at, centre), data.corner(2, at, centre)},
                surface_of(data.triangles[at].triangle())};
            if (SquareMeeting(rays, triangle.corner, kEndless).state != SquareMeeting::State::kMissed)
                triangles.push_back(triangle);
        }
        if (node.count > 0) continue;
        stack.push_back(node.first);
        stack.push_back(node.first + 1);
    }
}

bool are_paired(std::span<const OpenEdge> edges) {
    return std::all_of(edges.begin(), edges.end(), [&](const OpenEdge& one) {
        return std::any_of(edges.begin(), edges.end(),
                           [&](const OpenEdge& other) { return other[0] == one[1] && other[1] == one[0]; });
    });
}

namespace {

/// The triangles of a list as a square's rays meet them.
class MetTriangles {
  public:
    MetTriangles(const SquareRays& rays, double reach, std::span<const SquareTriangle> triangles)
        : rays_(rays), triangles_(triangles) {
        met_.reserve(triangles.size());
        for (const SquareTriangle& one : triangles) met_.emplace_back(rays, one.corner, reach);
    }

    /// All rays see something by this t; kEndless: some may not.
    double closed_by() const {
        double closed = kEndless;
        for (const SquareMeeting& one : met_)
            if (one.state == SquareMeeting::State::kWhole) closed = std::min(closed, one.high);
        if (closed < kEndless) return closed;
        for (std::size_t i = 0; i < met_.size(); ++i)
            if (met_[i].state != SquareMeeting::State::kMissed && rays_.middle_meets(triangles_[i].corner))
                closed = std::min(closed, closed_around(i));
        return closed;
    }

    /// Whether that triangle may be seen.
    bool is_kept(std::size_t i, double closed) const {
        return met_[i].state != SquareMeeting::State::kMissed && met_[i].low <= closed;
    }

  private:
    /// The edge as it runs where the triangle's image turns counter-clockwise.
    OpenEdge edge_of(std::size_t i, std::size_t e) const {
        const Vec3 &from = triangles_[i].corner[e], &to = triangles_[i].corner[(e + 1) % 3];
        return met_[i].orientation > 0 ? OpenEdge{from, to} : OpenEdge{to, from};
    }

    /// The triangle of the same surface on the other side of an edge; none: the image ends there, or folds.
    std::optional<std::size_t> beyond(std::size_t i, std::size_t e) const {
        const OpenEdge own = edge_of(i, e);
        for (std::size_t k = 0; k < met_.size(); ++k) {
            if (triangles_[k].surface != triangles_[i].surface || met_[k].orientation == 0) continue;
            if (met_[k].state == SquareMeeting::State::kMissed) continue;
            for (std::size_t other = 0; other < 3; ++other) {
                const OpenEdge its = edge_of(k, other);
                if (its[0] == own[1] && its[1] == own[0]) return k;
            }
        }
        return std::nullopt;
    }

    /// By which t the triangle that the middle ray meets, and those around it over every edge whose line
    /// passes the square, leave no gap: their image has no border there, so what one ray meets all rays meet.
    double closed_around(std::size_t start) const {
        constexpr std::size_t kMost = 64;
        std::vector<std::size_t> part{start};
        double high = 0;
        for (std::size_t at = 0; at < part.size(); ++at) {
            const SquareMeeting& one = met_[part[at]];
            if (one.clipped || one.orientation == 0 || part.size() > kMost) return kEndless;
            high = std::max(high, one.high);
            for (std::size_t e = 0; e < 3; ++e) {
                if (!(one.open >> e & 1)) continue;
                const std::optional<std::size_t> next = beyond(part[at], e);
                if (!next) return kEndless;
                if (std::find(part.begin(), part.end(), *next) == part.end()) part.push_back(*next);
            }
        }
        return high;
    }

    const SquareRays& rays_;
    std::span<const SquareTriangle> triangles_;
    std::vector<SquareMeeting> met_;
};

}  // namespace

SquareSight see_first(const SquareRays& rays, double reach, std::span<const SquareTriangle> triangles,
                      std::vector<SquareTriangle>& kept) {
    const MetTriangles met(rays, reach, triangles);
    SquareSight sight;
    const double closed = met.closed_by();
    sight.is_closed = closed < kEndless;
    bool one = true, any = false;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (!met.is_kept(i, closed)) continue;
        if (!any) sight.surface = triangles[i].surface;
        one = one && triangles[i].surface == sight.surface;
        any = true;
        kept.push_back(triangles[i]);
    }
    sight.is_sure = any ? one && sight.is_closed : true;
    return sight;
}

}  // namespace trilens
