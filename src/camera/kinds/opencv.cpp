// A calibrated camera: OpenCV's lens before a film.
#include <cmath>

#include "base/util/format.h"
#include "camera/kinds/opencv_lens.h"
#include "camera/model/models.h"

namespace trilens {
namespace {

constexpr int kChecked = 48;  // places along each edge of the film at which the lens must be one-to-one

class Opencv final : public CameraModel {
  public:
    explicit Opencv(const ModelSource& source)
        : eye_(source.from.eye), axes_(source.axes()), lens_(source.from.lens), focus_(source.focus()) {
        check_numbers(source);
        check_film(source);
        end_ = lens_.fisheye ? opencv_fisheye_end(lens_) : 0;
    }
    std::optional<Ray> ray(const Vec2& at) const override {
        const std::optional<Vec3> local = opencv_unproject(lens_, at);
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
        const std::optional<Vec3> back = opencv_unproject(lens_, pixel);
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
        const bool whole = lens_.fisheye && opencv_fisheye_end(lens_) >= 3.14159;  // beyond it lies nothing
        for (int j = 0; j <= kChecked; ++j)
            for (int i = 0; i <= kChecked; ++i) {
                const Vec2 at(source.film.width * i / kChecked, source.film.height * j / kChecked);
                if (whole || opencv_unproject(lens_, at)) continue;
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

ModelPointer make_opencv(const ModelSource& source) {
    return std::make_shared<Opencv>(source);
}

}  // namespace trilens
