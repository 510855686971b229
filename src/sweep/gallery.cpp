#include "sweep/gallery.h"

#include <optional>

#include "report/html.h"
#include "report/text.h"
#include "sweep/fit_runs.h"
#include "sweep/sweep_folder.h"
#include "sweep/sweep_pictures.h"
#include "sweep/sweep_plots.h"

namespace trilens {
namespace {

/// The finest run that was finished.
const RunRecord* finest_run(const SweepSummary& summary) {
    const RunRecord* finest = nullptr;
    for (const RunRecord& run : summary.runs)
        if (run.state == RunState::kDone && (!finest || run.plan.n() > finest->plan.n())) finest = &run;
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
    for (const SweepFit& fit : summary.fits)
        if (fit.optic == "all" && fit.metric == "disp_mean_px" && fit.order)
            facts.emplace_back(fit.layer + ", order of convergence", rounded_text(*fit.order, 3));
    for (const std::string& layer : layers_of(summary))
        if (const SweepFit* off = find_fit_off_folds(summary.fits, layer, "all"); off && off->order)
            facts.emplace_back(layer + ", order off the folds", rounded_text(*off->order, 3));
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
    entry.text = point_text(run->plan.at) + ", optics: " + summary.manifest.subject.mesh;
    entry.metrics = facts_of(summary, *run);
    TruthPictures truths(summary.folder);
    entry.pictures = run_pictures(summary.folder, *run, truths);
    return entry;
}

}  // namespace

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
    if (!summaries.empty()) gallery.versions = summaries.front().manifest.subject.versions;
    write_gallery(folder + "/report.html", gallery);
}

}  // namespace trilens
