// Rays that leave the optics, collected while a picture is drawn band by band.
#pragma once

#include <deque>
#include <utility>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "bench/race/race.h"

namespace trilens_bench {

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

}  // namespace trilens_bench
