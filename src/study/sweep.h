// What a sweep can vary: each axis by its name, with what a value does to the request to render.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/util/error.h"
#include "render/frame/request.h"
#include "study/scenes.h"
#include "sweep/report/gallery.h"
#include "sweep/run/farm_scripts.h"
#include "sweep/store/axis.h"
#include "sweep/store/results.h"

namespace trilens {

/// A request to render, as the point of a sweep makes it; the library's own calls take it from here.
struct PointRequest {
    SceneRequest scene;
    std::shared_ptr<const Scene> loaded = {};  // instead of `scene`, while that names no file
    std::string camera;                        // empty: the scene's own
    std::string optic;                         // empty: all; else the one that the scene keeps
    // A value of a key of every optic: "normals" and its JSON text.
    std::vector<std::pair<std::string, std::string>> of_optics = {};
    int camera_facets = 0;  // of the camera's own mesh, N x N; 0: as the scene says
    PictureRequest picture = {};
    std::string paths_start_here =
        {};  // folder of scene files that an axis names; empty: where the program runs
};

/// Every axis but the JSON pointers, in the order in which help names them.
std::vector<AxisKind> axis_kinds();

/// The kind of this name; any JSON pointer is one. Throws UsageError that starts with `where`, with the
/// nearest name.
AxisKind find_axis_kind(const std::string& name, const std::string& where);

/// Makes the point of its base: each coordinate in its turn. Throws UsageError, also for a value without the
/// number that its axis needs.
PointRequest request_at(PointRequest base, const Coordinates& point);

/// The point's scene. Throws as load_scene does; UsageError where a point would change the text of a scene in
/// memory; InputError where no optic has the point's name, or where the camera has no facets to choose.
Scene load_point_scene(const PointRequest& request);

// Sweeps of scenes: a request made into runs, each drawn and traced.

/// What is swept, against which truth, and where the results go.
struct SweepRequest {
    SceneRequest scene;           // read from a file, which may be empty where an axis names scenes; unless:
    std::optional<Scene> loaded;  // one in memory, read or built before; `scene` is not looked at, and axes
                                  // cannot change it
    std::string camera;           // empty: the scene's own
    // What is varied: axis_kinds() or any JSON pointer into the scene.
    std::vector<AxisRequest> over = {{"resolution", {"1..16:x2"}}};
    bool zip = false;             // the axes' values pair by pair, not every combination
    std::string truth = "limit";  // or "facets"
    std::string shard = "0/1";    // part i of n, or "auto" in a job array
    int jobs = 1;                 // runs at once; their times say little
    int repeats = 1;              // measured drawings of each picture
    double memory_limit = 0;      // bytes that the runs at work may need together; 0: most of what is free
    std::string folder;
    std::string scenes_folder;  // where scene files that an axis names start; empty: where the program runs
    std::string sweep_file;     // that the request was read from; empty: none
    bool replace = false;  // starts the folder afresh, whichever sweep it belongs to; files that no sweep
                           // wrote stay
    std::string title;     // of the report; empty: the scene's own name
    std::string command;   // what makes the sweep again, for the report; may be empty
};

/// How a sweep says what it does; both may be empty. `progress`: made for a job of that name.
struct SweepObserver {
    std::function<Progress(const std::string& job)> progress;
    Warn warn;
};

/// Does what is not done yet, then sums up and reports (a part of several sums up nothing). A run that fails
/// is recorded, and the others go on. Results of another scene content, truth or build of this library are
/// not trusted. A scene in memory is known by its label; without one by all that it holds, so that a changed
/// one is another sweep's. Several processes may do one sweep in one folder at once. Throws UsageError for a
/// text that says no axis, truth or shard, for two points of one name, for an axis that a scene in memory
/// cannot have, and for a folder that belongs to another sweep (of another scene or other overrides, camera,
/// truth or axes; the lists of values may differ) or where files would be written over that no sweep made or
/// that this one reads, InputError where a scene has no optic or cannot be read,
/// OutputError, Interrupted. A scene file without an optic is swept over its camera's facets where the axis
/// is resolution and the camera chooses them; of an axis of scenes those that lack what another axis varies
/// are left out while others are left. Both are said, and SweepSubject::left_out has the latter.
SweepSummary run_sweep(const SweepRequest& request, const SweepObserver& observer = {});

/// Why run_sweep would refuse the request for what its scene lacks (an optic, a camera, a place in the file
/// that an axis names); none where it would not. For sweeps of many scenes, none of which should end for
/// one. Throws as run_sweep does for what no scene could mend, and where the scene cannot be read.
std::optional<LeftOutScene> why_left_out(const SweepRequest& request);

/// The request that a sweep file makes of `base`: what the file leaves out stays. Paths in the file start at
/// its folder. Throws InputError with the place of the first problem.
SweepRequest read_sweep_file(const std::string& file, SweepRequest base);

/// Whether the file is meant as a sweep: a JSON object with "over" in it. False for what cannot be read.
bool is_sweep_file(const std::string& file);

/// The JSON Schema (draft 7) of sweep files, as text.
std::string sweep_schema();

/// Whether one process does all of it. Throws UsageError as run_sweep does.
bool is_whole_sweep(const std::string& shard);

/// Writes the plan and runs nothing; returns the plan's file.
std::string plan_sweep(const SweepRequest& request, const SweepObserver& observer = {});

/// Throws UsageError where two of the files have one name but for folder and end: their results would write
/// over each other; and for "-", which cannot be read more than once.
void require_distinct_names(std::span<const std::string> scenes);

/// Throws UsageError where the folder is one sweep's own: a gallery of several would write over its report.
void require_no_sweep(const std::string& folder);

/// What a sweep's folder says, with fits; writes nothing. Throws InputError where there is no plan in it.
SweepSummary load_sweep(const std::string& folder);

/// The same, and writes tables, plots and report.html.
SweepSummary report_sweep(const std::string& folder);

}  // namespace trilens
