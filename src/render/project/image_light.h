// What lies between two places: objects, and optics on their exact surfaces or as facets.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/util/parallel.h"
#include "paths/trace/follow.h"
#include "render/frame/frame.h"
#include "render/frame/image_chain.h"
#include "render/project/path_images.h"
#include "render/project/project.h"
#include "render/world/world.h"
#include "scene/parameters.h"

namespace trilens {

/// Asks for segments from place to place, world frame, however far. A segment is free if what it meets lies
/// at its ends. Thread-safe to read; world and frame must live longer.
class OcclusionQueries {
  public:
    /// `exact`: optics are their exact surfaces, else the frame's facets.
    OcclusionQueries(const World& world, const Frame& frame, bool exact)
        : world_(world), frame_(frame), exact_(exact) {}

    bool is_free_of_objects(const Vec3& from, const Vec3& to) const;
    bool is_free_of_optic(const Vec3& from, const Vec3& to, std::size_t optic) const;

    /// Whether nothing at all lies between the camera and a place. `on_facet`: the optic on whose facet the
    /// place lies, off the exact surface: that optic is its facets then; kNone: there is none.
    bool sees(const Vec3& from, const Vec3& to, Id on_facet = kNone) const;

    /// Whether light that leaves an optic at `from` comes to `to` without meeting another, or the same once
    /// more; `on_facet` as above, of `from`.
    bool goes_straight(const Vec3& from, const Vec3& to, Id on_facet = kNone) const;

  private:
    double after_start(const Ray& segment) const;
    bool is_free_of_facets(const Ray& segment, std::size_t optic) const;
    bool is_free_of_surface(const Ray& segment, std::size_t optic) const;

    const World& world_;
    const Frame& frame_;
    bool exact_;
    Lazy<double> size_;  // of what may hide something
};

// How much of a point's light an image carries: Fresnel, tint and absorption along its whole path.

/// How light comes from a point over one optic to the camera.
struct OneEventWay {
    Id optic = kNone;
    Path path = Path::kReflect;
    Ray view;           // the camera's, from where its rays start
    Vec3 from{0};       // on the optic
    bool front = true;  // the camera sees its front there
    Vec3 point{0};
};

/// The share of each colour of the point's light that comes to the camera over one optic, as pictures have
/// it. The angle of incidence is that of the law: at half of the angle between both stretches, or by Snell.
Vec3 weight_over_one(const World& world, const Frame& frame, const OneEventWay& way);

/// How light comes from a point over any optics to the camera.
struct EventsWay {
    Media around;                       // what the camera's ray starts in
    Vec3 start{0};                      // where
    std::span<const PathEvent> events;  // with their places and normals
    Vec3 point{0};
    // Per event the colours that go on, where glass parts them; empty: the middle one, if it does.
    std::span<const Colours> colours{};
};

/// The share of each colour that comes this way; none where light cannot part so. Of `paths` no surface is
/// asked.
std::optional<Vec3> weight_over_several(const PathWorld& paths, const EventsWay& way);

/// The share of each colour that reaches a point seen directly.
Vec3 weight_of_direct(const World& world, const Frame& frame, const Ray& view, double way);

// How images move with the numbers of a scene: the implicit function theorem on Fermat's stationarity.

/// A PathSensitivity per image serves all numbers. How surfaces, glass and the camera move with a number, at
/// fixed places on the surfaces, are central differences of a scene a step to either side: no image is
/// searched for again. Thread-safe to read; world and frame must live longer.
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
    /// not known: facets' images and those at a caustic; through a camera without an eye or parallel rays
    /// also those over normals that are not their surface's.
    std::vector<Vec2> of(const WorldImage& image, const ProjectedPoint& point) const;
    /// The same of an image over optics whose image_sensitivity() is known.
    std::vector<Vec2> of(const WorldImage& image, const ImageSensitivity& sensitivity) const;

  private:
    struct Step;

    std::vector<Vec2> of_direct(const Vec2& pixel, const ProjectedPoint& point) const;
    std::vector<Vec2> of_film(const WorldImage& image, const ProjectedPoint& point) const;

    const World& world_;
    const Frame& frame_;
    std::vector<SceneNumber> numbers_;
    std::vector<Step> steps_;
    double size_ = 1;  // of the optics and the eye about them
};

}  // namespace trilens
