// Which files of a folder a sweep wrote: cleaning removes no others.
#pragma once

#include <set>
#include <span>
#include <string>
#include <vector>

#include "sweep/store/results.h"

namespace trilens {

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

}  // namespace trilens
