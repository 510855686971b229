#include "sweep/run/run_one.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "base/util/progress.h"
#include "sweep/report/sweep_pictures.h"
#include "sweep/store/machine.h"
#include "sweep/store/measure_run.h"
#include "sweep/store/run_files.h"

namespace trilens {
namespace {

/// "trilens:facets" of the header, where render says it.
std::optional<double> facet_count(const Image& image) {
    const auto found = image.metadata.find("trilens:facets");
    double count = 0;
    if (found == image.metadata.end()) return std::nullopt;
    const std::string& text = found->second;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), count);
    return end.ec == std::errc() ? std::optional(count) : std::nullopt;
}

/// What goes wrong in `work` is the run's failure.
void attempt(RunRecord& run, const std::function<void()>& work) {
    run.state = RunState::kFailed;
    try {
        work();
        run.state = RunState::kDone;
    } catch (const Interrupted&) {
        throw;
    } catch (const Error& error) {
        run.exit_code = static_cast<int>(error.code());
        run.error = error.what();
    } catch (const std::bad_alloc&) {
        run.exit_code = static_cast<int>(ExitCode::kComputation);
        run.error = "out of memory";
    }
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    const std::size_t half = values.size() / 2;
    return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
}

/// Draws as often as asked for, and says in `metrics` what that took.
Image draw_timed(const RunJob& job, MetricValues& metrics) {
    const bool is_alone = job.params.jobs <= 1;
    const bool has_peak = is_alone && reset_peak_memory();
    const MachineWatch machine;
    std::vector<double> totals;
    std::map<std::string, std::vector<double>> stages;
    Image image;
    const bool is_repeated = job.params.repeats > 1;
    for (int repeat = is_repeated ? -1 : 0; repeat < std::max(1, job.params.repeats); ++repeat) {
        const Stopwatch watch;
        DrawnPicture drawn = job.callbacks.render(job.plan);
        const double seconds = watch.seconds();
        image = std::move(drawn.image);
        if (repeat < 0) {
            metrics["t_first_s"] = seconds;
            continue;
        }
        totals.push_back(seconds);
        for (const auto& [stage, part] : drawn.seconds) stages[stage].push_back(part);
    }
    metrics["t_total_s"] = median(totals);
    for (const auto& [stage, parts] : stages) metrics["t_" + stage + "_s"] = median(parts);
    metrics["repeats"] = static_cast<double>(totals.size());
    const auto [least, most] = std::ranges::minmax(totals);
    if (totals.size() > 1) metrics["t_spread_s"] = most - least;
    metrics["threads"] = thread_count();
    metrics["jobs"] = std::max(1, job.params.jobs);
    if (const auto others = machine.used_by_others()) metrics["machine_used_by_others"] = *others;
    if (has_peak)
        if (const auto peak = peak_memory_mib()) metrics["peak_rss_mb"] = *peak;
    return image;
}

/// Measures a picture into `run`, which has its times, and returns what it differs in.
Image measure(const RunJob& job, const KeptTruth& truth, const Image& image, RunRecord& run) {
    MeasuredRun measured = measure_run(image, truth.layers, job.plan.optics);
    measured.metrics.merge(run.metrics);
    run.metrics = std::move(measured.metrics);
    run.displacement = std::move(measured.displacement);
    run.warnings = std::move(measured.warnings);
    run.metrics["t_trace_s"] = truth.seconds;
    run.metrics["width"] = image.width;
    run.metrics["height"] = image.height;
    if (const std::optional<double> facets = facet_count(image)) run.metrics["facets"] = *facets;
    return std::move(measured.diff);
}

/// Without room for them the report makes them of the run's files.
void keep_pictures(const RunRecord& run, const RunImages& images, KeptPictures& pictures) {
    try {
        pictures.make(run, images);
    } catch (const std::bad_alloc&) {
        return;
    }
}

}  // namespace

std::optional<RunRecord> do_run(const RunJob& job) {
    RunRecord run;
    run.plan = job.plan;
    std::shared_ptr<const KeptTruth> truth;
    // Without the truth that all runs share none can be done; one of its own is a part of the run.
    if (job.shares_one_truth)
        truth = job.truths.get(job.plan, job.may_wait);
    else
        attempt(run, [&] { truth = job.truths.get(job.plan, job.may_wait); });
    if (!truth && run.error.empty()) return std::nullopt;

    clear_run(job.params.folder, job.plan);
    Image image, diff;
    std::string image_hash;
    if (truth) attempt(run, [&] { image = draw_timed(job, run.metrics); });
    if (run.state == RunState::kDone) {
        run.metrics["t_write_s"] = store_image(job.params.folder, job.plan, image);
        // What is timed had the machine to itself; from here on all is done side by side.
        run_side_by_side({[&] { attempt(run, [&] { diff = measure(job, *truth, image, run); }); },
                          [&] { image_hash = hash_of_image(job.params.folder, job.plan); }});
    }
    if (run.state == RunState::kDone) {
        run.image_hash = std::move(image_hash);
        run_side_by_side({[&] { store_run(job.params.folder, run, diff); },
                          [&] {
                              if (job.pictures)
                                  keep_pictures(run, {image, truth->image, diff}, *job.pictures);
                          }});
        return run;
    }
    run.metrics.clear();
    store_failure(job.params.folder, run);
    return run;
}

}  // namespace trilens
