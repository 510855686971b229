#include "sweep/run/sweep.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "base/description/digest.h"
#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "image/image_io.h"
#include "report/text.h"
#include "sweep/report/sweep_pictures.h"
#include "sweep/store/machine.h"
#include "sweep/store/sweep_folder.h"

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

namespace {

/// Beside a truth: the seconds that tracing it took, and the hash of the image's bytes.
std::string seconds_file(const std::string& file) {
    return file + ".seconds";
}

/// None where it is not there or damaged: then it is traced again.
std::optional<Truth> read_truth(const std::string& file) {
    const std::optional<std::string> text = read_whole_file(seconds_file(file));
    if (!text) return std::nullopt;
    std::istringstream lines(*text);
    std::string seconds, hash;
    double value = 0;
    lines >> seconds >> hash;
    if (std::from_chars(seconds.data(), seconds.data() + seconds.size(), value).ec != std::errc())
        return std::nullopt;
    const std::optional<std::string> bytes = read_whole_file(file);
    if (!bytes || hash_text(*bytes) != hash) return std::nullopt;
    try {
        return Truth{read_exr(file), value};
    } catch (const InputError&) {
        return std::nullopt;
    }
}

}  // namespace

std::shared_ptr<const KeptTruth> TruthStore::find(const std::string& hash) {
    const std::lock_guard guard(mutex_);
    for (const auto& [known, truth] : kept_)
        if (known == hash) return truth;
    const auto failed = failures_.find(hash);
    if (failed != failures_.end()) std::rethrow_exception(failed->second);
    return nullptr;
}

std::shared_ptr<const KeptTruth> TruthStore::keep(const std::string& hash, Truth truth) {
    auto shared = std::make_shared<const KeptTruth>(std::move(truth));
    const std::lock_guard guard(mutex_);
    kept_.push_front({hash, shared});
    while (kept_.size() > kept_count_) kept_.pop_back();
    return shared;
}

std::shared_ptr<const KeptTruth> TruthStore::trace(const PlannedRun& run, const std::string& file) {
    const Stopwatch watch;
    Truth traced;
    try {
        traced.image = trace_(run);
    } catch (const Interrupted&) {
        throw;
    } catch (const Error&) {
        const std::lock_guard guard(mutex_);
        failures_.emplace(run.truth, std::current_exception());
        throw;
    }
    traced.seconds = watch.seconds();
    write_exr(file, traced.image);
    const std::string bytes = read_whole_file(file).value_or("");
    replace_text_file(seconds_file(file), shortest_text(traced.seconds) + "\n" + hash_text(bytes) + "\n");
    return keep(run.truth, std::move(traced));
}

std::shared_ptr<const KeptTruth> TruthStore::get(const PlannedRun& run, bool may_wait) {
    if (auto known = find(run.truth)) return known;
    const std::string file = truth_file(folder_, run.truth);
    if (std::optional<Truth> kept = read_truth(file)) return keep(run.truth, std::move(*kept));

    std::optional<FileLock> writer = FileLock::try_lock(file + ".lock", LockKind::kOne);
    if (!writer && !may_wait) return nullptr;
    if (!writer) writer = FileLock::wait(file + ".lock", LockKind::kOne, progress_);
    // Whoever held the lock may have traced it.
    if (auto known = find(run.truth)) return known;
    if (std::optional<Truth> kept = read_truth(file)) return keep(run.truth, std::move(*kept));
    return trace(run, file);
}

}  // namespace trilens
