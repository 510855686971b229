// All around a sphere, looking inwards.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "camera/model/models.h"

namespace trilens {
namespace {

constexpr double kLatitudeRadians = std::numbers::pi / 180;

/// Branch 0 shows what lies between the sphere and its centre, branch 1 what lies beyond the centre.
class InwardSphere final : public CameraModel {
  public:
    InwardSphere(const InwardSphereCamera& kind, const ModelSource& source)
        : center_(kind.center),
          radius_(kind.radius),
          axes_(source.axes()),
          film_(source.film),
          hfov_(kind.hfov * kLatitudeRadians),
          vfov_(kind.vfov * kLatitudeRadians) {
        if (!(radius_ > 0 && std::isfinite(radius_)))
            source.site.reject("radius", "must be a positive number");
        if (!is_finite_vector(center_)) source.site.reject("center", "is not finite");
        if (!(kind.hfov > 0 && kind.hfov <= 360))
            source.site.reject("hfov", "the angle must be more than 0 and at most 360 degrees");
        if (!(kind.vfov > 0 && kind.vfov <= 180))
            source.site.reject("vfov", "the angle must be more than 0 and at most 180 degrees");
    }
    std::optional<Ray> ray(const Vec2& at) const override {
        const double longitude = (at.x / film_.width - 0.5) * hfov_;
        const double latitude = (0.5 - at.y / film_.height) * vfov_;
        const Vec3 outward = axes_.to_world({std::cos(latitude) * std::sin(longitude), std::sin(latitude),
                                             -std::cos(latitude) * std::cos(longitude)});
        return Ray{center_ + radius_ * outward, -outward};
    }
    std::size_t branch_count() const override { return 2; }
    std::optional<FilmImage> place(const Vec3& point, std::size_t branch) const override {
        const double side = branch == 0 ? 1 : -1;
        const Vec3 local = side * axes_.from_world(point - center_);
        const double distance = length(local);
        if (!(distance > 0)) return std::nullopt;
        const double longitude = std::atan2(local.x, -local.z);
        const double latitude = std::atan2(local.y, std::hypot(local.x, local.z));
        const Vec2 pixel((longitude / hfov_ + 0.5) * film_.width, (0.5 - latitude / vfov_) * film_.height);
        const Vec3 origin = center_ + radius_ / distance * axes_.to_world(local);
        return FilmImage{pixel, radius_ - side * distance, origin};
    }
    double period() const override { return 2 * std::numbers::pi / hfov_ * film_.width; }
    double stretch(const Vec2& at) const override {
        return 1 / std::max(std::cos((0.5 - at.y / film_.height) * vfov_), 1e-9);
    }
    double focus() const override { return 0.5 * radius_; }

  private:
    Vec3 center_;
    double radius_;
    FilmAxes axes_;
    FilmSize film_;
    double hfov_, vfov_;
};

}  // namespace

ModelPointer make_model(const InwardSphereCamera& kind, const ModelSource& source) {
    return std::make_shared<InwardSphere>(kind, source);
}

}  // namespace trilens
