// The files of one run: what makes it finished, and what it then says.
#include "sweep/store/sweep_folder.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <exception>
#include <optional>
#include <utility>

#include "base/description/digest.h"
#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "image/image_io.h"
#include "measure/compare.h"
#include "measure/displacement/displacement.h"

namespace trilens {
namespace {

constexpr std::array<const char*, 3> kFiles = {"image.exr", "diff.exr", "metrics.json"};

std::optional<std::string> file_hash(const std::string& file) {
    const std::optional<std::string> bytes = read_whole_file(file);
    if (!bytes) return std::nullopt;
    return hash_text(*bytes);
}

/// The text of DONE: the run's hash, then each file with its own, of which that of the picture may be known;
/// none where a file is missing.
std::optional<std::string> done_text(const std::string& folder, const PlannedRun& plan,
                                     const std::string& image_hash = "") {
    std::string text = plan.hash + "\n";
    for (const char* name : kFiles) {
        const bool is_known = name == kFiles.front() && !image_hash.empty();
        const std::optional<std::string> hash =
            is_known ? image_hash : file_hash(run_folder(folder, plan.id) + "/" + name);
        if (!hash) return std::nullopt;
        text += *hash + " " + name + "\n";
    }
    return text;
}

/// The hash of the first of kFiles, on the second line of DONE.
std::string image_hash_in(const std::string& done) {
    const std::size_t line = done.find('\n') + 1;
    return done.substr(line, done.find(' ', line) - line);
}

}  // namespace

std::string run_lock(const std::string& folder, const PlannedRun& plan) {
    make_folder(run_folder(folder, plan.id));
    return run_folder(folder, plan.id) + "/lock";
}

std::string failure_stamp(const std::string& folder, const PlannedRun& plan) {
    // The clock may jump, so that time alone does not tell two files apart.
    struct stat status {};
    if (stat((run_folder(folder, plan.id) + "/error.json").c_str(), &status) != 0) return "";
    return std::to_string(status.st_mtim.tv_sec) + "." + std::to_string(status.st_mtim.tv_nsec) + " " +
           std::to_string(status.st_ino);
}

RunRecord load_run(const std::string& folder, const PlannedRun& plan) {
    const std::string home = run_folder(folder, plan.id);
    RunRecord missing;
    missing.plan = plan;
    // The failure first: who finishes the run meanwhile writes DONE, and only then removes the failure.
    const std::optional<RunRecord> failed =
        parse_run(read_whole_file(home + "/error.json").value_or(""), plan);
    const std::optional<std::string> done = read_whole_file(home + "/DONE");
    if (done && done == done_text(folder, plan)) {
        std::optional<RunRecord> run = parse_run(read_whole_file(home + "/metrics.json").value_or(""), plan);
        if (!run || run->state != RunState::kDone) return missing;
        run->image_hash = image_hash_in(*done);
        return *run;
    }
    return failed && failed->state == RunState::kFailed ? *failed : missing;
}

void clear_run(const std::string& folder, const PlannedRun& plan) {
    const std::string home = run_folder(folder, plan.id);
    make_folder(home);
    remove_file(home + "/DONE");
}

double store_image(const std::string& folder, const PlannedRun& plan, const Image& image) {
    const Stopwatch watch;
    write_exr(run_folder(folder, plan.id) + "/" + kFiles.front(), image);
    return watch.seconds();
}

std::string hash_of_image(const std::string& folder, const PlannedRun& plan) {
    const std::string file = run_folder(folder, plan.id) + "/" + kFiles.front();
    const std::optional<std::string> hash = file_hash(file);
    if (!hash) throw OutputError(file, "what was written cannot be read back");
    return *hash;
}

void store_run(const std::string& folder, const RunRecord& run, const Image& diff) {
    const std::string home = run_folder(folder, run.plan.id);
    write_exr(home + "/diff.exr", diff);
    replace_text_file(home + "/metrics.json", run_text(run));
    const std::optional<std::string> done = done_text(folder, run.plan, run.image_hash);
    if (!done) throw OutputError(home, "what was written cannot be read back");
    replace_text_file(home + "/DONE", *done);
    remove_file(home + "/error.json");
}

void store_failure(const std::string& folder, const RunRecord& run) {
    replace_text_file(run_folder(folder, run.plan.id) + "/error.json", run_text(run));
}

// One run's image against the truth, as the columns of a sweep.

namespace {

constexpr std::array<const char*, 3> kLayers = {"reflect", "refract", "direct"};

MetricValues colour_values(const Comparison& comparison) {
    const CompareCounts& counts = comparison.counts;
    MetricValues values{{"nonfinite", static_cast<double>(counts.nan_test + counts.inf_test)},
                        {"failed_px", static_cast<double>(counts.fail)}};
    for (const ColourMetric& one : kColourMetrics)
        if (one.is_column) values[std::string("rgb_") + one.name] = comparison.metrics.*one.value;
    return values;
}

/// Without a pixel found there is no mean: only the counts.
MetricValues displacement_values(const Displacement& displacement) {
    MetricValues values = {{"disp_pixels", static_cast<double>(displacement.pixels)},
                           {"disp_lost", static_cast<double>(displacement.lost)},
                           {"disp_unmeasured", static_cast<double>(displacement.unmeasured)},
                           {"disp_beyond_radius", static_cast<double>(displacement.beyond_radius)},
                           {"disp_missing", static_cast<double>(displacement.missing)},
                           {"disp_near_folds", static_cast<double>(displacement.near_folds)}};
    if (displacement.coverage) values["disp_coverage"] = *displacement.coverage;
    if (displacement.mean_off_folds) values["disp_mean_off_folds_px"] = *displacement.mean_off_folds;
    if (!displacement.summary) return values;
    values["disp_mean_px"] = displacement.summary->mean;
    values["disp_p50_px"] = displacement.summary->p50;
    values["disp_p95_px"] = displacement.summary->p95;
    values["disp_p99_px"] = displacement.summary->p99;
    values["disp_max_px"] = displacement.summary->max;
    return values;
}

/// Whether either image shows the layer.
bool sees_something(const Displacement& displacement) {
    return displacement.coverage.has_value();
}

/// Each optic by itself; one that is on no pixel of either image is left out with a warning.
void measure_optics(const Image& test, const ReferenceLayers& truth, const std::string& layer,
                    const std::vector<SweptOptic>& optics, MeasuredRun& run) {
    for (const SweptOptic& optic : optics) {
        DisplacementOptions options;
        options.mask_object = optic.object;
        try {
            const auto displacement = measure_displacement(truth, test, layer, options);
            if (displacement && sees_something(*displacement))
                run.displacement.push_back({layer, optic.name, displacement_values(*displacement)});
        } catch (const InputError& error) {
            run.warnings.push_back(layer + ", " + optic.name + ": " + error.what());
        }
    }
}

void add_mismatches(const std::optional<SeenMismatch>& seen, MetricValues& metrics) {
    if (!seen) return;
    metrics["coverage_mismatch"] += static_cast<double>(seen->coverage_mismatch);
    metrics["object_mismatch"] += static_cast<double>(seen->object_mismatch);
    metrics["primitive_mismatch"] += static_cast<double>(seen->primitive_mismatch);
}

/// What `work` throws.
template <typename Work>
std::exception_ptr caught(Work&& work) {
    try {
        work();
    } catch (...) {
        return std::current_exception();
    }
    return nullptr;
}

/// The larger displacement, the smaller coverage, the losses of both layers together.
void take_worse(const MetricValues& layer, MetricValues& metrics) {
    if (const std::optional<double> coverage = find_value(layer, "disp_coverage"))
        metrics["disp_coverage"] = std::min(find_value(metrics, "disp_coverage").value_or(1), *coverage);
    for (const char* name : {"disp_lost", "disp_missing", "disp_unmeasured"})
        metrics[name] += find_value(layer, name).value_or(0);
    for (const char* name : {"disp_mean_px", "disp_p95_px", "disp_max_px"}) {
        const auto value = layer.find(name);
        if (value != layer.end()) metrics[name] = std::max(metrics[name], value->second);
    }
}

}  // namespace

MeasuredRun measure_run(const Image& test, const ReferenceLayers& truth,
                        const std::vector<SweptOptic>& optics) {
    MeasuredRun run;
    std::array<std::optional<Displacement>, kLayers.size()> displacement;
    std::array<std::optional<SeenMismatch>, kLayers.size()> seen;
    std::exception_ptr failure, seen_failure;  // count where the colours could be compared
    run_side_by_side({[&] {
                          std::vector<float> flip = layer_flip(truth.image(), test, "", &truth.flip());
                          run.metrics = colour_values(compare(truth.image(), test, {}, &flip));
                          run.diff = make_difference(truth.image(), test, {}, std::move(flip));
                          seen_failure = caught([&] {
                              for (std::size_t i = 0; i < kLayers.size(); ++i)
                                  seen[i] = compare_seen(truth.image(), test, kLayers[i]);
                          });
                      },
                      [&] {
                          failure = caught([&] {
                              for (std::size_t i = 0; i < kLayers.size(); ++i)
                                  displacement[i] = measure_displacement(truth, test, kLayers[i]);
                          });
                      }});
    for (const std::exception_ptr& first : {failure, seen_failure})
        if (first) std::rethrow_exception(first);

    for (std::size_t i = 0; i < kLayers.size(); ++i) {
        const char* const layer = kLayers[i];
        add_mismatches(seen[i], run.metrics);
        if (!displacement[i] || !sees_something(*displacement[i])) continue;
        const MetricValues values = displacement_values(*displacement[i]);
        take_worse(values, run.metrics);
        run.displacement.push_back({layer, "all", values});
        add_shift(layer, *displacement[i], run.diff);
        if (layer == kLayers[2]) continue;  // seen over no optic
        // A single optic is all optics.
        if (optics.size() == 1)
            run.displacement.push_back({layer, optics[0].name, values});
        else
            measure_optics(test, truth, layer, optics, run);
    }
    return run;
}

std::vector<DisplacementMap> displacement_maps(const Image& diff) {
    std::vector<DisplacementMap> maps;
    for (const std::string layer : kLayers) {
        const Channel *const x = diff.find(layer + ".shift.X"), *const y = diff.find(layer + ".shift.Y"),
                             *const mask = diff.find(layer + ".shift.M");
        if (!x || !y || !mask) continue;
        DisplacementMap map{layer, std::vector<float>(diff.pixels(), NAN)};
        for (std::size_t i = 0; i < map.pixels.size(); ++i) {
            if (mask->floats()[i] > 0) map.pixels[i] = std::hypot(x->floats()[i], y->floats()[i]);
            if (mask->floats()[i] < 0) map.pixels[i] = mask->floats()[i] == -1 ? INFINITY : -INFINITY;
        }
        maps.push_back(std::move(map));
    }
    return maps;
}

}  // namespace trilens
