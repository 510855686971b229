// What paths are followed through: optics, objects, and nested dielectrics (a ray's interior list and its
// active medium).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "base/description/material.h"
#include "base/raymesh/surface.h"
#include "base/util/few.h"
#include "base/util/ids.h"
#include "intersect/limit_tracer.h"
#include "intersect/patch_tree.h"
#include "intersect/tracer.h"
#include "paths/trace/path.h"

namespace trilens {

/// Optics in the order in which the ray came into them. Plain data, small: a ray inside of more than kMost
/// bodies at once cannot be told.
struct Media {
    static constexpr int kMost = 8;
    std::array<Id, kMost> optic{};
    std::uint8_t count = 0;

    bool holds(Id asked) const {
        for (int i = 0; i < count; ++i)
            if (optic[static_cast<std::size_t>(i)] == asked) return true;
        return false;
    }
    /// False where there is no room.
    bool enter(Id entered) {
        if (count == kMost) return false;
        optic[count++] = entered;
        return true;
    }
    /// Takes out the last entry of that optic, where it has one.
    void leave(Id left) {
        for (int i = count - 1; i >= 0; --i) {
            if (optic[static_cast<std::size_t>(i)] != left) continue;
            for (int k = i; k + 1 < count; ++k)
                optic[static_cast<std::size_t>(k)] = optic[static_cast<std::size_t>(k) + 1];
            --count;
            return;
        }
    }

    /// The body whose glass the ray runs in: of those that it is inside of the one of highest priority, the
    /// last entered among equals; kNone: air. `priority(optic)` gives an optic's.
    /// Source: Schmidt and Budge, Simple Nested Dielectrics in Ray Traced Images, JGT 2002.
    template <typename Priority>
    Id active(const Priority& priority) const {
        Id best = kNone;
        for (int i = 0; i < count; ++i) {
            const Id one = optic[static_cast<std::size_t>(i)];
            if (best == kNone || priority(one) >= priority(best)) best = one;
        }
        return best;
    }
};

/// What a ray is inside of before and behind a surface.
struct MediaSides {
    Media before, after;
};

/// The sides of a body's surface for a ray that is inside of `media`; it comes to the body's front, from
/// outside, or to its back. One that comes to the back of a body that it did not enter (an open surface)
/// leaves it. None where the ray is inside of too many bodies to tell.
inline std::optional<MediaSides> sides_of(const Media& media, Id body, bool front) {
    MediaSides sides{media, media};
    if (front) {
        if (!sides.after.enter(body)) return std::nullopt;
        return sides;
    }
    if (!media.holds(body) && !sides.before.enter(body)) return std::nullopt;
    sides.after = sides.before;
    sides.after.leave(body);
    return sides;
}

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
    // Unit, on the ray's side: of the microfacet of a rough surface that it meets; zero: the surface is
    // smooth.
    Vec3 microfacet{0};
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
    // One over the density of the directions, per solid angle, in which a rough surface sends light so; 0:
    // the surface is smooth.
    double lobe = 0;
};
/// Few, that need no memory of their own.
using Branches = Few<Branch, 5>;

/// The ways that light goes on from a meeting, at most five, the principal one first: mirrored by a mirror;
/// reflected by glass and refracted through it, once or, where it disperses, once for each colour; straight
/// on where there is no interface. `media` and `colours`: of the ray that arrives. The weights of all ways
/// add up to 1 in each colour that the ray has, but for what a tint or a mirror takes away. Empty where the
/// ray is inside of too many bodies to tell.
///
/// At a microfacet light goes on as at a smooth surface with its normal, less what other microfacets mask;
/// ways to the wrong side of the surface are left out.
///
/// On either side lies what sides_of says. A normal beyond grazing counts as grazing for refraction.
Branches branches(const PathWorld& world, const Meeting& at, const Media& media, Colours colours);

/// The meeting at one of the microfacets that the ray sees of a rough optic (see visible_normal); that of a
/// smooth one as it is.
Meeting with_microfacet(const PathWorld& world, Meeting at, const Vec2& place);

// The bodies of glass that a ray starts in: what a camera looks out of.

/// A body holds the place that a ray starts from where the ray comes to its back first. Both answers list
/// the body that the ray leaves first as the last entered; of more bodies than Media can hold the ones left
/// first. `asked`: bodies that may hold the place; others are not looked at.

/// How far a ray goes in a body that it starts in, in units of its direction; none where it starts in none.
using LeavesBody = std::function<std::optional<double>(Id body, const Ray& ray)>;

/// Where a ray leaves a body whose surface it meets first there; none where it comes to the front.
inline std::optional<double> leaves_at(const std::optional<SurfaceHit>& hit, const Ray& ray) {
    return hit && dot(hit->point.normal, ray.direction) > 0 ? std::optional(hit->t) : std::nullopt;
}

/// By this ray alone.
Media bodies_along(const LeavesBody& leaves, const std::vector<Id>& asked, const Ray& ray);
Media bodies_along(const PathWorld& world, const std::vector<Id>& asked, const Ray& ray);

/// What rays from a point start in.
struct EnclosingBodies {
    Media media;
    std::vector<Id> unsure;  // bodies that some directions say hold the point, and others say do not
};

/// By the vote of several directions, more than half of them: for a surface that is closed, and whose normals
/// point out of it, they agree.
EnclosingBodies enclosing_bodies(const LeavesBody& leaves, const std::vector<Id>& asked, const Vec3& point);
EnclosingBodies enclosing_bodies(const PathWorld& world, const std::vector<Id>& asked, const Vec3& point);

}  // namespace trilens
