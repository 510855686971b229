// Sweeps: the error of the projection over the resolution of the optics, in a folder that can be resumed.
//
//     trilens::SweepRequest request;
//     request.scene.file = "scene.json";
//     request.over = "resolution=1..16:x2";
//     request.folder = "results/scene";
//     const trilens::SweepSummary summary = trilens::run_sweep(request);
//     for (const trilens::SweepFit& fit : summary.fits)
//         if (fit.order) std::printf("%s %s: order %g\n", fit.layer.c_str(), fit.metric.c_str(), *fit.order);
//
//     request.loaded = trilens::parse_scene(trilens::scene_examples()[0].json);  // one in memory
//     request.folder = "results/memory";
//     trilens::plan_sweep(request);
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "base/progress.h"
#include "sweep/gallery.h"
#include "sweep/results.h"
#include "trilens/scene.h"

namespace trilens {

/// What is swept, against which truth, and where the results go.
struct SweepRequest {
    SceneRequest scene;           // read from a file, unless:
    std::optional<Scene> loaded;  // one in memory, read or built before; `scene` is not looked at
    std::string camera;           // empty: the scene's own
    std::string over = "resolution=1..16:x2";  // "resolution=1,2,4" or "resolution=1..64:x2"
    std::string truth = "limit";               // or "facets"
    std::string shard = "0/1";                 // part i of n, or "auto" in a job array
    std::string folder;
    bool replace = false;  // starts the folder afresh, whichever sweep it belongs to
    std::string title;     // of the report; empty: the scene's own name
    std::string command;   // what makes the sweep again, for the report; may be empty
};

/// How a sweep says what it does; both may be empty. `progress`: made for a job of that name.
struct SweepTalk {
    std::function<Progress(const std::string& job)> progress;
    Warn warn;
};

/// Does what is not done yet, then sums up and reports (a part of several sums up nothing). A run that fails
/// is recorded, and the others go on. Results of another scene content, truth or build of this library are
/// not trusted. A scene in memory is known by its label; without one by all that it holds, so that a changed
/// one is another sweep's. Several processes may do one sweep in one folder at once. Throws UsageError for a
/// text that says no axis, truth or shard, and for a folder that belongs to another sweep (of another scene
/// or other overrides, camera, truth or axis; the list of values may differ), InputError where the scene has
/// no optic or cannot be read, OutputError, Interrupted.
SweepSummary run_sweep(const SweepRequest& request, const SweepTalk& talk = {});

/// Whether one process does all of it. Throws UsageError as run_sweep does.
bool is_whole_sweep(const std::string& shard);

/// Writes the plan and runs nothing; returns the plan's file.
std::string plan_sweep(const SweepRequest& request, const SweepTalk& talk = {});

/// Throws UsageError where the folder is one sweep's own: a gallery of several would write over its report.
void require_no_sweep(const std::string& folder);

/// What a sweep's folder says, with fits; writes nothing. Throws InputError where there is no plan in it.
SweepSummary load_sweep(const std::string& folder);

/// The same, and writes tables, plots and report.html.
SweepSummary report_sweep(const std::string& folder);

}  // namespace trilens
