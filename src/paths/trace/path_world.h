// What paths run through: the optics' exact surfaces and what they are made of.
#pragma once

#include <functional>
#include <vector>

#include "base/description/material.h"
#include "base/raymesh/surface.h"
#include "intersect/limit_tracer.h"
#include "intersect/patch_tree.h"
#include "intersect/tracer.h"
#include "paths/trace/media.h"
#include "paths/trace/path.h"

namespace trilens {

/// One optic as paths meet it; what is pointed to must live longer.
struct PathOptic {
    const LimitTracer* tracer = nullptr;
    const Material* material = nullptr;
    bool mirror = true;   // else glass
    int priority = 0;     // of its glass, where bodies overlap
    bool convex = false;  // no ray that leaves its front meets it again
    /// The patches of its surface, made when first asked for. Unset: nothing is proven about it.
    std::function<const PatchTree&()> patches = {};
};

/// All optics, and how far paths are followed.
struct PathWorld {
    std::vector<PathOptic> optics;
    int max_depth = 8;  // optic hits after the first
    bool fresnel = true;
    bool reflect = true, refract = true;  // the first events that are wanted
    const Tracer* objects = nullptr;      // that optics may lie on, see follow_paths; null: none
};

/// The body whose glass is active inside of these; kNone: air.
inline Id active_medium(const PathWorld& world, const Media& media) {
    return media.active([&](Id optic) { return world.optics[optic].priority; });
}
/// Its material; null: air.
inline const Material* felt_glass(const PathWorld& world, const Media& media) {
    const Id body = active_medium(world, media);
    return body == kNone ? nullptr : world.optics[body].material;
}

/// What of each colour is left after `way` scene units in a body's glass; kNone: air, which takes nothing.
Vec3 body_transmittance(const PathWorld& world, Id body, double way);

/// Where a ray meets an optic.
struct Meeting {
    Id optic = kNone;
    Vec3 incoming{0};   // unit, to the surface
    Vec3 point{0};      // on the surface, world
    Vec3 normal{0};     // unit, out of the front side
    bool front = true;  // the ray comes to the front: from outside the body
};

/// One way that light goes on from a meeting.
struct Branch {
    Step step;
    Vec3 direction{0};  // unit
    Vec3 weight{1};     // share of each colour that goes this way
    Media media;        // where it goes
    Colours colours = kAllColours;
    bool principal = true;
    Vec3 refraction{
        0};  // of glass, per colour: squared sine of the angle of refraction; from 1 on there is none
};

/// The ways that light goes on from a meeting, at most five, the principal one first: mirrored by a mirror;
/// reflected by glass and refracted through it, once or, where it disperses, once for each colour; straight
/// on where there is no interface. `media` and `colours`: of the ray that arrives. The weights of all ways
/// add up to 1 in each colour that the ray has, but for what a tint or a mirror takes away. Empty where the
/// ray is inside of too many bodies to tell.
///
/// On either side lies what sides_of says. A normal beyond grazing counts as grazing for refraction.
std::vector<Branch> branches(const PathWorld& world, const Meeting& at, const Media& media, Colours colours);

}  // namespace trilens
