// Sweeps: pictures at the points of some axes, each against its truth, and what the errors say together.
#include "sweep/run/sweep.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "base/files/files.h"
#include "base/util/check.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "sweep/report/sweep_pictures.h"
#include "sweep/report/sweep_report.h"
#include "sweep/store/machine.h"
#include "sweep/store/sweep_folder.h"

namespace trilens {
namespace {

std::vector<PlannedRun> plan_of(const SweepParams& params, const SweepCallbacks& callbacks) {
    TRILENS_CHECK(callbacks.render && callbacks.trace && callbacks.keys, "a sweep renders and traces");
    TRILENS_CHECK(params.shard.index >= 0 && params.shard.index < params.shard.count, "a shard of the plan");
    return make_plan(params.axes, callbacks.keys);
}

FileLock claim(const SweepParams& params, const SweepCallbacks& callbacks,
               const std::vector<PlannedRun>& plan) {
    if (callbacks.inputs) require_inputs_apart(params.folder, plan, callbacks.inputs());
    if (params.replace) clear_folder(params.folder);
    return claim_folder(params.folder, {params.subject, params.axes}, plan, params.progress);
}

void write_tables(const SweepSummary& summary) {
    replace_text_file(summary.folder + "/runs.csv", runs_csv(summary));
    replace_text_file(summary.folder + "/displacement.csv", displacement_csv(summary));
    replace_text_file(summary.folder + "/summary.json", summary_text(summary));
    replace_text_file(summary.folder + "/summary.tex", summary_latex(summary));
}

/// `done`: runs by id whose files need not be read again.
SweepSummary load_sweep(const std::string& folder, std::map<std::string, RunRecord> done) {
    SweepSummary summary;
    summary.folder = folder;
    summary.manifest = read_manifest(folder + "/manifest.json");
    const std::vector<PlannedRun> plan = read_plan(folder + "/plan.jsonl", summary.manifest.axes);
    summary.runs.resize(plan.size());
    parallel_for(plan.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const auto known = done.find(plan[i].id);
            const bool is_same = known != done.end() && known->second.plan.hash == plan[i].hash;
            summary.runs[i] = is_same ? std::move(known->second) : load_run(folder, plan[i]);
        }
    });
    summary.other_runs = count_other_runs(folder, plan);
    summary.fits = fit_runs(summary.manifest.axes, summary.runs);
    return summary;
}

void write_report_files(const SweepSummary& summary, KeptPictures* pictures = nullptr) {
    write_tables(summary);
    write_sweep_report(summary, pictures);
}

}  // namespace

void plan_sweep(const SweepParams& params, const SweepCallbacks& callbacks) {
    claim(params, callbacks, plan_of(params, callbacks));
}

SweepSummary run_sweep(const SweepParams& params, const SweepCallbacks& callbacks) {
    const std::vector<PlannedRun> plan = plan_of(params, callbacks);
    const FileLock user = claim(params, callbacks, plan);
    const bool is_whole = params.shard.count == 1;
    KeptPictures pictures(kMostBytesInPage);
    std::map<std::string, RunRecord> done;
    try {
        done = run_plan(params, callbacks, plan, is_whole ? &pictures : nullptr);
    } catch (const Interrupted&) {
        if (is_whole) write_tables(load_sweep(params.folder));
        throw;
    }
    SweepSummary summary = load_sweep(params.folder, std::move(done));
    if (is_whole) write_report_files(summary, &pictures);
    return summary;
}

SweepSummary load_sweep(const std::string& folder) {
    return load_sweep(folder, {});
}

SweepSummary report_sweep(const std::string& folder) {
    SweepSummary summary = load_sweep(folder);
    write_report_files(summary);
    return summary;
}

namespace {

constexpr double kShareOfMemory = 0.8;  // of what is free, where no limit is given

double memory_limit(const SweepParams& params) {
    if (params.memory_limit > 0) return params.memory_limit;
    return kShareOfMemory * available_memory().value_or(0);
}

/// The shard's runs, those of one truth behind each other: a worker then loads each truth once.
std::vector<PlannedRun> own_part(const std::vector<PlannedRun>& plan, const Shard& shard) {
    std::vector<PlannedRun> mine;
    for (std::size_t job = 0; job < plan.size(); ++job)
        if (shard.has(job)) mine.push_back(plan[job]);
    std::map<std::string, std::size_t> first;
    for (std::size_t i = 0; i < mine.size(); ++i) first.emplace(mine[i].truth, i);
    std::ranges::stable_sort(mine, {}, [&](const PlannedRun& run) { return first.at(run.truth); });
    return mine;
}

/// One process at its part of the plan, on as many threads as it has jobs.
struct Workers {
    const SweepParams& params;
    const SweepCallbacks& callbacks;
    std::vector<PlannedRun> mine;
    bool shares_one_truth;  // all runs of the plan
    TruthStore truths;
    MemoryGate gate;
    KeptPictures* pictures;
    std::map<std::string, std::string> failures = {};  // id -> failure_stamp, as the folder was at the start

    std::atomic<std::size_t> next = 0;
    std::atomic<bool> stop = false;
    std::mutex mutex = {};  // of what follows, and of the callbacks of params
    std::vector<PlannedRun> busy = {};
    std::map<std::string, RunRecord> done = {};  // by id
    std::size_t settled = 0;
    std::exception_ptr failure = {};

    void tell(const RunRecord& run) {
        const std::lock_guard guard(mutex);
        if (params.on_run) params.on_run(run);
        params.progress(static_cast<double>(++settled) / static_cast<double>(mine.size()));
    }

    /// As its file says it: numbers that are not finite have no place there.
    void keep(const RunRecord& run) {
        if (run.state != RunState::kDone) return;
        std::optional<RunRecord> read = parse_run(run_text(run), run.plan);
        if (!read) return;
        read->image_hash = run.image_hash;
        const std::lock_guard guard(mutex);
        done[run.plan.id] = std::move(*read);
    }

    /// False where the run's truth is in other hands. The caller holds the run's lock. A run that another
    /// process has tried since this one began is not tried again.
    bool settle(const PlannedRun& plan, bool may_wait) {
        RunRecord run = load_run(params.folder, plan);
        const bool is_tried =
            run.state == RunState::kFailed && failure_stamp(params.folder, plan) != failures.at(plan.id);
        if (run.state != RunState::kDone && !is_tried) {
            const MemoryGate::Visit visit =
                gate.enter(callbacks.memory ? callbacks.memory(plan) : 0, params.progress);
            std::optional<RunRecord> drawn =
                do_run({params, callbacks, truths, plan, shares_one_truth, may_wait, pictures});
            if (!drawn) return false;
            run = std::move(*drawn);
            keep(run);
        }
        tell(run);
        return true;
    }

    void check_stop() const {
        if (stop || params.progress.cancelled()) throw Interrupted();
    }

    /// What nobody else is at.
    void do_free_runs() {
        for (std::size_t i = next++; i < mine.size(); i = next++) {
            check_stop();
            const std::optional<FileLock> lock =
                FileLock::try_lock(run_lock(params.folder, mine[i]), LockKind::kOne);
            if (lock && settle(mine[i], false)) continue;
            const std::lock_guard guard(mutex);
            busy.push_back(mine[i]);
        }
    }

    std::optional<PlannedRun> next_busy() {
        const std::lock_guard guard(mutex);
        if (busy.empty()) return std::nullopt;
        PlannedRun run = busy.front();
        busy.erase(busy.begin());
        return run;
    }

    /// What others were at: waits for them.
    void do_busy_runs() {
        while (const std::optional<PlannedRun> run = next_busy()) {
            check_stop();
            const FileLock lock =
                FileLock::wait(run_lock(params.folder, *run), LockKind::kOne, params.progress);
            settle(*run, true);
        }
    }

    void work() {
        try {
            do_free_runs();
            do_busy_runs();
        } catch (...) {
            const std::lock_guard guard(mutex);
            // Others that stop because of the first failure are interrupted; the failure itself counts.
            if (!failure) failure = std::current_exception();
            stop = true;
        }
    }
};

}  // namespace

std::map<std::string, RunRecord> run_plan(const SweepParams& params, const SweepCallbacks& callbacks,
                                          const std::vector<PlannedRun>& plan, KeptPictures* pictures) {
    const bool shares_one_truth =
        std::ranges::all_of(plan, [&](const PlannedRun& run) { return run.truth == plan[0].truth; });
    Workers workers{params,
                    callbacks,
                    own_part(plan, params.shard),
                    shares_one_truth,
                    {params.folder, callbacks.trace, params.progress},
                    MemoryGate(memory_limit(params)),
                    pictures};
    const std::size_t jobs = std::clamp<std::size_t>(static_cast<std::size_t>(std::max(1, params.jobs)), 1,
                                                     std::max<std::size_t>(1, workers.mine.size()));
    workers.truths.set_kept(jobs);
    for (const PlannedRun& run : workers.mine) workers.failures[run.id] = failure_stamp(params.folder, run);

    params.progress(0);
    run_on_threads(jobs, [&] { workers.work(); });
    if (workers.failure) std::rethrow_exception(workers.failure);
    params.progress(1);
    return std::move(workers.done);
}

MemoryGate::Visit MemoryGate::enter(double bytes, const Progress& progress) {
    std::unique_lock guard(mutex_);
    while (visitors_ > 0 && limit_ > 0 && inside_ + bytes > limit_) {
        left_.wait_for(guard, std::chrono::milliseconds(100));
        progress.stop_if_cancelled();
    }
    inside_ += bytes;
    ++visitors_;
    return {*this, bytes};
}

void MemoryGate::leave(double bytes) {
    const std::lock_guard guard(mutex_);
    inside_ -= bytes;
    --visitors_;
    left_.notify_all();
}

}  // namespace trilens
