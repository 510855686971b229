#include "measure/displacement/sliver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace trilens {
namespace {

/// A row or column of pixels; pixel 0 is the one that asks.
struct EdgeLine {
    const SeenField& field;
    int column, row;
    bool is_row;

    std::size_t at(int k) const { return field.index(is_row ? column + k : column, is_row ? row : row + k); }
    /// Whether pixel k is linked with pixel k + 1.
    bool is_linked(int k) const {
        if (!field.contains(is_row ? column + k : column, is_row ? row : row + k)) return false;
        return field.links[at(k)] & (is_row ? SeenField::kRight : SeenField::kDown);
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

std::optional<Vec2> find_along_sliver(const SeenField& field, const SeenPoint& wanted) {
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
