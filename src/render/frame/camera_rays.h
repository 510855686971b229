// A camera's exact rays, also those of an explicit RayMesh, and the media that they start in.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/math/box.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/util/parallel.h"
#include "camera/camera.h"
#include "camera/model/camera_model.h"
#include "paths/trace/path_world.h"
#include "render/frame/request.h"
#include "render/frame/views.h"
#include "render/world/world.h"
#include "scene/data/scene.h"

namespace trilens {

/// A scene's camera: its exact rays, its linear map where it has one, and its RayMesh.
using CameraRays = Camera;

/// The camera `index` of the scene; an explicit RayMesh has a model (ray_mesh_model.h) where the scene has
/// optics, whose grids then lie on its film. Throws InputError with its place where it is none.
CameraRays make_camera_rays(const Scene& scene, std::size_t index);

/// Calls use(sample, facet, ray) with the camera's ray of every sample that `owned` gives to a facet, from
/// several threads.
template <typename Use>
void for_each_camera_ray(const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid, Use&& use) {
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (!mesh.has_rays(f)) continue;
        const FacetWeights weights = facet_weights(mesh, f);
        const std::span<const Id> samples = owned.of(f);
        parallel_for(samples.size(), 1024, [&](std::size_t from, std::size_t to) {
            for (const Id s : samples.subspan(from, to - from))
                use(s, static_cast<Id>(f), sample_ray(mesh, f, weights, grid.position(s)));
        });
    }
}

/// Sets the exact ray of every sample of a camera that is not linear, and returns the samples that have one
/// (those of facet 0), ascending. For the limit truth.
FacetSamples set_exact_rays(const CameraModel& model, const SampleGrid& grid, std::span<SampleView> views);

/// Adds the depth at which the camera's rays begin to the depths of what is seen, and says what the depths'
/// unit is.
void count_from_eye(const CameraRays& camera, SampleViews& views);

/// The same of samples whose exact rays were followed; of a camera that is not linear these have the length of
/// its facets' rays until now.
void count_traced_from_eye(const CameraRays& camera, const SampleGrid& grid, std::span<const Id> samples,
                           std::span<SampleView> views);

/// The rays that the mesh interpolates are the camera's exact ones; a place without a facet has none. A point
/// may have an image in every facet, so that surface grids have no place of their own on its film: `place` is
/// none everywhere, `places` lists the images facet by facet. Screens are affine.
std::shared_ptr<const CameraModel> make_ray_mesh_model(const RayMesh& mesh, const FilmSize& film);

/// Whether a model is one of those.
bool is_ray_mesh_model(const CameraModel& model);

/// The point that all rays of the camera start in; none where they do not.
std::optional<Vec3> eye_of(const CameraRays& camera);

// What a camera stands in: the bodies of glass around its eye, or around where each of its rays starts.

/// The media that a camera's rays start in.
struct CameraMedia {
    LeavesBody leaves;       // where by_ray
    bool by_ray = false;     // each ray has its own: `of` asks it
    std::vector<Id> near;    // optics of glass that may hold where some ray starts
    std::vector<Box> boxes;  // of these; nothing of them lies outside
    Media fixed;             // of all rays where not by_ray
    /// Bodies that hold the eye in some directions only, see EnclosingBodies; where there is one body alone
    /// none, as what leaves it leaves it whether it was inside or not.
    std::vector<Id> unsure;

    /// Whether rays start in air, all of them.
    bool none() const { return !by_ray && fixed.count == 0; }
    /// What this ray of the camera starts in.
    Media of(const Ray& ray) const;
};

/// Where all rays of the camera start at its eye, one answer for all. Where they do not (parallel rays, a
/// near plane that cuts, moving eyes) each ray is asked where it itself meets bodies first. The world must
/// live longer.
CameraMedia camera_media_of(const World& world, const CameraRays& camera);

/// A body of glass of no world, and a box that it lies in.
struct GlassBody {
    Id optic = kNone;
    Box box;
};
/// The same among these bodies; each lies in its box.
CameraMedia camera_media_of(std::span<const GlassBody> bodies, const LeavesBody& leaves,
                            const CameraRays& camera);

/// Places of a surface, and the box about them, or about where an affine map takes them, that it lies in.
std::vector<Vec3> outline_of(const Surface& surface);
Box box_around(std::span<const Vec3> outline);

/// What rays of any kind start in: each is asked.
CameraMedia media_by_ray(const World& world);

/// Warns where it cannot be told for sure what the eye is inside of. `name`: of an optic.
void warn_of_unsure_media(const CameraMedia& around, const std::function<std::string(Id optic)>& name,
                          const Warn& warn);
void warn_of_unsure_media(const World& world, const CameraMedia& around, const Warn& warn);

/// Sets what each sample's ray starts in.
void set_initial_media(const CameraMedia& around, SampleViews& views);

/// What is left of the light on the way from where the camera's ray starts to what the sample shows first.
Vec3 light_of_view(const World& world, const SampleViews& views, const SampleView& view);

/// The weights of the light at the first optic of a sample, the way there included.
OpticWeights first_weights(const World& world, const SampleViews& views, const SampleView& view);

/// The glass that a ray inside of these runs in; null: air.
const Material* glass_around(const World& world, const Media& around);

/// Whether a sample's ray starts in air.
inline bool is_in_air(const World& world, const SampleViews& views, const SampleView& view) {
    return view.around == kNone || !glass_around(world, views.around_of(view));
}

/// An optic's surface for a ray that is inside of `around` before it; of mirrors, too.
GlassInterface interface_of(const World& world, Id optic, const Media& around, bool front);

/// The refractive index of an optic's glass over that around it, for rays from a camera with these
/// media; as make_refraction has it.
double relative_ior(const World& world, std::size_t optic, const Media& around);

}  // namespace trilens
