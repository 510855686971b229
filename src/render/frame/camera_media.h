// What a camera stands in: the bodies of glass around its eye, or around where each of its rays starts.
#pragma once

#include <vector>

#include "base/math/box.h"
#include "paths/trace/path_world.h"
#include "render/frame/camera_rays.h"
#include "render/frame/request.h"
#include "render/world/world.h"

namespace trilens {

/// The media that a camera's rays start in.
struct CameraMedia {
    const World* world = nullptr;
    bool by_ray = false;     // each ray has its own: `of` asks it
    std::vector<Id> near;    // optics of glass that may hold where some ray starts
    std::vector<Box> boxes;  // of these; nothing of them lies outside
    Media fixed;             // of all rays where not by_ray
    std::vector<Id> unsure;  // bodies that hold the eye in some directions only; see EnclosingBodies

    /// Whether rays start in air, all of them.
    bool none() const { return !by_ray && fixed.count == 0; }
    /// What this ray of the camera starts in.
    Media of(const Ray& ray) const;
};

/// Where all rays of the camera start at its eye, one answer for all. Where they do not (parallel rays, a
/// near plane that cuts, moving eyes) each ray is asked where it itself meets bodies first.
CameraMedia camera_media_of(const World& world, const CameraRays& camera);

/// What rays of any kind start in: each is asked.
CameraMedia media_by_ray(const World& world);

/// Warns where it cannot be told for sure what the eye is inside of.
void warn_of_unsure_media(const World& world, const CameraMedia& around, const Warn& warn);

/// Sets what each sample's ray starts in.
void set_initial_media(const CameraMedia& around, SampleViews& views);

/// What is left of the light on the way from where the camera's ray starts to what the sample shows first.
Vec3 light_of_view(const World& world, const SampleViews& views, const SampleView& view);

/// The weights of the light at the first optic of a sample, the way there included.
OpticWeights first_weights(const World& world, const SampleViews& views, const SampleView& view);

/// The glass that a ray inside of these runs in; null: air.
const Material* glass_around(const World& world, const Media& around);

/// An optic's surface for a ray that is inside of `around` before it; of mirrors, too.
GlassInterface interface_of(const World& world, Id optic, const Media& around, bool front);

/// The refractive index of an optic's glass over that around it, for rays from a camera with these
/// media; as make_refraction has it.
double relative_ior(const World& world, std::size_t optic, const Media& around);

}  // namespace trilens
