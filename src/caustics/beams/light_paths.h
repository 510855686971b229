// The exact paths of one ray of a light over the optics: what each of its stretches carries, and where it
// goes.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "caustics/beams/light_window.h"
#include "paths/trace/follow.h"
#include "paths/trace/path_world.h"

namespace trilens {

/// A blended surface: its mesh, and its material.
using VeilSurface = std::pair<Id, Id>;

/// Which way light went.
struct LightHistory {
    std::vector<Step> steps;  // meetings with optics up to its stretch's start, at least one
    Colours colours = kAllColours;
    Id medium = kNone;                 // in whose glass the stretch runs; kNone: air
    bool has_start = true;             // see has_start(), of the stretch
    std::vector<VeilSurface> veils{};  // blended surfaces that it came through before

    bool operator==(const LightHistory&) const = default;
};

/// One stretch of a light's path, from the optic where it starts to where it would end.
struct LightPath : LightHistory {
    Ray ray;           // unit direction, from the last optic
    Vec3 arriving{0};  // of its colours, at the first optic
    Vec3 light{0};     // the source's strength and all that happened to it up to the ray's start
    double optic = std::numeric_limits<double>::infinity();  // way to the next optic
    double object =
        std::numeric_limits<double>::infinity();  // way to the first object, before the next optic

    const LightHistory& history() const { return *this; }
    /// Whether it does not only go on to another optic.
    bool falls() const { return std::isfinite(object) || !std::isfinite(optic); }
};

/// What surfaces that show a part of what lies behind leave of light.
struct Veil {
    double through = 1;                 // a share
    std::vector<VeilSurface> surfaces;  // one by one along the light
};

/// What lights send their rays through.
struct LightSpace {
    const PathWorld* optics = nullptr;  // with first events of both kinds
    const Tracer* objects = nullptr;    // that stop light
    /// The bodies of glass that a ray starts in; unset: none.
    std::function<Media(const Ray&)> around;
    /// What is left of light on its way to the segment's origin, from t = 1; unset: nothing veils.
    std::function<Veil(const Ray&)> veil;
    double size = 1;   // of the scene, world units
    double reach = 1;  // from an optic to anything that stops or veils light, at most; no less than `size`
};

struct LightPaths {
    std::vector<LightPath> paths;  // parents before children
    CutPaths cut;                  // what was left out, as shares of the ray's light
};

/// All paths of the light's ray whose first optic is `first`. Opaque objects end them. `only`: as
/// FollowParams has it.
LightPaths light_paths(const LightSpace& space, const BeamSource& source, const Ray& ray, Id first,
                       std::span<const std::vector<Step>* const> only = {});

/// One path of the light's ray, followed by itself.
struct SinglePath {
    LightPath path;             // `optic` and `object` are not known
    std::vector<Vec3> corners;  // where it met optics
    Media media;                // that its last stretch is inside of
};

/// The path of that history, however faint; none where the ray goes another way. Opaque objects on its way
/// are not asked.
std::optional<SinglePath> follow_history(const LightSpace& space, const BeamSource& source, const Ray& ray,
                                         const LightHistory& like);

/// Whether no object stands on the way from the ray's origin over the optics up to the last of them.
bool is_free(const LightSpace& space, const Ray& ray, const SinglePath& single);

/// Things this near to each other are at the same place: a share of the scene's size, or of a way.
inline constexpr double kSamePlace = 1e-6;

}  // namespace trilens
