// Ideal fisheye lenses: Kannala and Brandt, A generic camera model and calibration method for conventional,
// wide-angle, and fish-eye lenses, 2006, equations 1 to 5.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "camera/model/models.h"

namespace trilens {
namespace {

constexpr double kFisheyeRadians = std::numbers::pi / 180;

/// Distance from the film's middle of what lies at `angle` from the axis, in focal lengths.
double reach(FisheyeMapping mapping, double angle) {
    switch (mapping) {
        case FisheyeMapping::kEquidistant:
            return angle;
        case FisheyeMapping::kEquisolid:
            return 2 * std::sin(0.5 * angle);
        case FisheyeMapping::kStereographic:
            return 2 * std::tan(0.5 * angle);
        case FisheyeMapping::kOrthographic:
            return std::sin(angle);
    }
    return 0;
}

double angle_at(FisheyeMapping mapping, double distance) {
    switch (mapping) {
        case FisheyeMapping::kEquidistant:
            return distance;
        case FisheyeMapping::kEquisolid:
            return 2 * std::asin(std::min(1.0, 0.5 * distance));
        case FisheyeMapping::kStereographic:
            return 2 * std::atan(0.5 * distance);
        case FisheyeMapping::kOrthographic:
            return std::asin(std::min(1.0, distance));
    }
    return 0;
}

class Fisheye final : public CameraModel {
  public:
    Fisheye(const FisheyeCamera& kind, const ModelSource& source)
        : eye_(source.from.eye),
          axes_(source.axes()),
          mapping_(kind.mapping),
          middle_(0.5 * source.film.width, 0.5 * source.film.height),
          circle_(0.5 * std::min(source.film.width, source.film.height)),
          focus_(source.focus()) {
        const double fov = kind.fov;
        const double most = mapping_ == FisheyeMapping::kOrthographic ? 180 : 360;
        const bool open = mapping_ == FisheyeMapping::kStereographic;
        if (!(fov > 0 && (open ? fov < most : fov <= most)))
            source.site.reject("fov", mapping_ == FisheyeMapping::kOrthographic
                                          ? "an orthographic fisheye sees at most 180 degrees"
                                          : "a fisheye sees more than 0 and at most 360 degrees "
                                            "(stereographic: less)");
        focal_ = circle_ / reach(mapping_, 0.5 * fov * kFisheyeRadians);
    }

    std::optional<Ray> ray(const Vec2& at) const override {
        const Vec2 from_middle = at - middle_;
        const double distance = length(from_middle);
        if (!(distance <= circle_ * (1 + kRim))) return std::nullopt;
        const double angle = angle_at(mapping_, distance / focal_);
        const double across = distance > 0 ? std::sin(angle) / distance : 0;
        return Ray{eye_, axes_.to_world({across * from_middle.x, -across * from_middle.y, std::cos(angle)})};
    }

    std::optional<FilmImage> place(const Vec3& point, std::size_t) const override {
        const Vec3 local = axes_.from_world(point - eye_);
        const double across = std::hypot(local.x, local.y), distance = length(local);
        if (!(distance > 0)) return std::nullopt;
        const double angle = std::atan2(across, local.z);
        const bool too_far =
            mapping_ == FisheyeMapping::kOrthographic ? angle > 0.5 * std::numbers::pi : !(across > 0);
        if (too_far && !(across == 0 && local.z > 0)) return std::nullopt;
        const double scale = across > 0 ? focal_ * reach(mapping_, angle) / across : 0;
        return FilmImage{middle_ + scale * Vec2(local.x, -local.y), distance, eye_};
    }

    std::optional<Vec3> eye() const override { return eye_; }
    double focus() const override { return focus_; }

  private:
    static constexpr double kRim = 1e-12;  // share of the circle by which rounding leaves it

    Vec3 eye_;
    FilmAxes axes_;
    FisheyeMapping mapping_;
    Vec2 middle_;
    double circle_, focus_, focal_ = 1;  // pixels; focus in the world
};

}  // namespace

ModelPointer make_model(const FisheyeCamera& kind, const ModelSource& source) {
    return std::make_shared<Fisheye>(kind, source);
}

}  // namespace trilens
