// trilens compare: error metrics and a verdict.
#include <trilens/compare.h>
#include <trilens/files.h>
#include <trilens/image.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "cli/command.h"
#include "cli/format.h"

namespace trilens {
namespace {

struct CompareCommand {
    std::string reference, test, diff;
    long long mask = -1;
    double radius = DisplacementOptions{}.radius;
    CompareOptions options;
};

Json metrics_json(const Metrics& m) {
    return {
        {"mae", json_number(m.mae)},   {"rmse", json_number(m.rmse)},       {"relmse", json_number(m.relmse)},
        {"relmse_eps", 0.01},          {"psnr_db", json_number(m.psnr_db)}, {"psnr_peak", 1},
        {"ssim", json_number(m.ssim)}, {"max", json_number(m.max)},         {"p50", json_number(m.p50)},
        {"p95", json_number(m.p95)},   {"p99", json_number(m.p99)}};
}

Json seen_json(const SeenMismatch& s) {
    return {{"pixels", s.pixels},
            {"object_mismatch", s.object_mismatch},
            {"primitive_mismatch", s.primitive_mismatch},
            {"coverage_mismatch", s.coverage_mismatch}};
}

/// Null is "nothing was measured".
Json displacement_json(const Displacement& d) {
    const auto statistic = [&](double Summary::*which) {
        return d.summary ? json_number((*d.summary).*which) : Json(nullptr);
    };
    return {{"mean", statistic(&Summary::mean)},
            {"p50", statistic(&Summary::p50)},
            {"p95", statistic(&Summary::p95)},
            {"p99", statistic(&Summary::p99)},
            {"max", statistic(&Summary::max)},
            {"pixels", d.pixels},
            {"lost", d.lost},
            {"beyond_radius", d.beyond_radius},
            {"missing", d.missing},
            {"coverage", d.coverage ? json_number(*d.coverage) : Json(nullptr)},
            {"mean_off_folds", d.mean_off_folds ? json_number(*d.mean_off_folds) : Json(nullptr)},
            {"near_folds", d.near_folds}};
}

std::string displacement_text(const std::string& layer, const Displacement& d) {
    const std::string measured = fmt::format(
        "{:<8} measured {:.2f} % of what either shows: {} lost ({} of them farther than the radius), {} "
        "missing\n",
        layer, 100 * d.coverage.value_or(0), d.lost, d.beyond_radius, d.missing);
    if (!d.summary) return fmt::format("{:<8} displacement: nothing could be measured\n", layer) + measured;
    return fmt::format(
               "{:<8} displacement mean {:.4g}  p50 {:.4g}  p95 {:.4g}  p99 {:.4g}  max {:.4g} px over {} "
               "pixels\n",
               layer, d.summary->mean, d.summary->p50, d.summary->p95, d.summary->p99, d.summary->max,
               d.pixels) +
           measured;
}

std::string summary_text(const Comparison& comparison, const std::vector<LayerComparison>& layers) {
    const Metrics& m = comparison.metrics;
    const CompareCounts& c = comparison.counts;
    std::string text = fmt::format("pixels        {} ({} beyond fail, {} beyond hardfail, {} beyond warn)\n",
                                   c.pixels, c.fail, c.hard, c.warn);
    text += fmt::format("error         mae {:.6g}  rmse {:.6g}  relmse {:.6g}  max {:.6g}\n", m.mae, m.rmse,
                        m.relmse, m.max);
    text += fmt::format("likeness      psnr {:.2f} dB  ssim {:.6f}\n", m.psnr_db, m.ssim);
    if (const WorstPixel& worst = comparison.worst; !worst.channel.empty())
        text += fmt::format("worst         pixel {},{} channel {}: {:.6g}, reference {:.6g}\n", worst.x,
                            worst.y, worst.channel, worst.test, worst.reference);
    for (const LayerComparison& layer : layers) {
        if (const auto& seen = layer.seen; seen && seen->pixels > 0)
            text += fmt::format(
                "{:<8} seen {} pixels: {} other object, {} other triangle, {} covered in one only\n",
                layer.layer, seen->pixels, seen->object_mismatch, seen->primitive_mismatch,
                seen->coverage_mismatch);
        if (layer.displacement && layer.displacement->coverage)
            text += displacement_text(layer.layer, *layer.displacement);
    }
    for (const std::string& reason : comparison.reasons) text += reason + "\n";
    return text +
           (comparison.verdict == Verdict::kFailure   ? "FAILURE"
            : comparison.verdict == Verdict::kWarning ? "WARNING"
                                                      : "PASS") +
           "\n";
}

Answer answer_of(const CompareCommand& command, const Comparison& comparison,
                 const std::vector<LayerComparison>& layers) {
    Answer answer;
    const CompareCounts& c = comparison.counts;
    const CompareOptions& o = command.options;
    answer.fields["ref"] = {{"file", command.reference}};
    answer.fields["test"] = {{"file", command.test}};
    answer.fields["thresholds"] = {{"fail", o.fail},
                                   {"failpercent", o.failpercent},
                                   {"hardfail", o.hardfail},
                                   {"failrelative", o.failrelative},
                                   {"allowfailures", o.allowfailures},
                                   {"warn", o.warn},
                                   {"warnpercent", o.warnpercent}};
    answer.fields["counts"] = {{"pixels", c.pixels},   {"fail", c.fail},         {"warn", c.warn},
                               {"hard", c.hard},       {"nan_ref", c.nan_ref},   {"nan_test", c.nan_test},
                               {"inf_ref", c.inf_ref}, {"inf_test", c.inf_test}, {"masked", c.masked}};
    answer.fields["metrics"]["RGB"] = metrics_json(comparison.metrics);
    answer.fields["seen"] = seen_json(total_seen(layers));
    const LayerComparison* main = main_layer(layers, o.layer);
    answer.fields["displacement_px"] = displacement_json(main ? *main->displacement : Displacement());
    for (const LayerComparison& layer : layers) {
        Json entry = Json::object();
        if (layer.seen) entry["seen"] = seen_json(*layer.seen);
        if (layer.displacement) entry["displacement_px"] = displacement_json(*layer.displacement);
        answer.fields["layers"][layer.layer] = entry;
    }
    if (!comparison.worst.channel.empty())
        answer.fields["worst"] = {{"x", comparison.worst.x},
                                  {"y", comparison.worst.y},
                                  {"channel", comparison.worst.channel},
                                  {"ref", json_number(comparison.worst.reference)},
                                  {"test", json_number(comparison.worst.test)}};
    answer.fields["verdict"] = comparison.verdict == Verdict::kFailure   ? "failure"
                               : comparison.verdict == Verdict::kWarning ? "warning"
                                                                         : "pass";
    answer.fields["reasons"] = comparison.reasons;
    answer.text = summary_text(comparison, layers);
    answer.code = comparison.verdict == Verdict::kFailure ? ExitCode::kExceeded : ExitCode::kDone;
    return answer;
}

Answer run(CompareCommand command, Console& console) {
    if (!command.diff.empty() && std::filesystem::path(command.diff).extension() != ".exr")
        throw UsageError("a difference is written as .exr, not \"" + command.diff + "\"");
    if (!command.diff.empty()) check_writable(command.diff, {command.reference, command.test});
    if (command.mask >= 0) command.options.mask_object = static_cast<Id>(command.mask);
    const Image reference = read_image(command.reference), test = read_image(command.test);
    const Comparison comparison = compare(reference, test, command.options);
    const std::vector<LayerComparison> layers =
        compare_layers(reference, test, {command.radius, command.options.mask_object});
    if (!command.diff.empty()) {
        const LayerComparison* main = main_layer(layers, command.options.layer);
        write_image(command.diff, make_difference(reference, test,
                                                  {command.options.layer, command.options.mask_object,
                                                   main ? &*main->displacement : nullptr}));
    }
    if (comparison.verdict == Verdict::kWarning)
        for (const std::string& reason : comparison.reasons) console.warn(reason);
    return answer_of(command, comparison, layers);
}

/// A number from `least` to `most`; NaN is none.
CLI::Validator number_between(double least, double most, const std::string& name) {
    return CLI::Validator(
        [least, most](std::string& text) {
            char* end = nullptr;
            const double value = std::strtod(text.c_str(), &end);
            const bool is_good = !text.empty() && *end == '\0' && value >= least && value <= most;
            return is_good ? std::string()
                           : "\"" + text + "\" is not a number from " + Json(least).dump() + " to " +
                                 (std::isinf(most) ? "inf" : Json(most).dump());
        },
        name);
}

}  // namespace

void register_compare(const CommandRegistry& registry) {
    const CLI::Validator tolerance = number_between(0, INFINITY, "NONNEGATIVE"),
                         percentage = number_between(0, 100, "0..100"),
                         radius = number_between(1, 4096, "1..4096");
    auto command = std::make_shared<CompareCommand>();
    CLI::App* app = registry.app->add_subcommand(
        "compare", "error metrics between two images and a verdict: exit 0 within tolerance, 1 beyond");
    CompareOptions& o = command->options;
    app->add_option("REF", command->reference, "the reference, .exr")->required();
    app->add_option("TEST", command->test, "the image in question, .exr")->required();
    app->add_option("-o,--output", command->diff, "difference image to write, .exr")->type_name("DIFF.exr");
    app->add_option("--layer", o.layer, "compare this layer instead of the beauty: direct, reflect, refract")
        ->type_name("L");
    app->add_option("--mask-object", command->mask, "only pixels whose optic.object is this id")
        ->check(CLI::Range(0LL, 4294967294LL))
        ->type_name("ID");
    app->add_option("--fail", o.fail, "difference beyond which a pixel fails")->check(tolerance);
    app->add_option("--failpercent", o.failpercent, "percentage of pixels that may fail")->check(percentage);
    app->add_option("--hardfail", o.hardfail, "difference that no pixel may exceed")->check(tolerance);
    app->add_option("--failrelative", o.failrelative, "a failing pixel must also differ by this share")
        ->check(tolerance);
    app->add_option("--allowfailures", o.allowfailures, "so many pixels may differ by any amount")
        ->check(CLI::Range(0LL, 1LL << 53));
    app->add_option("--warn", o.warn, "difference worth a warning")->check(tolerance);
    app->add_option("--warnpercent", o.warnpercent, "percentage of pixels that may be so")->check(percentage);
    app->add_option("--radius", command->radius, "how far displaced points are looked for, pixels")
        ->check(radius);
    registry.add(app, "compare", [command](Console& console) { return run(*command, console); });
}

}  // namespace trilens
