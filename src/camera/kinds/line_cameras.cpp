// Cameras whose rays meet lines: pushbroom, crossed slits, general linear.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "camera/model/models.h"

namespace trilens {
namespace {

constexpr double kShearRadians = std::numbers::pi / 180;
constexpr double kLeastSine = 1e-9;  // angles below this are none

class Pushbroom final : public CameraModel {
  public:
    Pushbroom(const PushbroomCamera& kind, const ModelSource& source)
        : eye_(source.from.eye),
          travel_(kind.travel),
          axes_(source.axes()),
          film_(source.film),
          focus_(source.focus()) {
        if (!(kind.yfov > 0 && kind.yfov < 180))
            source.site.reject("yfov", "the angle must lie between 0 and 180 degrees");
        if (!is_finite_vector(travel_) ||
            !(std::fabs(dot(normalize_or_zero(travel_), axes_.right)) > kLeastSine))
            source.site.reject("travel", "has no part across the view: all columns see the same plane");
        half_height_ = std::tan(0.5 * kind.yfov * kShearRadians);
    }
    std::optional<Ray> ray(const Vec2& at) const override {
        const double height = (1 - 2 * at.y / film_.height) * half_height_;
        return Ray{eye_at(at.x / film_.width - 0.5), axes_.to_world({0, height, 1})};
    }
    std::optional<FilmImage> place(const Vec3& point, std::size_t) const override {
        const double way = dot(point - eye_, axes_.right) / dot(travel_, axes_.right);
        const Vec3 origin = eye_at(way), local = axes_.from_world(point - origin);
        if (!(local.z > 0)) return std::nullopt;
        const double y = 0.5 * (1 - local.y / local.z / half_height_) * film_.height;
        return FilmImage{{(way + 0.5) * film_.width, y}, local.z, origin};
    }
    double focus() const override { return focus_; }

  private:
    Vec3 eye_at(double way) const { return eye_ + way * travel_; }

    Vec3 eye_, travel_;
    FilmAxes axes_;
    FilmSize film_;
    double focus_, half_height_ = 1;
};

class CrossedSlits final : public CameraModel {
  public:
    CrossedSlits(const CrossedSlitsCamera& kind, const ModelSource& source)
        : slits_(kind.slits),
          at_(source.from.at),
          axes_(source.axes()),
          film_(source.film),
          window_(kind.window),
          focus_(source.focus()) {
        for (std::size_t k = 0; k < 2; ++k) {
            slits_[k].direction = normalize_or_zero(slits_[k].direction);
            if (slits_[k].direction == Vec3(0) || !is_finite_vector(slits_[k].point))
                source.site.reject("slits/" + std::to_string(k), "a slit needs a point and a direction");
        }
        const auto& [u0, u1, v0, v1] = window_;
        if (!(u0 < u1 && v0 < v1)) source.site.reject("window", "has no area");
        for (const double y : {0.0, 0.5, 1.0})
            for (const double x : {0.0, 0.5, 1.0})
                if (!ray({x * film_.width, y * film_.height}))
                    source.site.reject("slits", "leave no single ray through the window at " +
                                                    std::to_string(x) + ", " + std::to_string(y) +
                                                    " of the film");
    }
    std::optional<Ray> ray(const Vec2& at) const override {
        const auto& [u0, u1, v0, v1] = window_;
        const double u = u0 + at.x / film_.width * (u1 - u0), v = v1 - at.y / film_.height * (v1 - v0);
        return through(at_ + u * axes_.right + v * axes_.up);
    }
    std::optional<FilmImage> place(const Vec3& point, std::size_t) const override {
        const std::optional<Ray> found = through(point);
        if (!found) return std::nullopt;
        const Vec3 on_plane =
            found->origin + dot(at_ - found->origin, axes_.forward) * found->direction - at_;
        const auto& [u0, u1, v0, v1] = window_;
        const Vec2 pixel((dot(on_plane, axes_.right) - u0) / (u1 - u0) * film_.width,
                         (v1 - dot(on_plane, axes_.up)) / (v1 - v0) * film_.height);
        return FilmImage{pixel, dot(point - found->origin, axes_.forward), found->origin};
    }
    double focus() const override {
        const auto middle = ray({0.5 * film_.width, 0.5 * film_.height});
        return std::max(focus_, std::fabs(dot(at_ - middle->origin, axes_.forward)));
    }

  private:
    /// The line through the point that meets both slits; none where it is not one, or lies across the view.
    std::optional<Ray> through(const Vec3& point) const {
        const auto plane = [&](const WorldLine& slit) { return cross(slit.point - point, slit.direction); };
        const Vec3 first = plane(slits_[0]), second = plane(slits_[1]);
        const Vec3 line = cross(normalize_or_zero(first), normalize_or_zero(second));
        const double depth = dot(line, axes_.forward);
        if (!(std::fabs(depth) > kLeastSine)) return std::nullopt;
        const Vec3 direction = line / depth;

        // Where it meets the first slit: point + s * direction there.
        const Vec3 across = cross(direction, slits_[0].direction);
        if (!(dot(across, across) > kLeastSine * kLeastSine * dot(direction, direction))) return std::nullopt;
        const double s =
            dot(cross(slits_[0].point - point, slits_[0].direction), across) / dot(across, across);
        return Ray{point + s * direction, direction};
    }

    std::array<WorldLine, 2> slits_;
    Vec3 at_;
    FilmAxes axes_;
    FilmSize film_;
    std::array<double, 4> window_;
    double focus_;
};

class GeneralLinear final : public CameraModel {
  public:
    GeneralLinear(const ThreeRayCamera& kind, const ModelSource& source)
        : eye_(source.from.eye), axes_(source.axes()), focus_(source.focus()) {
        Mat3 screen(1), origins(0), directions(0);
        for (int k = 0; k < 3; ++k) {
            const PlacedRay& placed = kind.placed_rays[static_cast<std::size_t>(k)];
            const std::string field = "rays/" + std::to_string(k);
            const Vec3 unit = normalize_or_zero(placed.direction);
            if (unit == Vec3(0) || !is_finite_vector(placed.point))
                source.site.reject(field, "a ray needs a point and a direction that is not zero");
            const double depth = dot(unit, axes_.forward);
            if (!(depth > kLeastSine))
                source.site.reject(field + "/direction", "does not go the way that the camera looks");
            directions[k] = unit / depth;
            origins[k] = placed.point - dot(placed.point - eye_, axes_.forward) * directions[k];
            screen[k] = {placed.screen.x * source.film.width, placed.screen.y * source.film.height, 1};
        }
        const double area = glm::determinant(screen);
        if (!(std::fabs(area) > 1e-12 * source.film.width * source.film.height))
            source.site.reject("rays", "their places on the film lie on one line");
        const Mat3 weights = glm::inverse(screen);
        origin_ = origins * weights;
        direction_ = directions * weights;
        if (is_flat(0) && is_flat(1) && is_flat(0.5))
            source.site.reject("rays", "their combinations do not fill space: the film shows one plane");
    }
    std::optional<Ray> ray(const Vec2& at) const override {
        return Ray{origin_ * Vec3(at, 1), direction_ * Vec3(at, 1)};
    }
    std::optional<FilmImage> place(const Vec3& point, std::size_t) const override {
        const double depth = dot(point - eye_, axes_.forward);
        const Mat3 there = section(depth);
        const Vec2 x(there[0].x, there[0].y), y(there[1].x, there[1].y);
        const double area = cross(x, y);
        if (!(std::fabs(area) > 1e-12 * length(x) * length(y))) return std::nullopt;
        const Vec3 local = axes_.from_world(point - eye_);
        const Vec2 from(local.x - there[2].x, local.y - there[2].y);
        const Vec2 pixel(cross(from, y) / area, cross(x, from) / area);
        return FilmImage{pixel, depth, origin_ * Vec3(pixel, 1)};
    }
    double focus() const override { return focus_; }

  private:
    /// Film to the plane at this depth, in the film's axes: (x, y, 1) to right, up, depth.
    Mat3 section(double depth) const {
        Mat3 there = origin_ + depth * direction_;
        for (int k = 0; k < 3; ++k) there[k] = axes_.from_world(k == 2 ? there[k] - eye_ : there[k]);
        return there;
    }
    bool is_flat(double share) const {
        const Mat3 there = section(share * focus_);
        const Vec2 x(there[0].x, there[0].y), y(there[1].x, there[1].y);
        return !(std::fabs(cross(x, y)) > 1e-12 * length(x) * length(y));
    }

    Vec3 eye_;
    FilmAxes axes_;
    double focus_;
    Mat3 origin_{0}, direction_{0};  // of (x, y, 1); the direction has unit depth everywhere
};

}  // namespace

ModelPointer make_model(const PushbroomCamera& kind, const ModelSource& source) {
    return std::make_shared<Pushbroom>(kind, source);
}

ModelPointer make_model(const CrossedSlitsCamera& kind, const ModelSource& source) {
    return std::make_shared<CrossedSlits>(kind, source);
}

ModelPointer make_model(const ThreeRayCamera& kind, const ModelSource& source) {
    return std::make_shared<GeneralLinear>(kind, source);
}

}  // namespace trilens
