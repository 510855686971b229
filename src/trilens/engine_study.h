// How the classic engine's picture comes near the exact one, and what its clipping leaves uncovered.
//
//     trilens::StudyRequest request;
//     request.scenes = {{"scene.json", {}, 2}};
//     request.folder = "results/engines";
//     for (const trilens::StudyRow& row : trilens::study_engines(request).curves)
//         std::printf("%s: %zu pixels differ\n", row.scene.c_str(), row.differing);
#pragma once

#include <string>
#include <vector>

#include "projector/classic/classic_params.h"
#include "trilens/scene.h"
#include "trilens/sweep.h"

namespace trilens {

/// One way to draw one scene, compared with the exact engine pixel by pixel.
struct StudyRow {
    std::string scene;
    std::string resolution;  // of each optic, separated by blanks
    ClassicParams params;
    std::size_t pixels = 0, optic_pixels = 0;
    std::size_t differing = 0, direct = 0, reflect = 0, refract = 0;  // pixels
    std::size_t uncovered = 0;  // where the exact engine sees something that the classic one sees nothing for
    double exact_seconds = 0, classic_seconds = 0;

    double share() const {
        return pixels > 0 ? static_cast<double>(differing) / static_cast<double>(pixels) : 0;
    }
};

struct StudyRequest {
    std::vector<SceneRequest> scenes;
    std::string camera;  // empty: each scene's own
    std::string folder;
};

struct EngineStudy {
    std::vector<StudyRow> curves;    // slices, tessellation and arcs at the scene's resolution
    std::vector<StudyRow> clipping;  // both ways to clip, at several resolutions
    std::vector<std::string> files;
};

/// Draws every scene in every way and writes engines.csv, clipping.csv and plots/ to the folder, after each
/// scene. What would cut a scene into too many triangles is left out with a warning. Throws as
/// require_distinct_names and run_sweep do.
EngineStudy study_engines(const StudyRequest& request, const SweepTalk& talk = {});

}  // namespace trilens
