#include "camera/linear/linear_view.h"

#include <cmath>

#include "base/util/check.h"
#include "camera/linear/perspective.h"
#include "camera/linear/view_volume.h"
#include "camera/model/models.h"

namespace trilens {
namespace {

LinearView perspective_view(const CameraDescription& from, const FilmSize& film, const CameraSite& site) {
    if (!(from.near_depth >= 0)) site.reject("near", "must not be negative");
    if (!(from.far_depth > from.near_depth)) site.reject("far", "must be more than near");
    if (!std::isfinite(from.shift.x) || !std::isfinite(from.shift.y)) site.reject("shift", "is not finite");
    make_film_axes({from.eye, from.at, from.up}, site);
    PerspectiveParams params{{from.eye, from.at, from.up}, from.yfov, film.width, film.height, from.shift};
    return {make_perspective(params), from.near_depth, from.far_depth};
}

LinearView parallel_view(const CameraDescription& from, const FilmSize& film, const CameraSite& site) {
    if (!(from.ymag > 0 && std::isfinite(from.ymag))) site.reject("ymag", "must be a positive number");
    make_film_axes({from.eye, from.at, from.up}, site);
    const bool oblique = from.type == CameraType::kOblique;
    if (oblique && !(from.scale >= 0 && std::isfinite(from.scale)))
        site.reject("scale", "must be a number that is not negative");
    return {make_oblique({{from.eye, from.at, from.up},
                          2 * from.ymag,
                          oblique ? from.angle : 0,
                          oblique ? from.scale : 0,
                          film.width,
                          film.height})};
}

}  // namespace

LinearView make_linear_view(const CameraDescription& from, const FilmSize& film, const CameraSite& site) {
    if (from.type == CameraType::kPerspective) return perspective_view(from, film, site);
    if (from.type == CameraType::kViewVolume) {
        const LinearCamera camera = make_view_volume(from.view_volume, film, site);
        const DepthRange depth = depth_range(from.view_volume);
        return {camera, depth.near_depth, depth.far_depth};
    }
    TRILENS_CHECK(is_linear(from.type), "the camera is linear");
    return parallel_view(from, film, site);
}

// A linear camera as a model: a view of a picture that has several.

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
