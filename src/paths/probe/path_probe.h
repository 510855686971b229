// How much longer than the eye's a corner ray is after optics.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <initializer_list>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "paths/trace/follow.h"

namespace trilens {

/// The ray scale: the cube root of the solid angle that a bundle of rays has before optics, > 0, over that
/// which it has after them, >= 0 (mathematics, section 6); within 1/50 and 50, for a fold of the directions,
/// or a focus of the bundle, would make corner rays endless or nothing.
inline double ray_scale_of(double before, double after) {
    constexpr double kMostRayScale = 50;
    return after > 0 ? std::clamp(std::cbrt(before / after), 1 / kMostRayScale, kMostRayScale) : kMostRayScale;
}

// Traces the exact paths of the camera ray through one point of a facet (a probe).

/// A camera as facets ask it.
struct PathCamera {
    bool parallel = false;  // its directions are unit, whatever they lead to
    bool affine = false;    // it is not linear: screen positions are (x, y, 1), and `screen` is not asked
    /// Homogeneous screen position of a world point, as RayMesh::screen.
    std::function<Vec3(const Vec3& point)> screen;
    /// The world point of a homogeneous screen position (w the depth): screen's inverse.
    std::function<Vec3(const Vec3& screen)> point;
    /// The camera's ray through a homogeneous screen position whose point on the facet is `chord`; unless
    /// parallel, origin + direction lies at the chord's point or, for a camera that is not linear, near it.
    std::function<Ray(const Vec3& screen, const Vec3& chord)> ray;
    Vec2 film{0};  // its size in pixels; nothing off it is seen
    /// Where its rays or their derivatives jump, in x and in y, in pixels: no facet stands for both sides.
    std::array<std::vector<double>, 2> breaks = {};
    /// The bodies that the camera's ray through a homogeneous screen position starts in. Unset: none, any.
    std::function<Media(const Vec3& screen)> around = {};

    Media media(const Vec3& at) const { return around ? around(at) : Media(); }
};

/// Who looks at which optic of what world; what is pointed to must live longer.
struct ProbeContext {
    const PathWorld* world = nullptr;
    Id optic = kNone;  // index into PathWorld::optics
    const Surface* surface = nullptr;
    PathCamera camera;
};

/// A place on a surface, with the normal that is taken there.
struct Place {
    Id face = kNone;
    Vec2 uv{0};
    Vec3 point{0};
    Vec3 normal{0};  // unit
};

/// kSeen: there are paths. kTurned: the surface is turned away from the ray (a facet's corner behind the
/// silhouette). kMissed: the camera's ray meets no surface there.
enum class ProbeState : std::uint8_t { kSeen, kTurned, kMissed };

/// The paths of a probe once more, from a place a small step away on the surface; none where they have
/// another history there.
struct OffsetProbe {
    Place place;
    Vec3 incident{
        0};  // the camera's ray there, as PathProbe has it; where it is not linear, from the probe's origin
    Vec2 step{0};  // from the probe's place on the film, pixels
    std::vector<std::optional<PathSegment>> segments;
};

struct PathProbe {
    ProbeState state = ProbeState::kMissed;
    Vec3 screen{0};     // homogeneous
    Vec3 incident{0};   // the camera's ray to the point, not unit: the eye-to-point length
    bool front = true;  // it looks at the surface's front
    Media around;       // what the camera's ray starts in
    Place place;
    std::vector<PathSegment> segments;  // of kSeen
    bool principal_only = false;        // of its paths none but the principal ones were followed
    CutPaths cut;                       // of those that were
    std::vector<OffsetProbe>
        beside;  // two, where probe_offsets was asked: along u and along v, or where the camera is
                 // not linear along the film's x and y; fewer where the surface ends; else none
    std::vector<double> ray_scale;  // per segment; see set_ray_scale; 0: unknown
};

/// Which side of the surface is looked at. kNearest: the one that the ray meets first.
enum class ProbeSide : std::uint8_t { kFront, kBack, kNearest };

/// As a least weight: the principal paths alone are followed. follow_all() may follow the others later.
inline constexpr double kPrincipalOnly = std::numeric_limits<double>::infinity();

/// A side to look at, and how faint paths are followed.
struct ProbeParams {
    ProbeSide side = ProbeSide::kFront;
    double least_weight = kLeastWeight;
};

/// The paths from a place that is known to lie on the surface, and which the camera sees so. Not for
/// kNearest.
PathProbe probe_point(const ProbeContext& context, const Place& place, const CornerView& view,
                      const ProbeParams& params);
/// The same where the camera is to be asked how it sees the place.
PathProbe probe_point(const ProbeContext& context, const Place& place, const ProbeParams& params);

/// The paths of the camera's ray through a facet's point `chord` (world) on the screen at `screen`: where it
/// meets the surface within `reach` of that point (world units), on that side; kMissed where it does not.
struct Chord {
    Vec3 screen{0};
    Vec3 point{0};
    double reach = 0;
};
PathProbe probe_chord(const ProbeContext& context, const Chord& chord, const ProbeParams& params);

/// Follows all paths of a probe of which the principal ones alone were followed, down to `least_weight`.
void follow_all(const ProbeContext& context, PathProbe& probe, double least_weight);

/// What stands for the way from the eye where rays are parallel, which come from no place: the optic's size.
/// Whatever is measured by it is then the same in a scene that is larger as a whole. None for other cameras.
std::optional<double> parallel_length(const ProbeContext& context);

/// Follows the paths of a probe once more from two places beside it.
void probe_offsets(const ProbeContext& context, PathProbe& probe);

/// Sets the ray scale of each segment: the cube root of the solid angle that a bundle of the camera's rays
/// has before the first optic over that which it has on the segment, by differences of exact rays on the
/// surface; solid angles near zero, of grazing bundles and of those that the optics make parallel, are
/// softened by 0.15 (mathematics, section 6, softens the first alone). A corner ray is the better for being
/// the eye length times the ray scale long: the directions' second derivatives then have no part along the
/// direction.
void set_ray_scale(const ProbeContext& context, PathProbe& probe);

/// The same for a corner of the grid, whose ray scale is 1 where nothing follows a first reflection: that
/// needs none.
void set_corner_ray_scale(const ProbeContext& context, PathProbe& probe);

/// The corner ray of one history, made from the probe at that corner.
struct NodeCorner {
    Ray ray;                                                // not unit
    Vec3 screen{0};                                         // homogeneous
    double next = std::numeric_limits<double>::infinity();  // t of the next optic; infinity: none
    Vec3 weight{1};                                         // see PathSegment::weight
};

/// The first reflection: the mirrored ray as long as the eye ray, which keeps a flat mirror exact. Beyond the
/// silhouette, where there is no segment (null), the mirror law goes on.
NodeCorner first_reflection(const PathProbe& probe, const PathSegment* segment);

/// How much farther the chord lies whose weights hold: after reflections alone the one seen in the mirrors,
/// farther away by the way between them, so that flat mirrors stay exact; else 1.
double farther(const PathProbe& probe, const PathSegment& segment, bool unfolds);

/// A later segment's ray, as long as the eye ray times the ray scale and what `farther` says.
NodeCorner later_corner(const PathProbe& probe, const PathSegment& segment, double ray_scale, bool unfolds);

// Whether the paths from two places have the same histories.

/// A path with so many times the least weight that is not matched is another history.
inline constexpr double kMuchLight = 8;

/// For each of `histories` its place in `segments`: the same steps, colours, media and end; empty where one
/// is missing.
std::vector<std::size_t> matched(const std::vector<PathSegment>& histories,
                                 const std::vector<PathSegment>& segments);

/// Whether no principal path and none that carries much light is left out of `match`.
bool covers(const std::vector<std::size_t>& match, const std::vector<PathSegment>& segments);

/// Whether the principal paths have the same histories: if not, no two lists with these among them are
/// matched() and covered both ways, whatever fainter paths there are.
bool same_principal(const std::vector<PathSegment>& a, const std::vector<PathSegment>& b);

// The probes of a facet's points while it is divided: no point twice, and no more of its paths than are
// needed.

/// A point of a facet. `screen` homogeneous, `chord` on the facet's plane, world.
struct FacetPoint {
    PathProbe* probe = nullptr;
    Vec3 screen{0}, chord{0};
    Id shared = kNone;  // see PartCorner
};

/// How a facet's points are looked at.
struct ProbeCacheParams {
    ProbeSide side = ProbeSide::kFront;
    double reach = 0;     // see Chord
    bool beside = false;  // probe_offsets() where all paths are followed
};

/// Makes probes and keeps them. `context` must live longer.
class ProbeCache {
  public:
    ProbeCache(const ProbeContext& context, const ProbeCacheParams& params)
        : context_(context), params_(params) {}

    /// The point with equal weights of these. Of the paths there the principal ones alone are followed.
    FacetPoint between(std::initializer_list<const FacetPoint*> points);

    /// between() two, in whatever order; the same probe each time.
    FacetPoint middle_of(const FacetPoint& a, const FacetPoint& b);

    /// Has all paths followed there, down to `least_weight`.
    void follow_all_at(const FacetPoint& point, double least_weight);

    /// Counts what the paths left out at a probe, which need not be one of these.
    void note(const CutPaths& cut) { cut_ = most_cut(cut_, cut); }

    /// The probes, at places that stay, and the most that any left out.
    std::deque<PathProbe>& probes() { return probes_; }
    const CutPaths& cut() const { return cut_; }

  private:
    using Ends = std::pair<const PathProbe*, const PathProbe*>;

    const ProbeContext& context_;
    ProbeCacheParams params_;
    std::deque<PathProbe> probes_;
    CutPaths cut_;
    std::map<Ends, FacetPoint> middles_;  // of edges; nothing depends on the order
};

/// Whether one list of histories may hold at all these points: they see the optic from one side, by the same
/// principal paths.
bool may_agree(std::span<const FacetPoint> points);

}  // namespace trilens
