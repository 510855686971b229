// What lies between two places: objects, and optics on their exact surfaces or as facets.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "paths/trace/follow.h"
#include "render/frame/frame.h"
#include "render/project/path_images.h"
#include "render/project/project.h"
#include "render/world/world.h"
#include "scene/parameters.h"
#include "specular/path_chain.h"

namespace trilens {

/// Asks for segments from place to place, world frame. A segment is free if what it meets lies at its ends.
/// Thread-safe to read; world and frame must live longer.
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
    bool is_free_of_facets(const Ray& segment, std::size_t optic) const;
    bool is_free_of_surface(const Ray& segment, std::size_t optic) const;

    const World& world_;
    const Frame& frame_;
    bool exact_;
};

// An image's path as a chain that Fermat's principle rules: solved from a start, and projected to the film.

/// A point of the world, or one at infinity in a direction (unit, from the scene).
struct ProjectedPoint {
    Vec3 place{0};
    bool is_direction = false;
};

/// What a chain depends on beside its path: the camera, the surfaces and the glass of a scene.
struct ChainModel {
    const Scene* scene = nullptr;
    const Camera* camera = nullptr;
    std::span<const Surface* const> surfaces;  // per optic
    std::span<const Id> materials;             // per optic
};

/// Per event the body of glass before it and behind it; kNone: air.
struct EventMedia {
    Id before = kNone, after = kNone;
};

/// Which media a path of the camera goes through; none where they cannot be told.
std::optional<std::vector<EventMedia>> event_media(const World& world, const Media& around,
                                                   std::span<const PathEvent> events);

/// Where all paths of a camera begin: its eye, or the direction of parallel rays; none where it has neither.
std::optional<ChainEnd> chain_eye(const Camera& camera);

/// The chain of a path; none for cameras whose rays meet in no eye and are not parallel. Where glass
/// disperses the indices are green's, but those of its `ior` where the path has one event.
std::optional<PathChain> make_chain(const ChainModel& model, std::span<const PathEvent> events,
                                    std::span<const EventMedia> media, const ProjectedPoint& point);

/// How a camera shows a place: the pixel next to `near`, and how it moves with the place (rows x, y: pixels
/// per scene unit); none where it shows it nowhere.
struct FilmPlace {
    Vec2 pixel{0};
    std::array<Vec3, 2> slope{};
};
std::optional<FilmPlace> film_place(const Camera& camera, const Vec3& place, const Vec2& near);
/// Its pixel alone.
std::optional<Vec2> film_pixel(const Camera& camera, const Vec3& place, const Vec2& near);

/// The path of light near a start, as events on the surfaces (their points and normals set anew); and the
/// place of the film that shows it. Steps from face to face follow the optics' exact surfaces.
struct ChainImage {
    std::vector<PathEvent> events;
    FilmPlace film;
    /// How the pixel moves with the point: pixels per scene unit, of a direction per radian across it; zero
    /// at a caustic.
    std::array<Vec3, 2> derivative{};
    bool is_regular = true;  // not at a caustic
};
std::optional<ChainImage> solve_image(const World& world, const Frame& frame,
                                      std::span<const PathEvent> start, const ProjectedPoint& point,
                                      const Vec2& near);

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

/// The share of each colour that reaches a point seen directly.
Vec3 weight_of_direct(const World& world, const Frame& frame, const Ray& view, double way);

// How images move with the numbers of a scene: the implicit function theorem on Fermat's stationarity.

/// A PathSensitivity per image serves all numbers. How the law and the camera's own part move with a number,
/// both at fixed places on the surfaces, are central differences of exact evaluations of the scene a step to
/// either side: no image is searched for again. Thread-safe to read; the world must live longer.
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
