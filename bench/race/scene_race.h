// How fast the projector draws a scene's rays, against Embree's packets on the same rays in the same run, as
// text and as JSON; how many layers the rays pass.
#pragma once

#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/util/error.h"
#include "bench/race/race.h"
#include "render/frame/request.h"
#include "scene/data/scene.h"

namespace trilens_bench {

// How fast the projector draws a scene's rays, against Embree's packets on the same rays in the same run; how
// many layers the rays pass.

using namespace trilens;

struct BenchRequest {
    FrameParams frame;
    RaceParams race;
};

struct BenchResult {
    RaceResult race;
    bool direct = false;  // the camera's own rays, since it sees no optic; else all that leave the optics
    // Medians over a third of the repeats, at least one. What both sides have in common, so that there is no
    // ratio.
    double surface_ms = 0;  // the optics' surfaces and the scene's triangles
    double rays_ms = 0;   // the camera's rays, the optics' grids and their corner rays up to the first optic
    double shade_ms = 0;  // colours of all samples of the film, from what they see
};

/// The rays that leave the scene's optics through the facets' samples (every path of every optic that the
/// camera sees), or the camera's own where it sees none. The picture is drawn once, band by band, to find
/// them. Throws as Renderer::draw, and UsageError for an instruction set that this machine does not have and
/// for less than one repeat.
BenchResult run_bench(Scene scene, const BenchRequest& request, const Warn& warn = {});

// How many layers of a scene its rays pass.

using namespace trilens;

/// Mean number of depths (t >= 0, further apart than kDepthTie) at which a ray meets triangles, over every
/// 64th sample of each facet and each facet's first. 0 where there are no samples. Builds a tree of its own.
double depth_complexity(const RaceCourse& course);

// Rays that leave the optics, collected while a picture is drawn band by band.

using namespace trilens;

/// Meshes with the samples of one grid that they are drawn at.
struct CollectedViews {
    std::deque<RayMesh> meshes;
    std::deque<FacetSamples> owned;

    void add(RayMesh mesh, FacetSamples samples) {
        if (samples.sample.empty()) return;
        meshes.push_back(std::move(mesh));
        owned.push_back(std::move(samples));
    }
    /// As a race takes them; they must live longer.
    std::vector<RaceView> views() const {
        std::vector<RaceView> all;
        for (std::size_t i = 0; i < meshes.size(); ++i) all.push_back({&meshes[i], &owned[i]});
        return all;
    }
};

/// Puts the bands' parts together: a mesh that comes again with other samples is one mesh. Holds what is
/// collected and nothing of the picture.
class ViewCollector {
  public:
    /// `film`: the grid of the whole picture.
    explicit ViewCollector(const SampleGrid& film) : film_(film) {}

    /// The samples of `owned` count in `part`, a window of the film; parts come from the top.
    void add(const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& part);

    /// All so far; the collector is empty then.
    CollectedViews take();

  private:
    struct Part {
        RayMesh mesh;
        std::vector<std::pair<Id, Id>> owned;  // facet, sample of the film
    };
    SampleGrid film_;
    std::deque<Part> parts_;
};

// What a race on a scene came to, as text and as JSON.

/// A table for people.
std::string race_text(const BenchResult& bench);

/// One JSON object of schema trilens.bench/1: times in milliseconds, ratios above 1 where the projector is
/// faster.
std::string race_json(const BenchResult& bench);

}  // namespace trilens_bench
