// The folder of a sweep: whose it is, which files in it are the sweep's, and how they are written and read.
#pragma once

#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/image/image.h"
#include "base/util/error.h"
#include "measure/displacement/image_finder.h"
#include "sweep/store/results.h"

namespace trilens {

// Whose a sweep's folder is: one sweep's, and as many processes of it as there are, by locks.

// Locks between processes that share a sweep's folder.

/// kOne: one holder alone. kMany: any number of holders, but none of kOne.
enum class LockKind { kOne, kMany };

/// A lock on a file, held until it is destroyed. The system frees it when the process ends, however it ends;
/// the empty file stays and means nothing. Two holders in one process exclude each other as two processes do.
class FileLock {
  public:
    /// None while another holder is in the way. Makes the file. Throws OutputError where it cannot be made or
    /// the file system has no locks.
    static std::optional<FileLock> try_lock(const std::string& file, LockKind kind);

    /// Waits for the other holders to end. Throws Interrupted once `progress` says so, and as try_lock does.
    static FileLock wait(const std::string& file, LockKind kind, const Progress& progress);

    /// Lets others of LockKind::kMany in beside the holder. Throws OutputError.
    void share();

    ~FileLock();
    FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    FileLock& operator=(FileLock&& other) noexcept {
        std::swap(descriptor_, other.descriptor_);
        return *this;
    }

  private:
    explicit FileLock(int descriptor) : descriptor_(descriptor) {}
    int descriptor_;
};

/// Whether two manifests tell of one sweep, so that their results may lie in one folder: the same axis,
/// camera and truth, of the same scene by its name or by what it holds. The values along the axis are free.
bool is_same_sweep(const SweepManifest& a, const SweepManifest& b);

/// Makes the folder the sweep's and writes its manifest and plan. The lock keeps the folder the sweep's until
/// it is destroyed; other processes of the same plan share it. Throws UsageError where it holds another
/// sweep or a gallery of sweeps, or files of a sweep's names that are none's, or where a process is at another
/// plan of this sweep; InputError where it holds a manifest that cannot be read, OutputError.
FileLock claim_folder(const std::string& folder, const SweepManifest& manifest,
                      const std::vector<PlannedRun>& plan, const Progress& progress);

/// The finished runs that lie in the folder and are not in the plan, as an earlier one left them: they stay,
/// and are in no table.
std::size_t count_other_runs(const std::string& folder, const std::vector<PlannedRun>& plan);

/// Removes all that sweeps write from a sweep's folder, and nothing else, as remove_own_files does; does
/// nothing to other folders. Throws UsageError while a process is at work in it, OutputError.
void clear_folder(const std::string& folder);

/// The file whose lock a process holds while it reads and writes the manifest, or writes the report.
std::string plan_lock(const std::string& folder);

/// Throws UsageError where a gallery would write over a report: the folder is a sweep's own, or holds one
/// and no sweeps below it.
void require_no_sweep(const std::string& folder);

// Which files of a folder a sweep wrote: cleaning removes no others.

/// Throws UsageError where a file of a sweep's fixed names (runs.csv, report.html, ...) lies in a folder that
/// no sweep has claimed yet.
void require_no_foreign_files(const std::string& folder);

/// Throws UsageError where the sweep would write over one of its `inputs`: its fixed names, the files of its
/// runs, truths, and the pictures of its report.
void require_inputs_apart(const std::string& folder, const std::vector<PlannedRun>& plan,
                          std::span<const std::string> inputs);

/// Begins the lists that OwnReportFiles keeps, where there are none: all of them, or the one for a folder.
void begin_report_lists(const std::string& folder);
void begin_report_list(const std::string& folder, const std::string& below);

/// Removes the files of runs, truths and reports, and the fixed names, the manifest last; folders where
/// nothing else is left in them. `is_sweep`: that the manifest tells of a sweep; otherwise the fixed names go
/// only where a list of OwnReportFiles lies beside them. Throws OutputError.
void remove_own_files(const std::string& folder, bool is_sweep);

/// The files of a report in one folder below the sweep's ("plots", "pictures"). A list beside that folder
/// ("plots.list") names them, so that a later report knows them from the files of others. One report at a
/// time.
class OwnReportFiles {
  public:
    OwnReportFiles(const std::string& folder, const std::string& below);

    /// Makes the folder and notes the names, before the files are written. Throws OutputError where one of
    /// them is there already and no report wrote it.
    void will_write(const std::vector<std::string>& names);

    /// Removes what an earlier report wrote and this one did not, and the folder where nothing is left.
    /// Throws OutputError.
    void remove_others();

  private:
    void write_list() const;

    std::string home_, list_;
    bool has_list_;  // without one, as earlier versions left it, what has a report's name is a report's
    std::set<std::string> earlier_, now_;
};

// The files of one run: what makes it finished, and what it then says; its picture against the truth, as the
// columns of a sweep.

// One run's image against the truth, as the columns of a sweep.

struct MeasuredRun {
    MetricValues metrics;  // rgb_*, disp_* (of the worse layer, all optics), mismatches, nonfinite, failed_px
    std::vector<OpticDisplacement> displacement;  // each layer that the images have: all optics, then each
    std::vector<std::string> warnings;            // what could not be measured, and why
    Image diff;
};

/// Compares `test` with `truth`. Throws InputError where they cannot be compared.
MeasuredRun measure_run(const Image& test, const ReferenceLayers& truth,
                        const std::vector<SweptOptic>& optics);

/// The length of the displacement at each pixel of a diff image's data window.
struct DisplacementMap {
    std::string layer;
    std::vector<float> pixels;  // NaN: nothing to measure; infinite: lost
};

/// The maps that a diff image of measure_run holds.
std::vector<DisplacementMap> displacement_maps(const Image& diff);

// The files of one run: what makes it finished, and what it then says.

/// The file whose lock (file_lock.h) a process holds while it does or judges the run. Throws OutputError.
std::string run_lock(const std::string& folder, const PlannedRun& plan);

/// Tells apart the failures that the folder keeps of this run, one after the other; empty where it keeps
/// none.
std::string failure_stamp(const std::string& folder, const PlannedRun& plan);

/// What the folder says of this run. Finished only where DONE holds plan.hash and the hashes of files that
/// are as they were written; any damage makes it missing.
RunRecord load_run(const std::string& folder, const PlannedRun& plan);

/// Makes the run unfinished, before it is done again. A failure stays told until the new attempt has ended,
/// so that who sums up meanwhile does not miss the run. Throws OutputError.
void clear_run(const std::string& folder, const PlannedRun& plan);

/// Writes the run's picture and returns the seconds that took. The run is not finished by it. Throws
/// OutputError.
double store_image(const std::string& folder, const PlannedRun& plan, const Image& image);

/// The hash of the picture that store_image wrote. Throws OutputError where it cannot be read back.
std::string hash_of_image(const std::string& folder, const PlannedRun& plan);

/// Writes the difference, metrics.json and last DONE, then forgets an earlier failure. `run.image_hash` is
/// hash_of_image. Throws OutputError.
void store_run(const std::string& folder, const RunRecord& run, const Image& diff);

/// Writes error.json. Throws OutputError.
void store_failure(const std::string& folder, const RunRecord& run);

// Reading and writing of a sweep's JSON files, with checks for damage.

std::string manifest_text(const SweepManifest& manifest, const std::vector<PlannedRun>& plan);
std::string plan_text(const std::vector<PlannedRun>& plan);

/// metrics.json of a finished run, error.json of a failed one.
std::string run_text(const RunRecord& run);

std::string summary_text(const SweepSummary& summary);

/// left-out.json of a gallery.
std::string left_out_text(const std::vector<LeftOutScene>& scenes);

/// Throw InputError(file, ...) where the text is damaged or of another kind.
std::vector<LeftOutScene> read_left_out(const std::string& file);
SweepManifest read_manifest(const std::string& file);
std::vector<PlannedRun> read_plan(const std::string& file, const SweepAxes& axes);

/// Fills everything but plan and image_hash from run_text; none where the text is damaged or tells of another
/// run.
std::optional<RunRecord> parse_run(const std::string& text, const PlannedRun& plan);

// runs.csv and displacement.csv: one row per run, and one row per run, optic and layer;
// "all" alone where a layer has one optic.

/// One row per run under the columns of the interface that any run has something for, and behind the id one
/// for each axis that has none there. Numbers are the
/// shortest that read back; an empty cell was not computed, "nan" was. Cells with commas, quotes or line ends
/// are quoted as in RFC 4180.
std::string runs_csv(const SweepSummary& summary);

/// One row per finished run, layer and optic ("all" included) with its displacement.
std::string displacement_csv(const SweepSummary& summary);
/// The heading of an axis's values in tables that have a column for optics by themselves: "swept_optic" of
/// the axis "optic".
std::string swept_column(const std::string& axis);

}  // namespace trilens
