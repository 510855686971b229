// An image's path as a chain that Fermat's principle rules: solved from a start, and projected to the film.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "paths/trace/follow.h"
#include "render/frame/frame.h"
#include "render/world/world.h"
#include "specular/chain/path_chain.h"

namespace trilens {

/// A point of the world, or one at infinity in a direction (unit, from the scene).
struct ProjectedPoint {
    Vec3 place{0};
    bool is_direction = false;
};

/// Per event the body of glass before it and behind it; kNone: air.
struct EventMedia {
    Id before = kNone, after = kNone;
};

/// Which media a path of the camera goes through; none where they cannot be told.
std::optional<PerEvent<EventMedia>> event_media(const World& world, const Media& around,
                                                std::span<const PathEvent> events);

/// Where all paths of a camera begin: its eye, or the direction of parallel rays; none where it has neither.
std::optional<ChainEnd> chain_eye(const Camera& camera);

/// How a camera shows a place: the pixel next to `near`, and how it moves with the place (rows x, y: pixels
/// per scene unit); none where it shows it nowhere.
struct FilmPlace {
    Vec2 pixel{0};
    std::array<Vec3, 2> slope{};
};
std::optional<FilmPlace> film_place(const Camera& camera, const Vec3& place, const Vec2& near);
/// Its pixel alone.
std::optional<Vec2> film_pixel(const Camera& camera, const Vec3& place, const Vec2& near);

/// The question how the camera's ray at a place of the film goes over these steps, and where near it the
/// point is seen so, by green light where glass parts it; see refine_history_image.
HistoryQuery history_query(const World& world, const Frame& frame, std::span<const Step> steps,
                           const Vec3& point);

/// Where a path of light is looked for.
struct ChainStart {
    std::span<const PathEvent> events;  // of each the optic, what happens, the side, the face and the place
    Vec2 pixel{0};                      // about where the film shows it
    std::optional<Colours> colours{};   // whose index is taken where glass disperses; none: usual_colours()
};

/// Whose index counts where glass disperses: green's, but that of `ior` where a path has one event.
inline Colours usual_colours(std::size_t events) {
    return events > 1 ? Colours{1} : kAllColours;
}

/// The chain over a start's events, with the media that the camera's ray at its pixel meets and a point at
/// the world's origin; none for cameras whose rays meet in no eye and are not parallel, or where the media
/// cannot be told.
std::optional<PathChain> chain_from(const World& world, const Frame& frame, const ChainStart& start);

/// A path of light, and where it meets each surface.
struct SolvedChain {
    PathChain chain;
    ChainShape shape;
};

/// The path of light near a start, with the start's events on the same sides. Steps from face to face follow
/// the optics' exact surfaces.
std::optional<SolvedChain> solve_path(const World& world, const Frame& frame, const ChainStart& start,
                                      const ProjectedPoint& point);

/// The same as events on the surfaces (their points and normals set anew); and the place of the film that
/// shows it.
struct ChainImage {
    std::vector<PathEvent> events;
    FilmPlace film;
    /// How the pixel moves with the point: pixels per scene unit, of a direction per radian across it; zero
    /// at a caustic.
    std::array<Vec3, 2> derivative{};
    bool is_regular = true;  // not at a caustic
};
std::optional<ChainImage> solve_image(const World& world, const Frame& frame, const ChainStart& start,
                                      const ProjectedPoint& point);

/// The same for any camera: of one whose rays meet in no eye and are not parallel by Newton's method on the
/// film, from the start's pixel.
std::optional<ChainImage> solve_any_image(const World& world, const Frame& frame, const ChainStart& start,
                                          const ProjectedPoint& point);

/// How an image moves whose path is known.
struct ImageSensitivity {
    PerEvent<EventMedia> media;
    FilmPlace film;
    PathSensitivity path;
};
/// Of the path through a start's places as they are; none as chain_from, and where the camera does not show
/// the first of them.
std::optional<ImageSensitivity> image_sensitivity(const World& world, const Frame& frame,
                                                  const ChainStart& start, const ProjectedPoint& point);

}  // namespace trilens
