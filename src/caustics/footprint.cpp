#include "caustics/footprint.h"

#include <algorithm>
#include <cmath>

#include "base/math/polygon.h"

namespace trilens {
namespace {

/// Corners' light may differ from the mean by so much; beyond it, at folds, the wavefront says nothing about
/// a triangle.
constexpr double kMostShare = 2;

/// A convex polygon of at most 12 corners.
template <typename Corner>
struct Polygon {
    std::array<Corner, 12> corner;
    std::size_t count = 0;

    /// Keeps what has side(corner) >= 0; `side` is affine.
    template <typename Side>
    void clip(const Side& side) {
        Polygon kept;
        for (std::size_t i = 0; i < count; ++i) {
            const Corner &a = corner[i], &b = corner[(i + 1) % count];
            const double at_a = side(a), at_b = side(b);
            if (at_a >= 0) kept.corner[kept.count++] = a;
            if ((at_a >= 0) != (at_b >= 0)) kept.corner[kept.count++] = a + (at_a / (at_a - at_b)) * (b - a);
        }
        *this = kept;
    }
};

/// Of a beam's end on the plane.
struct EndOnPlane {
    double height = 0;  // of the ray's origin over the plane
    double fall = 0;    // of its direction
};

/// Of a beam's mean light, how much falls around an end as the wavefront's spread has it.
double share_of(const BeamEnd& end, const EndOnPlane& on, double mean) {
    return end.concentration(on.height / on.fall) * on.fall / mean;
}

}  // namespace

ReceiverPlane::ReceiverPlane(const Receiver& receiver, double largest_side)
    : point(receiver.point), normal(receiver.normal) {
    std::array<Vec3, 2> side = receiver.sides;
    for (Vec3& one : side) {
        one -= dot(one, normal) * normal;
        const double size = length(one);
        if (size > largest_side && !receiver.keeps_sides) one *= largest_side / size;
    }
    const Vec3 across = cross(side[0], side[1]);
    const double area = dot(across, normal);
    const double longest = std::max(dot(side[0], side[0]), dot(side[1], side[1]));
    has_footprint = std::isfinite(longest) && std::fabs(area) > 1e-6 * longest && longest > 0;
    if (has_footprint) {
        side_s = side[0], side_t = side[1];
        dual_s = cross(side[1], normal) / area;
        dual_t = cross(normal, side[0]) / area;
        unit_area = mean_area = std::fabs(area);
        outline = receiver.outline;
        if (!outline.empty()) mean_area *= polygon_area(outline);
        reach = 0.5 * (length(side[0]) + length(side[1]));
        return;
    }
    side_s = dual_s = unit_across(normal);
    side_t = dual_t = cross(normal, dual_s);
}

void keep_light(std::array<double, 3>& share) {
    double sum = 0;
    for (double& one : share) {
        one = std::isfinite(one) ? std::clamp(one, 1 / kMostShare, kMostShare) : kMostShare;
        sum += one;
    }
    for (double& one : share) one *= 3 / sum;
}

std::optional<Vec2> place_on(const ReceiverPlane& plane, const BeamEnd& end) {
    const double height = dot(end.origin - plane.point, plane.normal),
                 fall = -dot(end.direction, plane.normal);
    if (!(height >= 0) || !(fall > kGrazingFall)) return std::nullopt;
    return plane.at(end.origin + height / fall * end.direction);
}

FallenBeams fall(const BeamCorners& beam, const ReceiverPlane& plane, double reach) {
    FallenBeams fallen;
    const auto& end = beam.end;
    std::array<EndOnPlane, 3> on;
    int whole = 0, falling = 0, above = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        on[k] = {dot(end[k]->origin - plane.point, plane.normal), -dot(end[k]->direction, plane.normal)};
        falling += on[k].fall > kGrazingFall, above += on[k].height >= 0;
        whole += on[k].fall > kGrazingFall && on[k].height >= 0;
    }
    if (falling == 0 || above == 0) return fallen;
    if (whole == 3) {
        FallenBeam& part = fallen.part[0];
        for (std::size_t k = 0; k < 3; ++k)
            part.at[k] = plane.at(end[k]->origin + on[k].height / on[k].fall * end[k]->direction);
        if (plane.has_footprint) reach += 0.5;
        for (int c = 0; c < 2; ++c)
            if (std::min({part.at[0][c], part.at[1][c], part.at[2][c]}) > reach ||
                std::max({part.at[0][c], part.at[1][c], part.at[2][c]}) < -reach)
                return fallen;
        part.measure = beam.measure;
        for (std::size_t k = 0; k < 3; ++k) part.place[k] = end[k]->place;
        const double area =
            0.5 * std::fabs(cross(part.at[1] - part.at[0], part.at[2] - part.at[0])) * plane.unit_area;
        for (std::size_t k = 0; k < 3; ++k) {
            part.light[k] = end[k]->light;
            part.share[k] = share_of(*end[k], on[k], beam.measure / area);
        }
        keep_light(part.share);
        fallen.count = 1;
        return fallen;
    }

    // In the weights of the ends, heights and falls are linear.
    Polygon<Vec3> inside;
    inside.corner = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
    inside.count = 3;
    const Vec3 heights(on[0].height, on[1].height, on[2].height), falls(on[0].fall, on[1].fall, on[2].fall);
    inside.clip([&](const Vec3& w) { return dot(w, falls) - 2 * kGrazingFall; });
    inside.clip([&](const Vec3& w) { return dot(w, heights); });
    for (std::size_t i = 1; i + 1 < inside.count && fallen.count < fallen.part.size(); ++i) {
        FallenBeam& part = fallen.part[fallen.count++];
        part.weights = {inside.corner[0], inside.corner[i], inside.corner[i + 1]};
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& w = part.weights[k];
            Vec3 origin(0), direction(0);
            for (int e = 0; e < 3; ++e) {
                const BeamEnd& of = *end[static_cast<std::size_t>(e)];
                origin += w[e] * of.origin, direction += w[e] * of.direction,
                    part.light[k] += w[e] * of.light;
            }
            part.at[k] = plane.at(origin + dot(w, heights) / dot(w, falls) * direction);
            part.place[k] = w[0] * end[0]->place + w[1] * end[1]->place + w[2] * end[2]->place;
        }
        part.measure = beam.measure * std::fabs(cross(Vec2(part.weights[1] - part.weights[0]),
                                                      Vec2(part.weights[2] - part.weights[0])));
    }
    return fallen;
}

namespace {

/// On which side of the line through two ends the plane's point lies: a point on it lies on the same side for
/// both beams that share it.
double side_of(const FallenBeam& fallen, std::size_t k) {
    const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
    const Vec2 &place_a = fallen.place[a], &place_b = fallen.place[b];
    const bool straight = place_a.x != place_b.x ? place_a.x < place_b.x : place_a.y < place_b.y;
    const double side = straight ? cross(fallen.at[a], fallen.at[b]) : -cross(fallen.at[b], fallen.at[a]);
    if (side != 0) return side;
    return straight ? 1e-300 : -1e-300;
}

double triangle_area(const FallenBeam& fallen) {
    return 0.5 * std::fabs(cross(fallen.at[1] - fallen.at[0], fallen.at[2] - fallen.at[0]));
}

std::optional<FootprintPart> part_at_point(const FallenBeam& fallen) {
    const Vec3 side(side_of(fallen, 0), side_of(fallen, 1), side_of(fallen, 2));
    const double sum = side.x + side.y + side.z, area = triangle_area(fallen);
    if (!((side.x > 0 && side.y > 0 && side.z > 0) || (side.x < 0 && side.y < 0 && side.z < 0)))
        return std::nullopt;
    if (!(area > 0)) return std::nullopt;
    return FootprintPart{fallen.measure / area, side / sum, Vec2(0)};
}

Vec3 weights_at(const FallenBeam& fallen, const Vec2& at, double twice_area) {
    const Vec2 a = fallen.at[0] - at, b = fallen.at[1] - at, c = fallen.at[2] - at;
    const Vec3 weights = Vec3(cross(b, c), cross(c, a), cross(a, b)) / twice_area;
    return glm::clamp(weights, Vec3(0), Vec3(1));
}

}  // namespace

std::optional<FootprintPart> part_at_footprint(const FallenBeam& fallen, const ReceiverPlane& plane) {
    if (!plane.has_footprint) return part_at_point(fallen);
    Polygon<Vec2> inside;
    for (const Vec2& at : fallen.at) inside.corner[inside.count++] = at;
    bool is_cut = false;
    const auto keep = [&](const auto& side) {
        bool beyond = false;
        for (std::size_t i = 0; i < inside.count; ++i) beyond = beyond || side(inside.corner[i]) < 0;
        if (!beyond) return;
        is_cut = true;
        inside.clip(side);
    };
    if (plane.outline.empty()) {
        for (int k = 0; k < 2; ++k)
            for (const double sign : {-1.0, 1.0}) keep([&](const Vec2& p) { return 0.5 - sign * p[k]; });
    } else {
        for (std::size_t i = 0; i < plane.outline.size(); ++i) {
            const Vec2 &a = plane.outline[i], &b = plane.outline[(i + 1) % plane.outline.size()];
            keep([&](const Vec2& p) { return cross(b - a, p - a); });
        }
    }
    if (inside.count < 3) return std::nullopt;
    if (!is_cut)
        return FootprintPart{fallen.measure, Vec3(1.0 / 3),
                             (fallen.at[0] + fallen.at[1] + fallen.at[2]) / 3.0};
    const double twice_area = cross(fallen.at[1] - fallen.at[0], fallen.at[2] - fallen.at[0]);
    double twice_part = 0;
    Vec2 middle(0);
    for (std::size_t i = 1; i + 1 < inside.count; ++i) {
        const Vec2 a = inside.corner[0], b = inside.corner[i], c = inside.corner[i + 1];
        const double part = cross(b - a, c - a);
        twice_part += part;
        middle += part / 3 * (a + b + c);
    }
    const double share = twice_part / twice_area;
    if (!(share > 0)) return std::nullopt;
    return FootprintPart{fallen.measure * std::min(share, 1.0),
                         weights_at(fallen, middle / twice_part, twice_area), middle / twice_part};
}

}  // namespace trilens
