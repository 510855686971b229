#include "camera/kinds/opencv.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/util/format.h"
#include "camera/model/models.h"

namespace trilens {
namespace {

constexpr int kWaypoints = 8;   // from the principal point to the place that is looked for
constexpr int kLensSteps = 25;  // for each
constexpr double kLensAtRest = 1e-14;
constexpr double kWaypointAtRest = 1e-3;  // the next one begins there

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
    explicit Distortion(const OpencvLens& lens)
        : k(coefficients(lens)),
          tilted(k[12] != 0 || k[13] != 0),
          sensor(tilted ? tilt(k[12], k[13]) : Mat3(1)) {}

    Vec2 operator()(const Vec2& p) const { return with_jacobian(p).first; }
    Mat2 jacobian(const Vec2& p) const { return with_jacobian(p).second; }

    /// Where p comes to lie, and its derivatives by p.x and p.y as columns.
    std::pair<Vec2, Mat2> with_jacobian(const Vec2& p) const {
        const auto& [k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tx, ty] = k;
        const double r2 = dot(p, p), above = 1 + r2 * (k1 + r2 * (k2 + r2 * k3)),
                     below = 1 + r2 * (k4 + r2 * (k5 + r2 * k6)), radial = above / below;
        const Vec2 q(p.x * radial + 2 * p1 * p.x * p.y + p2 * (r2 + 2 * p.x * p.x) + r2 * (s1 + r2 * s2),
                     p.y * radial + p1 * (r2 + 2 * p.y * p.y) + 2 * p2 * p.x * p.y + r2 * (s3 + r2 * s4));

        // The radial factor and the prism depend on r2 alone, whose gradient is 2 p.
        const double rise =
            (k1 + r2 * (2 * k2 + r2 * 3 * k3) - radial * (k4 + r2 * (2 * k5 + r2 * 3 * k6))) / below;
        const Vec2 by_r2 = rise * p + Vec2(s1 + 2 * s2 * r2, s3 + 2 * s4 * r2);
        const double mixed = 2 * (p1 * p.x + p2 * p.y);
        const Mat2 derivative(Vec2(radial + 2 * p1 * p.y + 6 * p2 * p.x, mixed) + 2 * p.x * by_r2,
                              Vec2(mixed, radial + 6 * p1 * p.y + 2 * p2 * p.x) + 2 * p.y * by_r2);
        if (!tilted) return {q, derivative};
        const Vec3 seen = sensor * Vec3(q, 1);
        const Vec2 at(seen.x / seen.z, seen.y / seen.z);
        const auto onto = [&](const Vec2& move) {
            const Vec3 moved = sensor * Vec3(move, 0);
            return (Vec2(moved) - moved.z * at) / seen.z;
        };
        return {at, {onto(derivative[0]), onto(derivative[1])}};
    }

    std::array<double, 14> k;
    bool tilted;
    Mat3 sensor;
};

/// The p with distorted(p) = q up to a last step of `rest`, reached from `start` by steps that keep the map's
/// orientation.
std::optional<Vec2> undistort(const Distortion& distorted, const Vec2& q, Vec2 start, double rest) {
    for (int step = 0; step < kLensSteps; ++step) {
        const auto [there, jacobian] = distorted.with_jacobian(start);
        if (!(glm::determinant(jacobian) > 0)) return std::nullopt;
        const Vec2 by = glm::inverse(jacobian) * (q - there);
        start += by;
        if (!std::isfinite(start.x + start.y)) return std::nullopt;
        if (length(by) <= rest * (1 + length(start))) return start;
    }
    // Rounding may keep the steps from vanishing.
    if (length(q - distorted(start)) > 1e-11 * (1 + length(q))) return std::nullopt;
    return start;
}

std::optional<Vec3> unproject_pinhole(const OpencvLens& lens, const Vec2& q) {
    const Distortion distorted(lens);
    const Vec2 from = distorted(Vec2(0));
    Vec2 p(0);
    for (int k = 1; k <= kWaypoints; ++k) {
        const Vec2 way = from + (1.0 * k / kWaypoints) * (q - from);
        const std::optional<Vec2> next =
            undistort(distorted, way, p, k < kWaypoints ? kWaypointAtRest : kLensAtRest);
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

std::optional<Vec3> unproject_fisheye(const OpencvLens& lens, const Vec2& q, double end) {
    const std::array<double, 14> k = coefficients(lens);
    const double distance = length(q);
    if (!(distance > 0)) return Vec3(0, 0, 1);
    double low = 0, high = end;
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

std::optional<Vec3> opencv_unproject(const OpencvLens& lens, const Vec2& at, double fisheye_end) {
    const Vec2 q((at.x - lens.cx) / lens.fx, (at.y - lens.cy) / lens.fy);
    return lens.fisheye ? unproject_fisheye(lens, q, fisheye_end) : unproject_pinhole(lens, q);
}

// A calibrated camera: OpenCV's lens before a film.

namespace {

constexpr int kChecked = 48;  // places along each edge of the film at which the lens must be one-to-one

class Opencv final : public CameraModel {
  public:
    Opencv(const OpencvLens& lens, const ModelSource& source)
        : eye_(source.from.eye), axes_(source.axes()), lens_(lens), focus_(source.focus()) {
        check_numbers(source);
        end_ = lens_.fisheye ? opencv_fisheye_end(lens_) : 0;
        check_film(source);
    }
    std::optional<Ray> ray(const Vec2& at) const override {
        const std::optional<Vec3> local = opencv_unproject(lens_, at, end_);
        if (!local) return std::nullopt;
        return Ray{eye_, axes_.to_world({local->x, -local->y, local->z})};
    }
    std::optional<FilmImage> place(const Vec3& point, std::size_t) const override {
        Vec3 local = axes_.from_world(point - eye_);
        local.y = -local.y;
        if (lens_.fisheye && std::atan2(std::hypot(local.x, local.y), local.z) > end_) return std::nullopt;
        const std::optional<Vec2> pixel = opencv_project(lens_, local);
        if (!pixel) return std::nullopt;
        // A strong lens folds back what lies far off the film.
        if (!lens_.fisheye && !is_own(local, *pixel)) return std::nullopt;
        return FilmImage{*pixel, lens_.fisheye ? length(local) : local.z, eye_};
    }
    std::optional<Vec3> eye() const override { return eye_; }
    double focus() const override { return focus_; }

  private:
    bool is_own(const Vec3& local, const Vec2& pixel) const {
        const std::optional<Vec3> back = opencv_unproject(lens_, pixel, end_);
        if (!back) return false;
        const Vec2 there(local.x / local.z, local.y / local.z);
        return length(Vec2(back->x, back->y) - there) <= 1e-6 * (1 + length(there));
    }
    void check_numbers(const ModelSource& source) const {
        for (const auto& [name, value] : {std::pair("fx", lens_.fx), std::pair("fy", lens_.fy)})
            if (!(value > 0 && std::isfinite(value)))
                source.site.reject(name, "a focal length must be a positive number of pixels");
        for (const auto& [name, value] : {std::pair("cx", lens_.cx), std::pair("cy", lens_.cy)})
            if (!std::isfinite(value)) source.site.reject(name, "is not finite");
        const std::size_t count = lens_.distortion.size();
        const bool known = lens_.fisheye ? count == 0 || count == 4
                                         : count == 0 || count == 4 || count == 5 || count == 8 ||
                                               count == 12 || count == 14;
        if (!known)
            source.site.reject("distortion", fmt::format("has {} numbers; {}", count,
                                                         lens_.fisheye ? "the fisheye model has 4, or none"
                                                                       : "the pinhole model has 4, 5, 8, 12 "
                                                                         "or 14, or none"));
        for (const double value : lens_.distortion)
            if (!std::isfinite(value)) source.site.reject("distortion", "is not finite");
    }
    void check_film(const ModelSource& source) const {
        const bool whole = lens_.fisheye && end_ >= 3.14159;  // beyond it lies nothing
        for (int j = 0; j <= kChecked; ++j)
            for (int i = 0; i <= kChecked; ++i) {
                const Vec2 at(source.film.width * i / kChecked, source.film.height * j / kChecked);
                if (whole || opencv_unproject(lens_, at, end_)) continue;
                source.site.reject(
                    "distortion",
                    fmt::format("the lens is not one-to-one in the film: no direction is shown at pixel "
                                "{:.1f}, {:.1f}, or two are on the way there from the principal point",
                                at.x, at.y));
            }
    }

    Vec3 eye_;
    FilmAxes axes_;
    OpencvLens lens_;
    double focus_, end_ = 0;
};

}  // namespace

ModelPointer make_model(const OpencvLens& kind, const ModelSource& source) {
    return std::make_shared<Opencv>(kind, source);
}

}  // namespace trilens
