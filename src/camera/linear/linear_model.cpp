// A linear camera as a model: a view of a picture that has several.
#include "camera/linear/linear_view.h"
#include "camera/linear/perspective.h"
#include "camera/model/models.h"

namespace trilens {
namespace {

class LinearModel final : public CameraModel {
  public:
    explicit LinearModel(const ModelSource& source)
        : view_(make_linear_view(source.from, source.film, source.site)),
          focus_(source.from.type == CameraType::kViewVolume ? std::fabs(source.from.view_volume.prp.z)
                                                             : source.focus()) {}
    std::optional<Ray> ray(const Vec2& at) const override {
        Ray ray = film_ray(view_.camera, at);
        ray.origin += view_.near_depth * ray.direction;
        return ray;
    }
    std::optional<FilmImage> place(const Vec3& point, std::size_t) const override {
        const Vec3 screen = screen_from_world(view_.camera, point);
        if (!(screen.z > 0)) return std::nullopt;
        const Vec2 pixel = Vec2(screen.x, screen.y) / screen.z;
        const Ray there = *ray(pixel);
        const double t = dot(point - there.origin, there.direction) / dot(there.direction, there.direction);
        return FilmImage{pixel, t, there.origin};
    }
    std::optional<Vec3> eye() const override {
        if (view_.camera.parallel) return std::nullopt;
        return view_.camera.eye;
    }
    double focus() const override { return focus_; }

  private:
    LinearView view_;
    double focus_;
};

}  // namespace

ModelPointer make_linear_model(const ModelSource& source) {
    return std::make_shared<LinearModel>(source);
}

}  // namespace trilens
