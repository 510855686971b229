// Detail and context: a perspective in the middle, all around it the angle grows to the film's border.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "camera/model/models.h"

namespace trilens {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180;

class DistortionDisplay final : public CameraModel {
  public:
    DistortionDisplay(const DistortionCamera& from, const ModelSource& source)
        : eye_(source.from.eye), axes_(source.axes()), film_(source.film), focus_(source.focus()) {
        const auto& [x0, y0, x1, y1] = from.detail;
        if (!(0 <= x0 && x0 < x1 && x1 <= 1 && 0 <= y0 && y0 < y1 && y1 <= 1))
            source.site.reject("detail", "is no window of the film: it is x0, y0, x1, y1 in 0..1");
        if (!(from.yfov > 0 && from.yfov < 180))
            source.site.reject("yfov", "the angle must lie between 0 and 180 degrees");
        if (!(from.context_fov > 0 && from.context_fov <= 360))
            source.site.reject("contextFov", "the angle must be more than 0 and at most 360 degrees");
        low_ = Vec2(x0 * film_.width, y0 * film_.height);
        high_ = Vec2(x1 * film_.width, y1 * film_.height);
        middle_ = 0.5 * (low_ + high_);
        focal_ = 0.5 * (high_.y - low_.y) / std::tan(0.5 * from.yfov * kRadiansPerDegree);
        context_ = 0.5 * from.context_fov * kRadiansPerDegree;
        const double corner = std::atan(0.5 * length(high_ - low_) / focal_);
        if (!(corner < context_))
            source.site.reject("contextFov", "must be more than the angle that the detail's corners see: " +
                                                 std::to_string(2 * corner / kRadiansPerDegree) + " degrees");
    }

    std::optional<Ray> ray(const Vec2& at) const override {
        const Vec2 from_middle = at - middle_;
        const double distance = length(from_middle);
        if (!(distance > 0)) return Ray{eye_, axes_.forward};
        const Vec2 way = from_middle / distance;
        const double inner = to_border(way, low_, high_);
        double angle = std::atan(distance / focal_);
        if (distance > inner) {
            const double edge = std::atan(inner / focal_), outer = film_border(way);
            angle = edge + (distance - inner) / (outer - inner) * (context_ - edge);
            if (angle > std::numbers::pi) return std::nullopt;
        }
        return Ray{eye_,
                   axes_.to_world({std::sin(angle) * way.x, -std::sin(angle) * way.y, std::cos(angle)})};
    }

    std::optional<FilmImage> place(const Vec3& point, std::size_t) const override {
        const Vec3 local = axes_.from_world(point - eye_);
        const double across = std::hypot(local.x, local.y), distance = length(local);
        if (!(distance > 0) || (across == 0 && local.z < 0)) return std::nullopt;
        if (across == 0) return FilmImage{middle_, distance, eye_};
        const Vec2 way(local.x / across, -local.y / across);
        const double angle = std::atan2(across, local.z), inner = to_border(way, low_, high_);
        const double edge = std::atan(inner / focal_);
        double reach = 0;
        if (angle <= edge) {
            reach = focal_ * std::tan(angle);
        } else {
            const double outer = film_border(way);
            if (!(outer > inner)) return std::nullopt;  // the detail goes to the film's border here
            reach = inner + (angle - edge) / (context_ - edge) * (outer - inner);
        }
        return FilmImage{middle_ + reach * way, distance, eye_};
    }

    std::optional<Vec3> eye() const override { return eye_; }
    double focus() const override { return focus_; }
    std::vector<double> breaks_x() const override { return {low_.x, high_.x}; }
    std::vector<double> breaks_y() const override { return {low_.y, high_.y}; }

  private:
    /// From the detail's middle along the unit way to the border of a rectangle around it.
    double to_border(const Vec2& way, const Vec2& low, const Vec2& high) const {
        double distance = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 2; ++k) {
            if (way[k] > 0) distance = std::min(distance, (high[k] - middle_[k]) / way[k]);
            if (way[k] < 0) distance = std::min(distance, (low[k] - middle_[k]) / way[k]);
        }
        return distance;
    }
    double film_border(const Vec2& way) const {
        return to_border(way, Vec2(0), Vec2(film_.width, film_.height));
    }

    Vec3 eye_;
    FilmAxes axes_;
    FilmSize film_;
    double focus_, focal_ = 1, context_ = 1;  // context: angle at the film's border
    Vec2 low_{0}, high_{0}, middle_{0};       // the detail's rectangle, pixels
};

}  // namespace

ModelPointer make_model(const DistortionCamera& kind, const ModelSource& source) {
    return std::make_shared<DistortionDisplay>(kind, source);
}

}  // namespace trilens
