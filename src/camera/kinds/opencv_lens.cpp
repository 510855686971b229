#include "camera/kinds/opencv_lens.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace trilens {
namespace {

constexpr int kWaypoints = 8;   // from the principal point to the place that is looked for
constexpr int kLensSteps = 25;  // for each
constexpr double kLensAtRest = 1e-14;

std::array<double, 14> coefficients(const OpencvLens& lens) {
    std::array<double, 14> all{};
    std::copy_n(lens.distortion.begin(), std::min<std::size_t>(lens.distortion.size(), all.size()),
                all.begin());
    return all;
}

/// Columns of a projective map of the distorted plane: the tilted sensor.
Mat3 tilt(double tx, double ty) {
    const double cx = std::cos(tx), sx = std::sin(tx), cy = std::cos(ty), sy = std::sin(ty);
    const Mat3 turn =
        glm::transpose(Mat3(Vec3(cy, sy * sx, -sy * cx), Vec3(0, cx, sx), Vec3(sy, -cy * sx, cy * cx)));
    const double r13 = turn[2][0], r23 = turn[2][1], r33 = turn[2][2];
    const Mat3 onto = glm::transpose(Mat3(Vec3(r33, 0, -r13), Vec3(0, r33, -r23), Vec3(0, 0, 1)));
    return onto * turn;
}

/// A place of the plane at z = 1, distorted.
struct Distortion {
    explicit Distortion(const OpencvLens& lens) : k(coefficients(lens)), sensor(tilt(k[12], k[13])) {}

    Vec2 operator()(const Vec2& p) const {
        const auto& [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tx, ty] = k;
        const double r2 = dot(p, p);
        const double radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)));
        const Vec2 q(p.x * radial + 2 * p1 * p.x * p.y + p2 * (r2 + 2 * p.x * p.x) + r2 * (s1 + r2 * s2),
                     p.y * radial + p1 * (r2 + 2 * p.y * p.y) + 2 * p2 * p.x * p.y + r2 * (s3 + r2 * s4));
        if (tx == 0 && ty == 0) return q;
        const Vec3 tilted = sensor * Vec3(q, 1);
        return {tilted.x / tilted.z, tilted.y / tilted.z};
    }
    Mat2 jacobian(const Vec2& p) const {
        const double step = 1e-6 * (1 + std::max(std::fabs(p.x), std::fabs(p.y)));
        const Vec2 dx = ((*this)(p + Vec2(step, 0)) - (*this)(p - Vec2(step, 0))) / (2 * step);
        const Vec2 dy = ((*this)(p + Vec2(0, step)) - (*this)(p - Vec2(0, step))) / (2 * step);
        return {dx, dy};
    }

    std::array<double, 14> k;
    Mat3 sensor;
};

/// The p with distorted(p) = q, reached from `start` by steps that keep the map's orientation.
std::optional<Vec2> undistort(const Distortion& distorted, const Vec2& q, Vec2 start) {
    for (int step = 0; step < kLensSteps; ++step) {
        const Mat2 jacobian = distorted.jacobian(start);
        if (!(glm::determinant(jacobian) > 0)) return std::nullopt;
        const Vec2 by = glm::inverse(jacobian) * (q - distorted(start));
        start += by;
        if (!std::isfinite(start.x + start.y)) return std::nullopt;
        if (length(by) <= kLensAtRest * (1 + length(start))) return start;
    }
    // Rounding of the differences may keep the steps from vanishing.
    if (length(q - distorted(start)) > 1e-11 * (1 + length(q))) return std::nullopt;
    return start;
}

std::optional<Vec3> unproject_pinhole(const OpencvLens& lens, const Vec2& q) {
    const Distortion distorted(lens);
    Vec2 p(0);
    for (int k = 0; k <= kWaypoints; ++k) {
        const Vec2 way = distorted(Vec2(0)) + (1.0 * k / kWaypoints) * (q - distorted(Vec2(0)));
        const std::optional<Vec2> next = undistort(distorted, way, p);
        if (!next) return std::nullopt;
        p = *next;
    }
    if (!(glm::determinant(distorted.jacobian(p)) > 0)) return std::nullopt;
    return Vec3(p, 1);
}

double fisheye_distance(const std::array<double, 14>& k, double angle) {
    const double a2 = angle * angle;
    return angle * (1 + a2 * (k[0] + a2 * (k[1] + a2 * (k[2] + a2 * k[3]))));
}

double fisheye_slope(const std::array<double, 14>& k, double angle) {
    const double a2 = angle * angle;
    return 1 + a2 * (3 * k[0] + a2 * (5 * k[1] + a2 * (7 * k[2] + a2 * 9 * k[3])));
}

std::optional<Vec3> unproject_fisheye(const OpencvLens& lens, const Vec2& q) {
    const std::array<double, 14> k = coefficients(lens);
    const double distance = length(q);
    if (!(distance > 0)) return Vec3(0, 0, 1);
    double low = 0, high = opencv_fisheye_end(lens);
    if (distance > fisheye_distance(k, high)) return std::nullopt;
    double angle = std::min(distance, high);
    for (int step = 0; step < 200 && high - low > 0; ++step) {
        const double off = fisheye_distance(k, angle) - distance;
        (off > 0 ? high : low) = angle;
        const double newton = angle - off / fisheye_slope(k, angle);
        const double next = newton > low && newton < high ? newton : 0.5 * (low + high);
        if (std::fabs(next - angle) <= kLensAtRest) break;
        angle = next;
    }
    return Vec3(std::sin(angle) / distance * q, std::cos(angle));
}

}  // namespace

double opencv_fisheye_end(const OpencvLens& lens) {
    const std::array<double, 14> k = coefficients(lens);
    constexpr int kSteps = 4096;
    for (int i = 1; i <= kSteps; ++i) {
        const double angle = std::numbers::pi * i / kSteps;
        if (fisheye_slope(k, angle) > 0) continue;
        double low = std::numbers::pi * (i - 1) / kSteps, high = angle;
        for (int halving = 0; halving < 60; ++halving)
            (fisheye_slope(k, 0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
        return low;
    }
    return std::numbers::pi;
}

std::optional<Vec2> opencv_project(const OpencvLens& lens, const Vec3& direction) {
    Vec2 q;
    if (lens.fisheye) {
        const double across = std::hypot(direction.x, direction.y);
        if (!(across > 0) && !(direction.z > 0)) return std::nullopt;
        const double angle = std::atan2(across, direction.z);
        const double scale = across > 0 ? fisheye_distance(coefficients(lens), angle) / across : 0;
        q = scale * Vec2(direction.x, direction.y);
    } else {
        if (!(direction.z > 0)) return std::nullopt;
        q = Distortion(lens)({direction.x / direction.z, direction.y / direction.z});
    }
    return Vec2(lens.fx * q.x + lens.cx, lens.fy * q.y + lens.cy);
}

std::optional<Vec3> opencv_unproject(const OpencvLens& lens, const Vec2& at) {
    const Vec2 q((at.x - lens.cx) / lens.fx, (at.y - lens.cy) / lens.fy);
    return lens.fisheye ? unproject_fisheye(lens, q) : unproject_pinhole(lens, q);
}

}  // namespace trilens
