// What a sweep's folder says, as plain data: the manifest, one record per run, the fits.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/util/ids.h"
#include "report/text.h"
#include "sweep/store/axis.h"

namespace trilens {

/// Values by their column name in runs.csv ("rgb_rmse", "disp_mean_px"); absent means not computed, NaN means
/// computed and not a number.
using MetricValues = std::map<std::string, double>;

/// The value of a column; none where it was not computed.
inline std::optional<double> find_value(const MetricValues& metrics, const std::string& name) {
    const auto found = metrics.find(name);
    return found == metrics.end() ? std::nullopt : std::optional(found->second);
}

/// An optic whose displacement is measured by itself.
struct SweptOptic {
    Id object = kNone;  // as in optic.object
    std::string name;
    bool operator==(const SweptOptic&) const = default;
};

/// A scene of several that is not swept, because it lacks what an axis varies.
struct LeftOutScene {
    std::string scene;   // file
    std::string reason;  // one line, with the scene's name
    bool operator==(const LeftOutScene&) const = default;
};

/// What is swept, in words and names: goes into every result and changes no number.
struct SweepSubject {
    std::string title;         // of the report
    std::string scene;         // file
    std::string scene_name;    // what tells scenes of one folder apart: file and overrides; empty: scene
    std::string scene_digest;  // of all that the scene holds; empty: not known
    std::string camera, mesh, method, truth;  // CSV columns: "main", "pawn", "exact", "limit"
    int spp = 1;
    std::vector<std::string> commands;  // lines that make the results again
    Facts versions;
    std::vector<LeftOutScene> left_out = {};  // of an axis of scenes
};

/// Whose folder it is, and what is varied.
struct SweepManifest {
    SweepSubject subject;
    SweepAxes axes;
};

/// One line of plan.jsonl.
struct PlannedRun {
    std::string id;  // "n0008", "classic_n0008": the folder's name under runs/
    Coordinates at;
    std::string hash;                     // of everything that the run's result depends on
    std::string truth;                    // of everything that its truth depends on: truth_file
    std::vector<SweptOptic> optics = {};  // whose displacement is measured; not part of the file

    /// The resolution, 0 where it is no axis.
    int n() const {
        const AxisValue* value = find_coordinate(at, "resolution");
        return value && value->number ? static_cast<int>(*value->number) : 0;
    }
};

/// How far what one layer of one optic shows lies from where the truth shows it.
struct OpticDisplacement {
    std::string layer;  // "reflect", "refract"
    std::string optic;  // its name, or "all"
    // disp_{mean,p50,p95,p99,max,mean_off_folds}_px,
    // disp_{pixels,lost,unmeasured,beyond_radius,missing,near_folds} and disp_coverage (0..1): see
    // Displacement
    MetricValues metrics;
};

/// Whether `one` is the only optic of its layer: then what is said of all optics is said of it.
inline bool is_only_optic(const std::vector<OpticDisplacement>& all, const OpticDisplacement& one) {
    std::size_t in_layer = 0;
    for (const OpticDisplacement& other : all) in_layer += other.layer == one.layer;
    return in_layer == 2 && one.optic != "all";
}

enum class RunState { kMissing, kDone, kFailed };

/// "done", "failed", "missing": as in runs.csv.
inline const char* state_name(RunState state) {
    return state == RunState::kDone ? "done" : state == RunState::kFailed ? "failed" : "missing";
}

/// The coordinates of a point but for one axis.
inline Coordinates without_axis(Coordinates point, const std::string& axis) {
    std::erase_if(point, [&](const Coordinate& one) { return one.axis == axis; });
    return point;
}

/// A run as its folder tells it.
struct RunRecord {
    PlannedRun plan;
    RunState state = RunState::kMissing;
    MetricValues metrics;
    std::vector<OpticDisplacement> displacement;
    std::vector<std::string> warnings;
    std::string error;  // of a failed run
    int exit_code = 0;  // of a failed run
    std::string image_hash;
};

/// One measurement of a fit.
struct SweepPoint {
    double n = 0;  // along SweepFit::axis
    double value = 0;
    bool used = false;  // took part in the fit
};

/// error = constant * n^-order over the runs of one group: those that differ along `axis` alone.
struct SweepFit {
    std::string axis = "resolution";                 // whose numbers are n
    Coordinates group;                               // what the runs have in common along the other axes
    std::string layer, optic;                        // layer is empty for metrics of the whole picture
    std::string metric;                              // column name
    std::vector<SweepPoint> points;                  // every finished run that has the metric
    std::optional<double> order, constant, r2;       // none: fewer than two usable points
    std::optional<double> order_low, order_high;     // 95 % confidence; none: fewer than three points
    std::optional<double> n_for_1px, n_for_half_px;  // metrics in pixels only
    // The least share of an optic's pixels that a run behind the law measured, 0..1; metrics in pixels only.
    std::optional<double> coverage;
};

struct SweepSummary {
    std::string folder;
    SweepManifest manifest;
    std::vector<RunRecord> runs;
    std::vector<SweepFit> fits;
    std::size_t other_runs =
        0;  // finished ones of an earlier plan, which stay in the folder and out of all tables

    std::size_t count(RunState state) const {
        std::size_t found = 0;
        for (const RunRecord& run : runs) found += run.state == state;
        return found;
    }
};

/// Where a sweep keeps what, under its folder.
inline std::string truth_file(const std::string& folder, const std::string& hash) {
    return folder + "/truth/" + hash + ".exr";
}
inline std::string run_folder(const std::string& folder, const std::string& id) {
    return folder + "/runs/" + id;
}

// The JSON Schema of summary.json: what its fields mean.

/// JSON Schema (draft 7), as text.
const char* summary_schema();

}  // namespace trilens
