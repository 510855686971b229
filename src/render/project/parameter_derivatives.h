// How images move with the numbers of a scene: the implicit function theorem on Fermat's stationarity.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/project/image_chain.h"
#include "render/project/project.h"
#include "scene/parameters.h"

namespace trilens {

/// Along a path of light the law F(u, theta) = 0 holds, where u are the places on the surfaces and theta is a
/// number of the scene. So du / dtheta = -A^-1 dF/dtheta with the path's Hessian A, and the image moves by
/// what the camera makes of it. A is solved for once per image, for all numbers. dF/dtheta and the camera's
/// own part, both at fixed u, are central differences of exact evaluations of the scene a step to either
/// side: no image is searched for again. Thread-safe to read; the world must live longer.
class ParameterDerivatives {
  public:
    /// `camera`: the frame's, index into Scene::cameras. `pointers`: as find_numbers has them. Throws
    /// InputError where one names no number, or a number that may not change by a little.
    ParameterDerivatives(const World& world, const Frame& frame, std::size_t camera,
                         std::span<const std::string> pointers);
    ~ParameterDerivatives();

    /// One per column of what `of` returns.
    const std::vector<SceneNumber>& numbers() const { return numbers_; }

    /// Per number how the image's pixel moves with it, in pixels per unit of the number; empty where that is
    /// not known: facets' images, those at a caustic, and cameras without an eye or parallel rays.
    std::vector<Vec2> of(const WorldImage& image, const ProjectedPoint& point) const;

  private:
    struct Model;
    struct Step {
        std::unique_ptr<Model> before, after;
        double size = 0;  // from one to the other
    };

    std::vector<Vec2> of_direct(const Vec2& pixel, const ProjectedPoint& point) const;
    std::vector<Vec2> of_chain(const WorldImage& image, const ProjectedPoint& point) const;

    const World& world_;
    const CameraMedia& camera_media_;
    std::vector<SceneNumber> numbers_;
    std::vector<Step> steps_;
    std::unique_ptr<Model> now_;
    double size_ = 1;  // of the optics and the eye about them
};

}  // namespace trilens
