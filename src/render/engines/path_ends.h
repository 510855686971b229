// One history of the paths over an optic, drawn through its RayMesh.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/raymesh/sample_grid.h"
#include "base/raymesh/triangle_scene.h"
#include "intersect/limit_tracer.h"
#include "intersect/tracer.h"
#include "paths/facets/optic_paths.h"
#include "paths/nested/nested_optics.h"
#include "paths/probe/path_probe.h"
#include "paths/trace/follow.h"
#include "render/frame/frame.h"
#include "render/frame/views.h"
#include "render/volumes/volume_rays.h"
#include "render/world/world.h"

namespace trilens {

/// Of t: an object that lies no farther behind the next optic is seen in it.
inline constexpr double kTouch = 1e-9;
/// The same where it is known that an object lies on the next optic, whose t is interpolated.
inline constexpr double kNearTouch = 0.05;

/// An engine's work on one RayMesh: the nearest triangles along the rays of the owned samples.
using DrawMesh = std::function<void(const RayMesh&, const FacetSamples&, const SampleGrid&, std::span<Hit>)>;

/// The ends of samples, one history after the other.
struct PathEnds {
    std::vector<PathEnd> ends;
    std::vector<Id> sample;   // of each end
    std::vector<Step> steps;  // PathEnd::first_step counts here
};

/// What draws histories. All must live longer.
struct HistoryEngine {
    const World& world;
    const DrawMesh& mesh;                  // the objects
    const DrawVolumes* volumes = nullptr;  // null: there are none
    std::vector<SampleVolumes>* found =
        nullptr;  // per sample: emission along the legs is added; with volumes
};

/// One history drawn: for each sample of it what it sees, and whether its path goes on.
class HistoryDrawer {
  public:
    /// `leaf`: per sample; kNone: it is not drawn. All must live longer.
    HistoryDrawer(const HistoryEngine& engine, const OpticPaths& paths, const SampleGrid& grid,
                  const std::vector<Id>& leaf)
        : engine_(engine),
          paths_(paths),
          grid_(grid),
          leaf_(leaf),
          goes_on_(paths.nodes.size()),
          through_(engine.volumes ? paths.nodes.size() : 0) {}

    /// Parents first.
    void draw(Id node, PathEnds& out);

  private:
    bool ends_before_next(Id node, Id facet, const Hit& hit, const Vec3& share) const;
    std::vector<char> find_ends(Id node, const FacetSamples& owned, std::span<const Hit> hits);
    void set_end(Id node, Id facet, const Vec3& share, PathEnd& end) const;
    Vec3 weight_at(Id node, Id facet, const Vec3& share) const;
    double up_to_next(Id node, Id facet, const Vec3& share) const;
    void draw_volumes(Id node, const FacetSamples& owned, std::span<const Hit> hits,
                      const std::vector<char>& is_end);

    const HistoryEngine engine_;
    const OpticPaths& paths_;
    const SampleGrid& grid_;
    const std::vector<Id>& leaf_;
    std::vector<std::vector<char>> goes_on_;    // per node and sample
    std::vector<std::vector<double>> through_;  // the same: transmittance of volumes up to the node's end
};

// The first surface that a ray meets: exact optics among objects.

/// What a camera's ray meets first: an optic, else an object, else nothing.
struct FirstSurface {
    Hit object;        // unset where an optic comes first
    Id optic = kNone;  // index into PathWorld::optics
    SurfaceHit at;     // where it is met; of an optic only
};

/// Along `ray` (world frame, any length) up to t = reach. Of optics that touch where it meets them the one
/// whose turn it is (coincident_order); an object on which a body of glass lies comes before the body's
/// surface, met from inside.
FirstSurface first_surface(const PathWorld& world, const Tracer& objects, const Ray& ray, double reach);

// Ray traces samples on the exact surfaces: those that no facet speaks for, and the truth.

struct TraceSamplesParams {
    const World& world;
    Id optic = kNone;
    const PathCamera& camera;
    const SampleGrid& grid;
    double reach = 0;      // of the camera's rays
    bool volumes = false;  // emission and absorption along the paths are found, too
};

/// A sample, and where its ray meets the optic, where that is known.
struct TracedSample {
    Id sample = kNone;
    std::optional<SurfaceHit> met;
};

/// Appends the ends of all paths over the optic of these samples of `views`, and sets there what was not
/// followed. Where the camera is not linear their rays are its exact ones, as in the truth, not those of its
/// facets; one that passes the exact surface by shows no optic, but the object behind.
void trace_samples(const TraceSamplesParams& params, std::span<const TracedSample> samples,
                   SampleViews& views, PathEnds& out);

/// Where a sample's ray meets its optic first.
struct FirstOpticHit {
    SurfaceHit at;
    Media around;  // what the ray starts in
};

/// Where what is found goes.
struct SamplePaths {
    OpticView& on_optic;  // its incidence, way and cut
    std::vector<PathEnd>& ends;
    std::vector<Step>& steps;
    FollowedPaths& followed;           // the paths; those of a sample before are overwritten
    SampleVolumes* volumes = nullptr;  // emission along the paths is added, absorption goes into the ends'
                                       // weights; null: volumes are not asked for
};

/// Appends the ends of all paths of a sample whose ray meets its optic (view.optic) there, with their steps.
/// `first_step` of the ends counts in `steps`. The rays that leave carry the eye-to-surface length, as corner
/// rays do.
void follow_sample(const World& world, const FirstOpticHit& first, const SampleView& view,
                   const SamplePaths& found);

// What the samples of one optic see over all its paths, drawn through the RayMesh of each history.

/// Whose ends are asked for, and what draws them.
struct PathEndsParams {
    const World& world;
    Id optic = kNone;
    const DrawMesh& draw;                  // of the objects
    const DrawVolumes* volumes = nullptr;  // null: there are none
    const FramedOptic& framed;
    NestedOptics* nested = nullptr;  // optics seen in it; null: none is a nested optic
    SampleGrid grid;                 // of the samples
    SampleGrid part;                 // of the grid: no sample beyond it shows the optic
};

/// The ends of all samples whose first surface is the optic's, and their method, level, and what was not
/// followed. A segment ends at an object that is nearer than the next optic is, as its corners have it; where
/// optics are nested optics, the nearest that covers the sample and that no object is nearer than is seen,
/// and so on in that one. Works out the facets that are seen and were not before. `traced`: gets the samples
/// that no facet speaks for, whose ends are still to be found; those near outlines are among them.
PathEnds draw_optic_paths(const PathEndsParams& params, PathBuilder& paths, SampleViews& views,
                          std::vector<Id>& traced);

/// The facets that have samples.
std::vector<Id> seen_facets(const FacetSamples& owned);

/// The leaf of each sample that `owned` gives to a facet of the paths, which are prepared; of others kNone.
std::vector<Id> leaves_of_samples(const OpticPaths& paths, const FacetSamples& owned, const SampleGrid& grid);

/// Puts the ends of all optics into the record, which has none, those of one sample side by side.
void collect_ends(std::vector<PathEnds> optics, SampleViews& views);

}  // namespace trilens
