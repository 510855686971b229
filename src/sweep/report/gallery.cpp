#include "sweep/report/gallery.h"

#include <filesystem>
#include <optional>
#include <system_error>

#include "base/files/files.h"
#include "report/page.h"
#include "report/text.h"
#include "sweep/report/sweep_pictures.h"
#include "sweep/report/sweep_report.h"
#include "sweep/store/sweep_folder.h"

namespace trilens {
namespace {

/// How fine a run is: its number along the first axis whose values errors follow, such as the resolution.
double fineness(const SweepAxes& axes, const RunRecord& run) {
    for (const Axis& axis : axes.axes)
        if (const AxisValue* const value = find_coordinate(run.plan.at, axis.kind.name);
            axis.kind.is_scale && value)
            return value->number.value_or(0);
    return 0;
}

/// The finest run that was finished.
const RunRecord* finest_run(const SweepSummary& summary) {
    const RunRecord* finest = nullptr;
    const SweepAxes& axes = summary.manifest.axes;
    for (const RunRecord& run : summary.runs)
        if (run.state == RunState::kDone && (!finest || fineness(axes, run) > fineness(axes, *finest)))
            finest = &run;
    return finest;
}

Facts facts_of(const SweepSummary& summary, const RunRecord& run) {
    Facts facts;
    for (const OpticDisplacement& one : run.displacement) {
        if (one.optic != "all") continue;
        if (const std::optional<double> mean = find_value(one.metrics, "disp_mean_px"))
            facts.emplace_back(one.layer + ", mean displacement where measured",
                               rounded_text(*mean, 3) + " px");
        facts.emplace_back(one.layer + ", measured", measured_text(one.metrics));
    }
    // Of the fits, those along the shown run's own group.
    for (const SweepFit& fit : summary.fits) {
        if (fit.optic != "all" || fit.metric != "disp_mean_px" || !fit.order) continue;
        if (fit.group != without_axis(run.plan.at, fit.axis)) continue;
        facts.emplace_back(fit.layer + ", order of the mean displacement", rounded_text(*fit.order, 3));
        const SweepFit* const off = find_fit_off_folds(summary.fits, fit.layer, "all", &fit.group);
        if (off && off->order)
            facts.emplace_back(fit.layer + ", order off the folds", rounded_text(*off->order, 3));
    }
    return facts;
}

GalleryEntry entry_of(const SweepSummary& summary) {
    const std::string& title = summary.manifest.subject.title;
    GalleryEntry entry;
    entry.title = title;
    entry.link = title + "/report.html";
    for (const NamedPlot& plot : make_plots(summary))
        if (entry.plot.empty()) entry.plot = plot_svg(plot.drawing);
    const RunRecord* run = finest_run(summary);
    if (!run) {
        entry.text = "No run was finished.";
        return entry;
    }
    const SweepSubject& subject = summary.manifest.subject;
    entry.text = point_text(run->plan.at) +
                 (subject.mesh.empty() ? ", camera: " + subject.camera : ", optics: " + subject.mesh);
    entry.metrics = facts_of(summary, *run);
    TruthPictures truths(summary.folder);
    entry.pictures = run_pictures(summary.folder, *run, truths);
    return entry;
}

std::string left_out_file(const std::string& folder) {
    return folder + "/left-out.json";
}

}  // namespace

void keep_left_out(const std::string& folder, const std::vector<LeftOutScene>& left_out) {
    std::error_code none;
    if (!left_out.empty()) {
        std::filesystem::create_directories(folder, none);
        replace_text_file(left_out_file(folder), left_out_text(left_out));
    } else if (!left_out_of_gallery(folder).empty()) {
        std::filesystem::remove(left_out_file(folder), none);
    }
}

void write_sweep_gallery(const std::string& folder, std::span<const SweepSummary> summaries) {
    require_no_sweep(folder);
    Gallery gallery;
    gallery.title = "trilens: curved mirrors and glass by projection";
    gallery.text =
        "Each scene as projected at its finest resolution and as ray traced, with a slider between the two, "
        "how "
        "far what is seen moved, how far the colours differ, and how the displacement falls with the "
        "resolution. A click on a title leads to all runs of the scene.";
    for (const SweepSummary& summary : summaries) {
        gallery.entries.push_back(entry_of(summary));
        for (const std::string& command : summary.manifest.subject.commands)
            gallery.commands.push_back(command);
    }
    for (const LeftOutScene& one : left_out_of_gallery(folder))
        gallery.warnings.push_back(left_out_words(one));
    if (!summaries.empty()) gallery.versions = summaries.front().manifest.subject.versions;
    write_gallery(folder + "/report.html", gallery);
}

std::vector<LeftOutScene> left_out_of_gallery(const std::string& folder) {
    std::error_code none;
    const std::string file = left_out_file(folder);
    return std::filesystem::exists(file, none) ? read_left_out(file) : std::vector<LeftOutScene>();
}

}  // namespace trilens
