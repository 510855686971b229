// Where world points appear: directly, and by every optic on the exact surface.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/util/error.h"
#include "paths/trace/path.h"
#include "render/frame/request.h"
#include "render/shoot/shoot.h"

namespace trilens {

struct World;

/// WorldImage::off where it is not known.
inline constexpr double kUnknownOffset = std::numeric_limits<double>::infinity();

/// One place where a point appears.
struct WorldImage {
    Path path = Path::kDirect;
    Id optic = kNone;      // which of the scene's optics, counted in scene order; none for the direct path
    Id object = kNone;     // its index in Scene::meshes
    Id facet = kNone;      // of the optic's grid (of the camera's mesh for a rayMesh camera)
    Vec2 pixel{0};         // from the film's top left; a pixel's centre is at .5
    double t = 0;          // along the last ray, in units of its direction (direct: depth); of a direction
                           // infinite, as is `length`
    double length = 0;     // the same in scene units
    bool inside = false;   // on the film
    bool visible = false;  // nothing lies between the eye, the optic and the point
    bool refined = false;  // on the exact surface; else the facets' image
    // Pixels that it may lie from the exact image: 0 where refined, else kUnknownOffset: nothing is known.
    double off = 0;
    // The share of each colour of the point's light that comes this way, as pictures have it: Fresnel, tint
    // and absorption along the whole path. Where glass disperses, steps over one optic are those of its
    // `ior`, and paths over several, or to a camera without an eye or parallel rays, those of green, the only
    // colour that is then not 0.
    Vec3 weight{1};
    std::vector<Step> steps;  // the meetings with optics, the first among them; none for the direct path
    std::vector<PathEvent>
        events;  // the same with their places on the exact surfaces; empty where not refined

    /// How the pixel moves with the point: row 0 for x, row 1 for y, in pixels per scene unit; with a
    /// direction in pixels per radian. Set where `has_derivative`: images on exact surfaces, but for those on
    /// a fold.
    bool has_derivative = false;
    std::array<Vec3, 2> derivative{};

    /// How the pixel moves with the numbers that ProjectRequest::parameters names, in their order, pixels per
    /// unit of each; empty where that is not known.
    std::vector<Vec2> by_parameter;
};

/// All images of one point.
struct PointProjection {
    std::vector<WorldImage> images;
    bool complete = false;  // proven: there is no other; never for paths over several optics, so it is false
                            // where the scene may have any (maxDepth above 0, and more than one mirror sphere
                            // with the eye outside), unless a word of one event is asked for
};

/// kComplete: every part of the exact surfaces is searched or excluded. kFacets: images through the facets
/// are starting points of Newton's method, so that images which no facet has are missed; several times
/// faster.
enum class ImageSearch { kComplete, kFacets };

struct ProjectRequest {
    FrameParams frame;
    ImageSearch search = ImageSearch::kComplete;
    bool refine = true;        // kFacets: else images are left as the facets have them
    bool visibility = true;    // else `visible` stays false
    bool derivatives = false;  // of images over one optic too; the others have them anyway
    // Only images of these events, however many the scene's maxDepth follows; none direct.
    EventWord path = {};
    // JSON pointers to numbers, or arrays of them, of the scene: how images move with each; see find_numbers.
    std::vector<std::string> parameters = {};
    // Of a point: the strongest; 0: all. Of a list that was cut `complete` is false.
    std::size_t max_images = 0;
    double min_weight = 0;  // at least 0; images that carry less in every colour are left out
    // `visible` says only whether anything lies before the last optic, of images beyond the film, too:
    // objects between that (or the eye, directly) and the point hide nothing then.
    bool visible_at_optics = false;

    bool operator==(const ProjectRequest&) const = default;
};

/// The images of every point: direct, after one event at each optic and, as far as the scene has paths
/// followed (maxDepth), after several: those are found from the facets that lie on the film. Images that
/// another optic cuts off from the point are none, since light goes on there, and neither are those that
/// carry no light (weight 0). Images that the optic itself hides from the camera (the back of a closed body)
/// are left out. A list that is not complete (points near a caustic, overridden normals, kFacets) holds what
/// the facets lead to as well.
std::vector<PointProjection> project_points(const World& world, const ProjectRequest& request,
                                            std::span<const Vec3> points, const Progress& progress = {});

/// The same of points at infinity: unit directions from the scene to them. What is listed is searched for at
/// a finite distance of 1e6 times the scene's size, and then moved to where the direction itself is seen;
/// that what is proven of the one holds for the other is not.
std::vector<PointProjection> project_directions(const World& world, const ProjectRequest& request,
                                                std::span<const Vec3> directions,
                                                const Progress& progress = {});

/// Where an image was, or is thought to be.
struct ImageStart {
    std::size_t point = 0;  // index of the point that it is an image of
    std::vector<PathEvent>
        events;  // empty: the direct image; `optic`, `event`, `front`, `face` and `uv` are asked, and
                 // where a face is kNone, as those of facets' images are, nothing is found
    // About where the film shows it: of several places that may be meant the nearest is taken. None: the
    // first.
    std::optional<Vec2> pixel{};
};

/// Moves known images to where they are now: Newton's method alone, no search and nothing built for one, so
/// that a point takes microseconds (for a camera without an eye or parallel rays on the film, by exact rays,
/// for which the optics are made ready once). An image for each start, in their order; none where Newton's
/// method finds none near. `inside` is set, `visible` only says so where the request asks.
std::vector<std::optional<WorldImage>> refine_images(const World& world, const ProjectRequest& request,
                                                     std::span<const Vec3> points,
                                                     std::span<const ImageStart> starts);

}  // namespace trilens
