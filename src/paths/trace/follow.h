// All paths of one ray over the exact optics: a tree of segments.
#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "paths/trace/path_world.h"
#include "shade/microfacets.h"

namespace trilens {

/// One straight stretch of a path: from an optic to what comes next.
struct PathSegment {
    Id parent = kNone;           // the segment before it; kNone: it leaves the first optic
    Step step;                   // what happened where it starts
    Path path = Path::kReflect;  // what happened at the first optic
    bool principal = true;       // see PathEnd
    Colours colours = kAllColours;
    std::uint16_t depth = 0;  // optic hits after the first, its own start among them; passing through a
                              // surface without an interface is none
    Id medium = kNone;        // the optic in whose glass it runs; kNone: in air
    Ray ray;                  // unit direction, from where it starts
    double way = 0;           // length of the path from the eye to where it starts
    Vec3 first_weight{1};     // of the light, at the first optic
    Vec3 weight{1};           // of the light for all that happened behind the first optic up to its start
    double next = std::numeric_limits<double>::infinity();  // distance to the next optic, or infinity
    // Distance to an optic that lies on an object where it is met, or infinity; the object is what is seen
    // there.
    double rest = std::numeric_limits<double>::infinity();
    // Distance to an optic that would be met after the last that is followed, or infinity: cameras see past it.
    double cut = std::numeric_limits<double>::infinity();
    bool to_mirror = false;  // the next optic is one
    bool has_start = true;   // see has_start(), of its start
    bool front = true;       // its start was met from the front
    Vec3 refraction{0};      // see Branch, at its start
    double turned = 1;       // cosine of the angle between the ray that arrived at its start and the surface
    double lobe = 0;         // see Branch, summed over the rough surfaces so far
    Hit hit;                 // where objects are asked for: the first before the next optic, t a distance
    bool ends = true;        // it meets an object, or no other optic: nothing goes on from it
};

/// The branch that a segment takes from its start; null where there is none.
const Branch* same_branch(const Branches& ways, const PathSegment& like);

/// What follow_paths leaves out of each colour, as shares of its light, summed over paths: a path of one
/// colour takes from that colour alone, so no share of one ray is above 1.
struct CutPaths {
    Vec3 faint{0};     // paths that carry less than FollowParams::least_weight
    Vec3 too_deep{0};  // paths that would meet an optic after the last that is followed: they see past it
    Vec3 lost{0};      // paths inside of more bodies at once than can be told
    // The faint ones as a share of what leaves the first optic, of the first event where that is most.
    Vec3 faint_behind{0};
};

/// The share of the colour that loses most.
inline double of_worst_colour(const Vec3& share) {
    return std::max({share.x, share.y, share.z});
}

/// Of each share the larger one, colour by colour.
inline CutPaths most_cut(const CutPaths& a, const CutPaths& b) {
    return {glm::max(a.faint, b.faint), glm::max(a.too_deep, b.too_deep), glm::max(a.lost, b.lost),
            glm::max(a.faint_behind, b.faint_behind)};
}

/// Less of a sample's light than this is not followed: half a step of 8 bits.
inline constexpr double kLeastWeight = 1.0 / 512;

struct FollowParams {
    const Tracer* objects = nullptr;     // what blocks the way; null: nothing does
    double least_weight = kLeastWeight;  // the principal paths are followed whatever they carry
    const RoughWay* rough = nullptr;     // how rough optics turn the rays; null: as smooth ones do
    // Only paths that go the way of one of these are followed, each to its end: at most kMostOnly. Empty:
    // all.
    std::span<const std::vector<Step>* const> only = {};
    static constexpr std::size_t kMostOnly = 64;
};

struct FollowedPaths {
    std::vector<PathSegment> segments;  // parents before children
    CutPaths cut;
};

/// The leg of a path before another one.
struct LegBefore {
    Id medium = kNone;
    double length = 0;
    Vec3 end{0};
    bool has_start = true;
};

/// Whether what blends on the surface where a leg starts is seen along this leg. A leg in air sees what lies
/// at both its ends, one in glass at neither, since that is outside. But on a mirror in glass both legs see
/// it, and from glass into glass, with no air between, the later one does. Legs of no length see nothing.
bool has_start(const PathWorld& world, const Step& step, Id medium, const LegBefore& before);

/// Where paths begin.
struct PathStart {
    Meeting first;      // with an optic
    double way = 0;     // from the eye to there
    Media around = {};  // the bodies that the ray is inside of before it
};

/// Follows a ray from its first meeting with an optic. Segments of depth world.max_depth meet no further
/// optic. Where an optic lies on one of world.objects, to NextOptic::touch, nothing goes on if objects are
/// asked for; else, for what would follow tells rays apart, paths go on at two such places and end at the
/// third.
FollowedPaths follow_paths(const PathWorld& world, const PathStart& start, const FollowParams& params = {});
/// The same into the memory of paths before.
void follow_paths(const PathWorld& world, const PathStart& start, const FollowParams& params,
                  FollowedPaths& followed);

/// The segments of `like` once more from another start nearby: ray, way, weight, medium, next, turned and
/// refraction of each are set again; none where the path from there has another history. Nothing is cut and
/// nothing blocks.
std::vector<std::optional<PathSegment>> repeat_paths(const PathWorld& world, const PathStart& start,
                                                     const std::vector<PathSegment>& like);

/// What a ray meets first among the optics, from a place that may lie on one of them.
struct NextOptic {
    Meeting meeting;
    double distance = 0;
    double touch = 0;  // what is met this much farther away is met at the same place
    SurfaceHit hit;
};

/// A ray that leaves an optic.
struct LeavingRay {
    Ray ray;          // unit direction
    Id from = kNone;  // the optic, whose own start is left out; kNone: none
    Media media{};    // where it runs
};

/// Among optics that are met at the same place the one with the least comes first: mirrors, then bodies that
/// the ray comes into by their front, those of the highest priority first, then those that it leaves, those
/// of the highest priority last. So there is one interface, that of the glass before with the glass behind.
constexpr std::pair<int, int> coincident_order(const PathOptic& optic, bool front) {
    if (optic.mirror) return {0, 0};
    return {front ? 1 : 2, front ? -optic.priority : optic.priority};
}

/// Optics that touch, to 1e-9 of their sizes, are met one after the other, at no distance, in the order of
/// coincident_order and then of the scene. So bodies that touch have no air between them, and light that
/// comes through a body to a mirror on it is mirrored in the body.
std::optional<NextOptic> next_optic(const PathWorld& world, const LeavingRay& leaving);

// Where a camera sees a point over one history, exactly: Newton's method on the film.

/// One question: at which film positions does the camera's ray pass through `point` after this history?
struct HistoryQuery {
    const PathWorld* world = nullptr;
    std::function<Ray(const Vec2& pixel)> camera_ray;  // exact; pixels from the film's top left
    std::function<Media(const Ray& ray)> around;       // what a ray of the camera starts in; unset: air
    std::vector<PathSegment> history;  // a chain: each segment the parent of the next; only steps, colours
                                       // and `ends` are asked, and the last one ends
    Vec3 point{0};                     // world
    bool is_direction = false;         // the point lies at infinity, in this unit direction
};

/// One image of the point.
struct HistoryImage {
    Vec2 pixel{0};
    std::vector<PathEvent> events;  // the path's meetings with optics
    double first_way = 0;           // from the eye to the first of them
    double distance = 0;            // from the last of them to the point; infinite for a direction
    /// The share of each colour of the point's light that comes to the camera this way; of a direction's
    /// without what is lost on the last ray.
    Vec3 weight{1};
    double residual = 0;  // distance from the ray to the point, scene units; sine for a direction
    /// How the pixel moves with the point: row 0 for x, row 1 for y, in pixels per scene unit, of a direction
    /// per radian across it.
    std::array<Vec3, 2> derivative{};
};

/// The image that Newton's method reaches from `start`; none where it reaches none: no such image near, or
/// paths from there with another history. What hides the image is not looked at, but for the first optic,
/// which the camera meets where it meets it first.
std::optional<HistoryImage> refine_history_image(const HistoryQuery& query, const Vec2& start);

/// A camera's ray over a history.
struct HistoryPath {
    std::vector<PathEvent> events;
    Ray exit;  // the last ray, unit
};

/// The path of the camera's ray through a film place; none where that ray has another history. Its first
/// optic it meets as the first, whatever hides it.
std::optional<HistoryPath> history_path(const HistoryQuery& query, const Vec2& pixel);

/// The image at a place where it is known to be, without a derivative; none where the camera's ray there has
/// another history, or passes the point by at more than refine_history_image lets stand.
std::optional<HistoryImage> history_image_at(const HistoryQuery& query, const Vec2& pixel);

}  // namespace trilens
