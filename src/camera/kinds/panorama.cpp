// Cylindrical and spherical panoramas.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "camera/model/models.h"

namespace trilens {
namespace {

constexpr double kPanoramaRadians = std::numbers::pi / 180;

/// What both share: longitude across the film.
class Panorama : public CameraModel {
  public:
    Panorama(double hfov, const ModelSource& source)
        : eye_(source.from.eye),
          axes_(source.axes()),
          film_(source.film),
          hfov_(hfov * kPanoramaRadians),
          focus_(source.focus()) {
        if (!(hfov > 0 && hfov <= 360))
            source.site.reject("hfov", "the angle must be more than 0 and at most 360 degrees");
    }
    std::optional<Vec3> eye() const override { return eye_; }
    double period() const override { return 2 * std::numbers::pi / hfov_ * film_.width; }
    double focus() const override { return focus_; }

  protected:
    double longitude(double x) const { return (x / film_.width - 0.5) * hfov_; }
    double x_of(const Vec3& local) const {
        return (std::atan2(local.x, local.z) / hfov_ + 0.5) * film_.width;
    }

    Vec3 eye_;
    FilmAxes axes_;
    FilmSize film_;
    double hfov_, focus_;
};

class Cylindrical final : public Panorama {
  public:
    Cylindrical(const CylindricalCamera& kind, const ModelSource& source) : Panorama(kind.hfov, source) {
        if (!(kind.yfov > 0 && kind.yfov < 180))
            source.site.reject("yfov", "the angle must lie between 0 and 180 degrees");
        half_height_ = std::tan(0.5 * kind.yfov * kPanoramaRadians);
    }
    std::optional<Ray> ray(const Vec2& at) const override {
        const double angle = longitude(at.x), height = (1 - 2 * at.y / film_.height) * half_height_;
        return Ray{eye_, axes_.to_world({std::sin(angle), height, std::cos(angle)})};
    }
    std::optional<FilmImage> place(const Vec3& point, std::size_t) const override {
        const Vec3 local = axes_.from_world(point - eye_);
        const double distance = std::hypot(local.x, local.z);
        if (!(distance > 0)) return std::nullopt;
        const double y = 0.5 * (1 - local.y / distance / half_height_) * film_.height;
        return FilmImage{{x_of(local), y}, distance, eye_};
    }

  private:
    double half_height_ = 1;  // tangent of half the vertical angle
};

class Spherical final : public Panorama {
  public:
    Spherical(const SphericalCamera& kind, const ModelSource& source)
        : Panorama(kind.hfov, source), vfov_(kind.vfov * kPanoramaRadians) {
        if (!(kind.vfov > 0 && kind.vfov <= 180))
            source.site.reject("vfov", "the angle must be more than 0 and at most 180 degrees");
    }
    std::optional<Ray> ray(const Vec2& at) const override {
        const double angle = longitude(at.x), latitude = (0.5 - at.y / film_.height) * vfov_;
        const double across = std::cos(latitude);
        return Ray{eye_,
                   axes_.to_world({across * std::sin(angle), std::sin(latitude), across * std::cos(angle)})};
    }
    std::optional<FilmImage> place(const Vec3& point, std::size_t) const override {
        const Vec3 local = axes_.from_world(point - eye_);
        const double distance = length(local), across = std::hypot(local.x, local.z);
        if (!(distance > 0)) return std::nullopt;
        const double y = (0.5 - std::atan2(local.y, across) / vfov_) * film_.height;
        return FilmImage{{x_of(local), y}, distance, eye_};
    }
    double stretch(const Vec2& at) const override {
        return 1 / std::max(std::cos((0.5 - at.y / film_.height) * vfov_), 1e-9);
    }

  private:
    double vfov_;
};

}  // namespace

ModelPointer make_model(const CylindricalCamera& kind, const ModelSource& source) {
    return std::make_shared<Cylindrical>(kind, source);
}

ModelPointer make_model(const SphericalCamera& kind, const ModelSource& source) {
    return std::make_shared<Spherical>(kind, source);
}

}  // namespace trilens
