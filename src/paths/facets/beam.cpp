#include "paths/facets/one_history.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trilens {
namespace {

/// What samples leave open, as a share of what they show: of the bend of a quadratic, of what it misses the
/// centre by, and where there are corners alone of their range.
constexpr double kBendRoom = 0.25, kCentreRoom = 2, kCornersRoom = 0.25;
/// Rays that turn farther from the axis than this cosine are no beam.
constexpr double kLeastCosine = 0.25;
constexpr double kSlack = 1e-12;  // of the coordinates, for rounding

/// The hull of a quadratic over a triangle, value by value: its Bernstein coefficients, and the room about
/// them.
struct Hull {
    std::array<double, 6> value{};
    std::size_t count = 3;
    double room = 0;
};

Hull hull_with_room(const PartSamples<double>& samples) {
    Hull hull;
    const auto& c = samples.corner;
    for (std::size_t k = 0; k < 3; ++k) hull.value[k] = c[k];
    if (!samples.middle) {
        const auto [low, high] = std::minmax({c[0], c[1], c[2]});
        hull.room = kCornersRoom * (high - low);
        return hull;
    }
    const auto& m = *samples.middle;
    double bend = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const double chord = 0.5 * (c[(k + 1) % 3] + c[(k + 2) % 3]);
        hull.value[3 + k] = 2 * m[k] - chord;
        bend = std::max(bend, std::fabs(m[k] - chord));
    }
    hull.count = 6;
    hull.room = kBendRoom * bend;
    if (samples.centre) {
        const double quadratic = (4 * (m[0] + m[1] + m[2]) - (c[0] + c[1] + c[2])) / 9;
        hull.room += kCentreRoom * std::fabs(*samples.centre - quadratic);
    }
    return hull;
}

/// The same quantity of all samples.
template <typename T, typename Value>
PartSamples<double> each(const PartSamples<T>& of, const Value& value) {
    PartSamples<double> result;
    for (std::size_t k = 0; k < 3; ++k) result.corner[k] = value(of.corner[k]);
    if (of.middle) {
        result.middle.emplace();
        for (std::size_t k = 0; k < 3; ++k) (*result.middle)[k] = value((*of.middle)[k]);
    }
    if (of.centre) result.centre = value(*of.centre);
    return result;
}

template <typename T>
std::vector<T> listed(const PartSamples<T>& samples) {
    std::vector<T> all(samples.corner.begin(), samples.corner.end());
    if (samples.middle) all.insert(all.end(), samples.middle->begin(), samples.middle->end());
    if (samples.centre) all.push_back(*samples.centre);
    return all;
}

}  // namespace

Interval hull_of(const PartSamples<double>& samples) {
    const Hull hull = hull_with_room(samples);
    const auto end = hull.value.begin() + static_cast<std::ptrdiff_t>(hull.count);
    const auto [low, high] = std::minmax_element(hull.value.begin(), end);
    return {*low - hull.room, *high + hull.room};
}

std::optional<Beam> Beam::around(const PartSamples<Ray>& rays) {
    const std::vector<Ray> all = listed(rays);
    Beam beam;
    Vec3 sum(0);
    for (const Ray& ray : all) {
        beam.origin_ += ray.origin / static_cast<double>(all.size());
        sum += normalize_or_zero(ray.direction);
    }
    const Vec3 z = normalize_or_zero(sum);
    if (z == Vec3(0)) return std::nullopt;
    const Vec3 x = unit_across(z), y = cross(z, x);
    beam.axis_ = {x, y, z};
    beam.lateral_ = {x, y, (x + y) / std::sqrt(2.0), (x - y) / std::sqrt(2.0)};

    double coordinate = 0;
    beam.start_ = std::numeric_limits<double>::infinity();
    for (const Ray& ray : all) {
        const Vec3 unit = normalize_or_zero(ray.direction);
        if (!(dot(unit, z) >= kLeastCosine)) return std::nullopt;
        beam.turn_ = std::max(beam.turn_, length(unit - z));
        const Vec3 local = ray.origin - beam.origin_;
        beam.start_ = std::min(beam.start_, dot(local, z));
        beam.width_ = std::max(beam.width_, length(local));
        for (int k = 0; k < 3; ++k) coordinate = std::max(coordinate, std::fabs(ray.origin[k]));
    }
    // Directions between the samples turn as far as those of the hull, and a little more.
    beam.turn_ *= 1 + kBendRoom;
    beam.start_ -= kBendRoom * beam.width_;

    for (std::size_t d = 0; d < kDirections; ++d) {
        const Vec3& lateral = beam.lateral_[d];
        const auto slope = [&](const Ray& ray) {
            return dot(lateral, ray.direction) / dot(z, ray.direction);
        };
        const auto place = [&](const Ray& ray) {
            const Vec3 local = ray.origin - beam.origin_;
            return dot(lateral, local) - slope(ray) * dot(z, local);
        };
        const Hull at = hull_with_room(each(rays, place)), moves = hull_with_room(each(rays, slope));
        for (std::size_t i = 0; i < kMostRays; ++i) {
            const std::size_t ray = std::min(i, at.count - 1);
            beam.ray_at_[d][i] = at.value[ray];
            beam.ray_moves_[d][i] = moves.value[ray];
        }
        beam.room_[d] = {at.room + kSlack * (coordinate + beam.width_), moves.room + kSlack};
    }
    return beam;
}

/// The beam's extent in a direction over a stretch of the axis: linear in z, ray by ray.
Interval Beam::across(std::size_t direction, const Interval& along) const {
    const std::array<double, kMostRays>&at = ray_at_[direction], &moves = ray_moves_[direction];
    std::array<double, kMostRays> low, high;
    for (std::size_t i = 0; i < kMostRays; ++i) {
        const double near = at[i] + along.low * moves[i], far = at[i] + along.high * moves[i];
        low[i] = std::min(near, far);
        high[i] = std::max(near, far);
    }
    Interval result{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (std::size_t i = 0; i < kMostRays; ++i) {
        result.low = std::min(result.low, low[i]);
        result.high = std::max(result.high, high[i]);
    }
    const double room =
        room_[direction].x + std::max(std::fabs(along.low), std::fabs(along.high)) * room_[direction].y;
    return {result.low - room, result.high + room};
}

/// `extent`: of something in a direction.
template <typename Extent>
bool Beam::overlaps(const Extent& extent, double far) const {
    const Interval along = extent(axis_[2]);
    const Interval inside{std::max(along.low, start_), std::min(along.high, far)};
    if (!(inside.low <= inside.high)) return false;
    for (std::size_t d = 0; d < kDirections; ++d)
        if (!extent(lateral_[d]).meets(across(d, inside))) return false;
    return true;
}

bool Beam::may_touch(const Box& box, double far) const {
    const Vec3 middle = 0.5 * (box.low + box.high) - origin_, half = 0.5 * (box.high - box.low);
    const auto extent = [&](const Vec3& direction) {
        const double at = dot(direction, middle), reach = dot(glm::abs(direction), half);
        return Interval{at - reach, at + reach};
    };
    return overlaps(extent, far);
}

bool Beam::may_touch(const Piece& piece, double far) const {
    const auto extent = [&](const Vec3& direction) {
        Interval found{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
        for (const Vec3& corner : piece.corner) {
            const double at = dot(direction, corner - origin_);
            found.low = std::min(found.low, at - piece.stray);
            found.high = std::max(found.high, at + piece.stray);
        }
        return found;
    };
    return overlaps(extent, far);
}

/// Least squares over the points' places across the axis; level where those lie on a line.
Beam::Plane Beam::plane_through(const PartSamples<Vec3>& points) const {
    const std::vector<Vec3> all = listed(points);
    Vec3 mean(0);
    for (const Vec3& point : all) mean += point / static_cast<double>(all.size());
    double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
    for (const Vec3& point : all) {
        const Vec3 local = point - mean;
        const double x = dot(local, axis_[0]), y = dot(local, axis_[1]), z = dot(local, axis_[2]);
        xx += x * x, xy += x * y, yy += y * y, xz += x * z, yz += y * z;
    }
    const double determinant = xx * yy - xy * xy;
    Vec2 tilt(0);
    if (determinant > 1e-9 * xx * yy) tilt = Vec2(yy * xz - xy * yz, xx * yz - xy * xz) / determinant;
    Plane plane;
    plane.slope = axis_[2] - tilt.x * axis_[0] - tilt.y * axis_[1];
    plane.offset = -dot(plane.slope, mean);
    const Interval heights = hull_of(each(points, [&](const Vec3& point) { return plane.height(point); }));
    plane.room = std::max(std::fabs(heights.low), std::fabs(heights.high));
    return plane;
}

}  // namespace trilens
