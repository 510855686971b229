// The world: a scene made of triangles to look at, and optics to look through; with its acceleration
// structures, grids and lights.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/raymesh/face_neighbours.h"
#include "base/raymesh/surface.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "caustics/beam_light.h"
#include "intersect/limit_tracer.h"
#include "intersect/tracer.h"
#include "paths/trace/path_world.h"
#include "projector/projector.h"
#include "render/world/scene_reuse.h"
#include "scene/data/scene.h"
#include "shade/shade.h"

namespace trilens {

class BlendedSurfaces;
struct CausticLights;
class VolumeGeometry;

/// One optic: its exact surface and what it does to light.
struct Optic {
    Id mesh = kNone;                         // object id in images
    std::shared_ptr<const Surface> surface;  // world frame, with the file's normals
    int resolution = 8;                      // of its grid, where nothing else is asked for
    Id material = kNone;
    bool mirror = true;  // else glass
};

struct WorldGeometry;

/// What does not change from picture to picture; pointers inside point into the world itself, so it stays
/// where it is. Thread-safe to read. What is built from it (trees, grids) stands below.
struct World {
    World();
    ~World();
    World(const World&) = delete;
    World& operator=(const World&) = delete;

    Scene scene;
    TriangleScene objects;  // the triangles of the meshes that are objects, but for those that blend
    ShadeScene shading;     // of `objects`
    std::vector<Optic> optics;
    std::vector<std::string> names;                              // object id -> name
    std::vector<std::shared_ptr<const VolumeGeometry>> volumes;  // of scene.volumes
    std::unique_ptr<BlendedSurfaces> blended;                    // null: nothing blends
    std::unique_ptr<WorldGeometry> geometry;
    std::vector<std::string> mesh_digests;  // of scene.meshes, once change_scene has asked for them
};

/// The material of an optic in whose glass light runs; null of kNone: air.
inline const Material* glass_of(const World& world, Id optic) {
    return optic == kNone ? nullptr : &world.scene.materials[world.optics[optic].material];
}

/// An optic's shape with its own normals, whatever else its mesh says of them.
std::unique_ptr<Surface> make_plain_surface(const Mesh& mesh, const Warn& warn);
/// The exact surface of an optic, as a world of that scene has it. Throws InputError where its cage cannot be
/// used.
std::shared_ptr<const Surface> make_optic_surface(const Scene& scene, Id mesh, const Warn& warn);

/// Builds the surfaces and gathers the triangles. Throws InputError where a cage cannot be used.
std::unique_ptr<World> make_world(Scene scene, const Warn& warn);

/// Gives the world another scene. Meshes that are the same in both, at the same index, keep what is built of
/// them. Throws as make_world does, and then nothing has changed. Nobody may draw meanwhile.
SceneReuse change_scene(World& world, Scene scene, const Warn& warn);

/// The resolution of an optic's grid: `asked`, or its own where that is 0.
inline int grid_resolution(const Optic& optic, int asked) {
    return asked > 0 ? asked : optic.resolution;
}

/// The facets of all optics together at that resolution (0: each at its own).
std::size_t facet_count(const World& world, int resolution);

/// Throws InputError where that is too many to hold.
void check_facet_count(const World& world, int resolution);

// Acceleration structures and grids of a world, built lazily.

/// An optic's grid at one resolution. Its facets as a scene: triangle f is facet f, its object the optic's.
class OpticFacets {
  public:
    OpticFacets(SurfaceGrid grid, Id object) : grid_(std::move(grid)), object_(object) {}

    const SurfaceGrid& grid() const { return grid_; }
    TriangleScene scene() const;
    const PreparedScene& prepared() const;
    const Tracer& tracer() const;

  private:
    SurfaceGrid grid_;
    Id object_ = kNone;
    Lazy<PreparedScene> prepared_;
    Lazy<Tracer> tracer_;
};

/// Makes room for what is built later; called once, when the world has all its optics.
void prepare_geometry(World& world);

/// The same where a changed world keeps parts: `kept_optics` holds, per optic of now, the index it had before
/// or kNone; `keeps_objects`: all objects are as they were.
void keep_geometry(World& world, const std::vector<Id>& kept_optics, bool keeps_objects);

/// The objects for the projector, and for rays.
const PreparedScene& prepared_objects(const World& world);
const Tracer& object_tracer(const World& world);

/// The exact surface of an optic for rays.
const LimitTracer& limit_tracer(const World& world, std::size_t optic);

/// Which of its faces lie next to one another.
const FaceNeighbours& face_neighbours(const World& world, std::size_t optic);

/// All optics as paths meet them, with their exact surfaces, and how far the scene has paths followed.
const PathWorld& path_world(const World& world);

/// Whether any light asks what lies between it and a point.
bool has_shadows(const World& world);

/// The segments that an object, or the exact surface of a mirror, meets. Glass lets the light through.
Segments::Bits casts_shadow(const World& world, const Segments& segments);

/// The segments that an object or an optic of any kind meets: where light that is followed over optics does
/// not come straight.
Segments::Bits meets_anything(const World& world, const Segments& segments);

/// The beams of lights with caustics, made when first asked for; `exact`: for receivers that ask for exact
/// rays, which have beams of their own. Throws Interrupted soon after `progress` says so, and then the next
/// one to ask makes them.
const CausticLights& caustic_lights(const World& world, bool exact, const Progress& progress = {});

/// They, where they are made already; null: they are not.
const CausticLights* known_caustic_lights(const World& world, bool exact);

/// Builds what casts_shadow asks, and beams of light, where the scene has shadows: before many threads do.
/// Throws as caustic_lights does.
void prepare_shadows(const World& world, bool exact, const Progress& progress = {});

/// The optic's facets at resolution n. The last resolution of each optic is kept, so that a new camera finds
/// it.
std::shared_ptr<const OpticFacets> optic_facets(const World& world, std::size_t optic, int n);

/// What pictures ask of each optic.
struct OpticNeeds {
    int resolution = 0;  // of the facets; 0: each optic's own
    bool facets = false, projected = false, traced = false;
    bool exact_rays = false;
};

/// Makes it ahead, optic by optic, which else the first picture makes as it goes. What is there already
/// stays. Throws Interrupted soon after `progress` says so, and InputError as check_facet_count.
void prepare_optics(const World& world, const OpticNeeds& needs, const Progress& progress);

// The lights of a world whose light is followed over optics.

/// Beams of the scene's lights.
struct CausticLights {
    PathWorld optics;                                               // as lights see them
    std::vector<std::vector<std::unique_ptr<BeamLight>>> by_light;  // its samples'; none: it is not followed
    std::shared_ptr<const ReceiverFaces> faces;                     // of World::objects

    /// The samples of all lights.
    std::vector<const BeamLight*> all() const;
};

/// The light as sources whose rays start in a point or are parallel: its samples, of a sphere parts of its
/// surface; none for ambient light. `background`: what an environment's light is of. `scene_size`: in world
/// units; rays of flat lights start a small share of it before them.
std::vector<BeamSource> beam_sources(const Light& light, const Background& background, double scene_size);

/// Whether any light is followed over optics.
bool has_caustics(const World& world);

/// Whether an optic is rough, and whether any is.
bool is_rough(const World& world, Id optic);
bool has_rough_optics(const World& world);

/// The beams of one light of the scene, of each of its samples, whether it says that it is followed or not.
/// Throws UsageError for a light that has none, and Interrupted soon after `progress` says so.
std::vector<std::unique_ptr<BeamLight>> make_beam_lights(const World& world, const PathWorld& optics,
                                                         std::size_t light, const BeamGridParams& params = {},
                                                         const Progress& progress = {});

/// Irradiance of all samples together.
Vec3 irradiance(const std::vector<std::unique_ptr<BeamLight>>& lights, const Receiver& receiver);

/// The scene's optics and depth, with first events of both kinds.
PathWorld optics_for_lights(const World& world);

/// Beams of all lights that are followed. Throws Interrupted soon after `progress` says so.
std::unique_ptr<CausticLights> make_caustic_lights(const World& world, const BeamGridParams& params,
                                                   const Progress& progress = {});

/// What a light sends over optics to the receiver's footprint on the scene's objects, whatever their shape
/// there (receiver_cells).
Vec3 irradiance_on_surface(const World& world, std::size_t light, const Receiver& receiver);

/// Gathers now, as a stage of its own, what lights send to these faces, that else is gathered when a receiver
/// first asks for it. Throws Interrupted soon after `progress` says so.
void gather_light(std::span<const BeamLight* const> lights, std::span<const ReceiverSide> faces,
                  const Progress& progress);

/// What a light's beams leave out, in words.
std::vector<std::string> lost_light(const World& world, std::size_t light,
                                    std::span<const std::unique_ptr<BeamLight>> beams);

/// Warns of what beams leave out.
void warn_of_lost_light(const World& world, const CausticLights& lights, const Warn& warn);

}  // namespace trilens
