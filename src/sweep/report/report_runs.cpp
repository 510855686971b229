#include "sweep/report/report_runs.h"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/files/file_bytes.h"
#include "base/util/format.h"
#include "base/util/parallel.h"
#include "sweep/report/report_text.h"
#include "sweep/report/sweep_pictures.h"
#include "sweep/report/sweep_plots.h"
#include "sweep/store/sweep_ownership.h"

namespace trilens {
namespace {

constexpr std::size_t kMostOpen = 12;  // runs; of more only titles show until they are opened
constexpr std::size_t kBatch = 64;     // runs whose pictures are made at once

Facts run_facts(const RunRecord& run) {
    Facts facts;
    for (const OpticDisplacement& one : run.displacement) {
        if (run.displacement.size() > 1 && one.optic == kAllOptics) continue;
        const std::string mean = value_text(one.metrics, "disp_mean_px");
        facts.emplace_back(one.layer + ", " + one.optic,
                           mean.empty() ? "no displacement could be measured"
                                        : "mean " + mean + " px, 95 % of the pixels within " +
                                              value_text(one.metrics, "disp_p95_px") + " px");
        facts.emplace_back(one.layer + ", " + one.optic + ", measured", measured_text(one.metrics));
    }
    facts.emplace_back("RGB RMSE", value_text(run.metrics, "rgb_rmse"));
    facts.emplace_back("largest colour difference", value_text(run.metrics, "rgb_max"));
    const std::string traced = value_text(run.metrics, "t_trace_s");
    facts.emplace_back("time", value_text(run.metrics, "t_total_s") + " s" +
                                   (traced.empty() ? "" : ", the truth by ray tracing " + traced + " s"));
    return facts;
}

ReportRun run_section(const std::string& folder, const RunRecord& run, TruthPictures& truths,
                      KeptPictures* kept) {
    ReportRun section;
    section.title = point_text(run.plan.at);
    section.warnings = run.warnings;
    if (run.state == RunState::kFailed) {
        section.error = "failed (exit code " + std::to_string(run.exit_code) + "): " + run.error;
        return section;
    }
    if (run.state == RunState::kMissing) {
        section.error = "not done yet";
        return section;
    }
    std::optional<std::vector<PagePicture>> made;
    if (kept) made = kept->take(run.plan);
    section.pictures = made ? std::move(*made) : run_pictures(folder, run, truths);
    section.facts = run_facts(run);
    return section;
}

std::size_t bytes_of(const ReportRun& run) {
    std::size_t bytes = 0;
    for (const PagePicture& picture : run.pictures) bytes += picture.png.size() * 4 / 3;
    return bytes;
}

/// Pictures as files beside the page, which then links them.
void put_beside(const std::string& folder, std::span<const RunRecord> runs, std::span<ReportRun> sections,
                OwnReportFiles& own) {
    std::vector<std::string> names;
    std::vector<PagePicture*> pictures;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        int count = 0;
        for (PagePicture& picture : sections[i].pictures) {
            if (picture.png.empty() || !picture.file.empty()) continue;
            names.push_back(fmt::format("{}-{}.png", runs[i].plan.id, ++count));
            pictures.push_back(&picture);
        }
    }
    own.will_write(names);
    for (std::size_t i = 0; i < names.size(); ++i) {
        pictures[i]->file = "pictures/" + names[i];
        replace_file(folder + "/" + pictures[i]->file, pictures[i]->png);
        pictures[i]->png.clear();
    }
}

}  // namespace

void fill_runs(const SweepSummary& summary, std::size_t most_bytes, Report& report, KeptPictures* kept) {
    const std::vector<RunRecord>& runs = summary.runs;
    report.runs.resize(runs.size());
    OwnReportFiles own(summary.folder, "pictures");
    TruthPictures truths(summary.folder);
    std::size_t bytes = 0, embedded = 0;
    for (std::size_t from = 0; from < runs.size(); from += kBatch) {
        const std::size_t to = std::min(runs.size(), from + kBatch);
        // Decoding and encoding pictures is most of a report's time.
        parallel_for(to - from, 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = from + first; i < from + last; ++i) {
                report.runs[i] = run_section(summary.folder, runs[i], truths, kept);
                report.runs[i].is_folded = runs.size() > kMostOpen;
                report.runs[i].row = static_cast<int>(i);
            }
        });
        for (std::size_t i = from; i < to; ++i) bytes += bytes_of(report.runs[i]);
        if (bytes <= most_bytes) continue;
        put_beside(summary.folder, std::span(runs).subspan(embedded, to - embedded),
                   std::span(report.runs).subspan(embedded, to - embedded), own);
        embedded = to;
    }
    own.remove_others();
    if (const std::size_t missing = summary.count(RunState::kMissing))
        report.warnings.push_back(std::to_string(missing) + " of the runs are not done yet");
    if (const std::size_t failed = summary.count(RunState::kFailed))
        report.warnings.push_back(std::to_string(failed) + " of the runs failed; each says why below");
    if (runs.size() > kMostOpen) report.pictures_note = "A click on a run shows its pictures. ";
    if (embedded > 0) report.pictures_note += "The pictures lie in the folder pictures beside this page. ";
}

}  // namespace trilens
