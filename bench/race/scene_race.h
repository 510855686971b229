// How fast the projector draws a scene's rays, against Embree's packets on the same rays in the same run.
#pragma once

#include <string>

#include "base/util/progress.h"
#include "bench/race/race.h"
#include "render/frame/request.h"
#include "scene/data/scene.h"

namespace trilens_bench {

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

}  // namespace trilens_bench
