#include "measure/displacement/image_query.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace trilens {

std::array<int, 2> likely_side(const PositionField& field, const FieldSample& wanted) {
    const std::size_t here = field.index(wanted.column, wanted.row),
                      below = static_cast<std::size_t>(field.width);
    if (!field.sees(here)) return {1, 1};
    const Vec3 p = field.point(here), offset = wanted.point - p;
    Vec3 du(0), dv(0);
    if (field.links[here] & PositionField::kRight)
        du = field.point(here + 1) - p;
    else if (wanted.column > 0 && (field.links[here - 1] & PositionField::kRight))
        du = p - field.point(here - 1);
    if (field.links[here] & PositionField::kDown)
        dv = field.point(here + below) - p;
    else if (wanted.row > 0 && (field.links[here - below] & PositionField::kDown))
        dv = p - field.point(here - below);
    const double a = dot(du, du), b = dot(du, dv), d = dot(dv, dv), g0 = dot(du, offset),
                 g1 = dot(dv, offset);
    return {d * g0 - b * g1 < 0 ? -1 : 1, a * g1 - b * g0 < 0 ? -1 : 1};
}

double farthest_place(const PositionField& field, const PositionField& test, const FieldSample& wanted) {
    static const double kAway[] = {0, 1, std::hypot(1.0, 1.0)};
    const SurfaceId piece = piece_of(wanted);
    const Slopes test_slopes = slopes_at(test, wanted.column, wanted.row);
    double least = std::numeric_limits<double>::infinity();
    for (int row = wanted.row - 1; row <= wanted.row + 1; ++row) {
        for (int column = wanted.column - 1; column <= wanted.column + 1; ++column) {
            if (!field.contains(column, row) || !field.shows(field.index(column, row), piece)) continue;
            const Vec3 step = wanted.point - field.point(field.index(column, row));
            const std::optional<double> there = pixels_for(test_slopes, step);
            const double away = kAway[std::abs(column - wanted.column) + std::abs(row - wanted.row)];
            // The slopes here only make it more.
            if (away + 1 + 4 * there.value_or(0) >= least) continue;
            const std::optional<double> here = pixels_for(slopes_at(field, column, row), step);
            // A single pixel next door says nothing of where it ends; one at the same place is the same spot.
            if (!here && !there && away > 0) continue;
            least = std::min(least, away + 1 + 4 * std::max(here.value_or(0), there.value_or(0)));
        }
    }
    return least;
}

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kParallel = 1e-12;  // squared sine of the angle between two slopes

std::optional<Vec3> difference(const Vec3* before, const Vec3& here, const Vec3* after) {
    if (before && after) return 0.5 * (*after - *before);
    if (after) return *after - here;
    if (before) return here - *before;
    return std::nullopt;
}

double along_one(const Vec3& slope, const Vec3& step) {
    const double part = std::abs(dot(slope, step)), square = dot(slope, slope);
    if (square > 0) return part / square;
    return step == Vec3(0) ? 0 : kInfinity;
}

double along_two(const Vec3& right, const Vec3& down, const Vec3& step) {
    if (step == Vec3(0)) return 0;
    const double a = dot(right, right), b = dot(right, down), d = dot(down, down);
    const double determinant = a * d - b * b, g0 = dot(right, step), g1 = dot(down, step);
    if (!(determinant > kParallel * a * d)) return kInfinity;
    const Vec2 pixels = Vec2(d * g0 - b * g1, a * g1 - b * g0) / determinant;
    const double off_plane = length(step - pixels.x * right - pixels.y * down);
    return glm::length(pixels) + off_plane / std::sqrt(std::max(a, d));
}

}  // namespace

Slopes slopes_at(const PositionField& field, int column, int row) {
    const std::size_t i = field.index(column, row), stride = static_cast<std::size_t>(field.width);
    const auto along = [&](std::uint8_t link, bool has_before, std::size_t step) {
        const bool before = has_before && (field.links[i - step] & link), after = field.links[i] & link;
        const Vec3 p = before ? field.point(i - step) : Vec3(0), q = after ? field.point(i + step) : Vec3(0);
        return difference(before ? &p : nullptr, field.point(i), after ? &q : nullptr);
    };
    return {along(PositionField::kRight, column > 0, 1), along(PositionField::kDown, row > 0, stride)};
}

std::optional<double> pixels_for(const Slopes& slopes, const Vec3& step) {
    if (slopes.right && slopes.down) return along_two(*slopes.right, *slopes.down, step);
    if (slopes.right) return along_one(*slopes.right, step);
    if (slopes.down) return along_one(*slopes.down, step);
    return std::nullopt;
}

namespace {

/// A row or column of pixels; pixel 0 is the one that asks.
struct EdgeLine {
    const PositionField& field;
    int column, row;
    bool is_row;

    std::size_t at(int k) const { return field.index(is_row ? column + k : column, is_row ? row : row + k); }
    /// Whether pixel k is linked with pixel k + 1.
    bool is_linked(int k) const {
        if (!field.contains(is_row ? column + k : column, is_row ? row : row + k)) return false;
        return field.links[at(k)] & (is_row ? PositionField::kRight : PositionField::kDown);
    }
    Vec3 point(int k) const { return field.point(at(k)); }
};

/// The line near one of its pixels, relative to the point that is looked for: start + s slope + s^2 / 2 bend.
struct Parabola {
    Vec3 start, slope, bend;
};

std::optional<Parabola> parabola_at(const EdgeLine& line, int k, const Vec3& point) {
    const bool before = line.is_linked(k - 1), after = line.is_linked(k);
    const Vec3 start = line.point(k) - point;
    if (before && after) {
        const Vec3 p = line.point(k - 1) - point, q = line.point(k + 1) - point;
        return Parabola{start, 0.5 * (q - p), p + q - 2.0 * start};
    }
    if (after) return Parabola{start, line.point(k + 1) - line.point(k), Vec3(0)};
    if (before) return Parabola{start, line.point(k) - line.point(k - 1), Vec3(0)};
    return std::nullopt;
}

constexpr int kSteps = 8;

/// Where the parabola comes closest to the point, -1..1 pixels from its start, by Gauss-Newton.
double closest(const Parabola& near) {
    double s = 0;
    for (int step = 0; step < kSteps; ++step) {
        const Vec3 slope = near.slope + s * near.bend;
        const double square = dot(slope, slope);
        if (!(square > 0)) return s;
        const Vec3 value = near.start + s * near.slope + 0.5 * s * s * near.bend;
        s = std::clamp(s - dot(value, slope) / square, -1.0, 1.0);
    }
    return s;
}

bool lies_on(const Parabola& near, double s, const Vec3& point) {
    const double rounding = 4 * static_cast<double>(std::numeric_limits<float>::epsilon()) * length(point);
    return length(near.start + s * near.slope + 0.5 * s * s * near.bend) <=
           kOffLine * length(near.slope) + rounding;
}

/// Walks from pixel to pixel, one way only, to the one nearest to the point.
std::optional<double> find_on_line(const EdgeLine& line, const Vec3& point) {
    int way = 0;
    for (int k = 0;;) {
        const std::optional<Parabola> near = parabola_at(line, k, point);
        if (!near) return std::nullopt;
        const double s = closest(*near);
        const int next = s > 0.5 ? 1 : s < -0.5 ? -1 : 0;
        const bool goes_on = next != 0 && way != -next && line.is_linked(next > 0 ? k : k - 1);
        if (!goes_on) {
            if (std::abs(s) >= 1 || !lies_on(*near, s, point)) return std::nullopt;
            return k + s;
        }
        way = next;
        k += next;
    }
}

}  // namespace

std::optional<Vec2> find_along_sliver(const PositionField& field, const FieldSample& wanted) {
    std::optional<Vec2> best;
    for (const bool is_row : {true, false}) {
        const std::optional<double> s =
            find_on_line({field, wanted.column, wanted.row, is_row}, wanted.point);
        if (!s || (best && glm::length(*best) <= std::abs(*s))) continue;
        best = is_row ? Vec2(*s, 0) : Vec2(0, *s);
    }
    return best;
}

}  // namespace trilens
