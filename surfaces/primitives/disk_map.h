// A disk of five squares without a singular point: a square in the middle, four sides around it.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/raymesh/surface.h"

namespace trilens {

inline constexpr double kHalfTurn = 3.14159265358979323846;

/// tan of -45 to 45 degrees with its derivatives, over a parameter 0 to 1: equal steps are nearly equal
/// angles.
struct Tangent {
    double value, first, second;
};
inline Tangent tangent(double u) {
    const double x = std::tan(kHalfTurn / 4 * (2 * u - 1));
    return {x, kHalfTurn / 2 * (1 + x * x), kHalfTurn * kHalfTurn / 2 * x * (1 + x * x)};
}
inline double inverse_tangent(double value) {
    return std::clamp(0.5 + 2 / kHalfTurn * std::atan(value), 0.0, 1.0);
}

/// A vector in the xy plane turned by whole quarter turns, exactly.
inline Vec2 quarter_turns(const Vec2& p, Id turns) {
    switch (turns % 4) {
        case 1:
            return {-p.y, p.x};
        case 2:
            return {-p.x, -p.y};
        case 3:
            return {p.y, -p.x};
        default:
            return p;
    }
}

/// The quarter turn about z in which a point lies, and which part of it, from 0 to 1, comes before it.
inline std::pair<Id, double> quarter_of(const Vec2& p) {
    const Id quarter = p.y >= 0 ? (p.x > 0 ? 0 : 1) : (p.x <= 0 ? 2 : 3);
    const Vec2 q = quarter_turns(p, 4 - quarter);
    return {quarter, std::clamp(std::atan2(q.y, q.x) / (kHalfTurn / 2), 0.0, 1.0)};
}

/// A square of half the radius (face 4) and four sides (faces 0 to 3, u outward, v around) that blend
/// linearly from its edge to the rim along one angle; side k is about the x axis, turned by k quarter turns.
class DiskMap {
  public:
    static constexpr Id kFaces = 5;
    explicit DiskMap(double radius) : rim_(radius), inner_(radius / 2) {}

    /// A point of the disk with its derivatives.
    struct Flat {
        Vec2 p, u, v, uu, uv, vv;
    };
    Flat at(Id face, const Vec2& uv) const { return face == 4 ? square(uv) : side(face, uv); }

    /// Where a point of the disk is.
    SurfaceParameter place(const Vec2& p) const {
        if (std::abs(p.x) <= inner_ && std::abs(p.y) <= inner_)
            return {4, {inverse_tangent(p.x / inner_), inverse_tangent(p.y / inner_)}};
        const Id face = std::abs(p.x) >= std::abs(p.y) ? (p.x > 0 ? 0 : 2) : (p.y > 0 ? 1 : 3);
        const Vec2 q = quarter_turns(p, 4 - face);
        const double outer = rim_ * q.x / length(q);
        return {face, {std::clamp((q.x - inner_) / (outer - inner_), 0.0, 1.0), inverse_tangent(q.y / q.x)}};
    }

    /// The faces' corners: those of the square are 0 to 3 from (-, -) counter-clockwise, those of the rim 4
    /// to 7 outside of them.
    static std::vector<std::array<Id, 4>> corners() {
        return {{1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}, {0, 4, 5, 1}, {0, 1, 2, 3}};
    }

  private:
    Flat square(const Vec2& uv) const {
        const Tangent a = tangent(uv.x), b = tangent(uv.y);
        const Vec2 x(inner_, 0), y(0, inner_), none(0);
        return {a.value * x + b.value * y, a.first * x, b.first * y, a.second * x, none, b.second * y};
    }
    Flat side(Id face, const Vec2& uv) const {
        const Tangent b = tangent(uv.y);
        const double angle = kHalfTurn / 4 * (2 * uv.y - 1), speed = kHalfTurn / 2;
        const Vec2 in(inner_, inner_ * b.value), in_v(0, inner_ * b.first), in_vv(0, inner_ * b.second);
        const Vec2 out = rim_ * Vec2(std::cos(angle), std::sin(angle));
        const Vec2 out_v = speed * quarter_turns(out, 1), out_vv = -speed * speed * out;
        const auto blend = [&uv](const Vec2& a, const Vec2& c) { return (1 - uv.x) * a + uv.x * c; };
        Flat flat{blend(in, out), out - in, blend(in_v, out_v), Vec2(0), out_v - in_v, blend(in_vv, out_vv)};
        for (Vec2* part : {&flat.p, &flat.u, &flat.v, &flat.uv, &flat.vv}) *part = quarter_turns(*part, face);
        return flat;
    }

    double rim_, inner_;
};

/// A ring in four quarters about the axes, u outward, v around: side k as of a disk.
class RingMap {
  public:
    static constexpr Id kFaces = 4;
    RingMap(double inner, double outer) : inner_(inner), wide_(outer - inner) {}

    DiskMap::Flat at(Id face, const Vec2& uv) const {
        const double angle = kHalfTurn / 4 * (2 * uv.y - 1), speed = kHalfTurn / 2;
        const Vec2 out = quarter_turns({std::cos(angle), std::sin(angle)}, face);
        const Vec2 around = speed * quarter_turns(out, 1);
        const double radius = inner_ + uv.x * wide_;
        return {radius * out, wide_ * out,    radius * around,
                Vec2(0),      wide_ * around, -radius * speed * speed * out};
    }

    SurfaceParameter place(const Vec2& p) const {
        const auto [quarter, along] = quarter_of(Vec2(p.x - p.y, p.x + p.y));
        return {quarter, {std::clamp((length(p) - inner_) / wide_, 0.0, 1.0), along}};
    }

    /// Corners of the hole are 0 to 3 from -45 degrees counter-clockwise, those of the rim 4 to 7 outside of
    /// them.
    static std::vector<std::array<Id, 4>> corners() {
        return {{0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
    }

  private:
    double inner_, wide_;
};

}  // namespace trilens
