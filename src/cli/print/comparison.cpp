// What a comparison prints, and its JSON.
#include "cli/print/print.h"

#include "terminal/libraries.h"

namespace trilens {
namespace {

Json metrics_json(const Metrics& m) {
    Json json{{"relmse_eps", 0.01}, {"psnr_peak", 1}};
    for (const ColourMetric& one : kColourMetrics) json[one.name] = json_number(m.*one.value);
    return json;
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
            {"unmeasured", d.unmeasured},
            {"beyond_radius", d.beyond_radius},
            {"missing", d.missing},
            {"coverage", optional_json(d.coverage)},
            {"mean_off_folds", optional_json(d.mean_off_folds)},
            {"near_folds", d.near_folds}};
}

Json bounds_json(const BoundCheck& b) {
    return {{"pixels", b.pixels},
            {"beyond", b.beyond},
            {"excess", optional_json(b.excess)},
            {"tightness_p50", optional_json(b.tightness_p50)},
            {"tightness_max", optional_json(b.tightness_max)}};
}

std::string bounds_text(const std::string& layer, const BoundCheck& b) {
    std::string text = fmt::format("{:<8} proven bounds: {} of {} checked pixels lie beyond theirs", layer,
                                   b.beyond, b.pixels);
    if (b.tightness_p50)
        text += fmt::format("; bound over displacement p50 {:.4g}  max {:.4g}", *b.tightness_p50,
                            *b.tightness_max);
    return text + "\n";
}

std::string displacement_text(const std::string& layer, const Displacement& d) {
    std::string text = fmt::format("{:<8} displacement: nothing could be measured\n", layer);
    if (d.summary)
        text = fmt::format(
            "{:<8} displacement mean {:.4g}  p50 {:.4g}  p95 {:.4g}  p99 {:.4g}  max {:.4g} px over {} "
            "pixels\n",
            layer, d.summary->mean, d.summary->p50, d.summary->p95, d.summary->p99, d.summary->max, d.pixels);
    return text + fmt::format(
                      "{:<8} measured {:.2f} % of what either shows: {} lost, {} missing, {} unmeasured "
                      "({} beyond the radius)\n",
                      layer, 100 * d.coverage.value_or(0), d.lost, d.missing, d.unmeasured, d.beyond_radius);
}

std::string left_out_text(const std::string& image, const std::vector<std::string>& names) {
    if (names.empty()) return "";
    std::string text = "left out      only in the " + image + ":";
    for (const std::string& name : names) text += " " + name;
    return text + "\n";
}

/// Null: it does not judge.
Json thresholds_json(const CompareOptions& o, const std::vector<MetricLimit>& limits) {
    const auto threshold = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
    const bool is_counted = o.allowfailures != std::numeric_limits<std::size_t>::max();
    Json json{{"fail", threshold(o.fail)},
              {"failpercent", o.failpercent},
              {"hardfail", threshold(o.hardfail)},
              {"failrelative", o.failrelative},
              {"allowfailures", is_counted ? Json(o.allowfailures) : Json(nullptr)},
              {"warn", threshold(o.warn)},
              {"warnpercent", o.warnpercent}};
    for (const MetricLimit& limit : limits) json["max"][limit.metric] = limit.value;
    return json;
}

/// How many are beyond the differences that are judged.
std::string pixels_text(const CompareCounts& counts, const CompareOptions& options) {
    std::string beyond;
    const auto add = [&](double threshold, std::size_t count, const char* name) {
        if (std::isfinite(threshold))
            beyond += fmt::format("{}{} beyond {}", beyond.empty() ? "" : ", ", count, name);
    };
    add(options.fail, counts.fail, "fail");
    add(options.hardfail, counts.hard, "hardfail");
    add(options.warn, counts.warn, "warn");
    return fmt::format("pixels        {} ({})\n", counts.pixels,
                       beyond.empty() ? "colours are not judged" : beyond);
}

std::string summary_text(const ComparedInputs& inputs, const CompareOptions& options) {
    const Comparison& comparison = inputs.comparison;
    const Metrics& m = comparison.metrics;
    const CompareCounts& c = comparison.counts;
    std::string text = left_out_text("reference", inputs.images.only_reference) +
                       left_out_text("test", inputs.images.only_test);
    text += pixels_text(c, options);
    text += fmt::format("error         mae {:.6g}  rmse {:.6g}  relmse {:.6g}  max {:.6g}\n", m.mae, m.rmse,
                        m.relmse, m.max);
    text += fmt::format("likeness      psnr {:.2f} dB  ssim {:.6f}  flip {:.6f} (0: none to be seen)\n",
                        m.psnr_db, m.ssim, m.flip);
    if (const WorstPixel& worst = comparison.worst; !worst.channel.empty())
        text += fmt::format("worst         pixel {},{} channel {}: {:.6g}, reference {:.6g}\n", worst.x,
                            worst.y, worst.channel, worst.test, worst.reference);
    for (const LayerComparison& layer : inputs.layers) {
        if (const auto& seen = layer.seen; seen && seen->pixels > 0)
            text += fmt::format(
                "{:<8} seen {} pixels: {} other object, {} other triangle, {} covered in one only\n",
                layer.layer, seen->pixels, seen->object_mismatch, seen->primitive_mismatch,
                seen->coverage_mismatch);
        if (const auto& d = layer.displacement; d && d->coverage) text += displacement_text(layer.layer, *d);
        if (layer.bounds) text += bounds_text(layer.layer, *layer.bounds);
    }
    for (const std::string& reason : comparison.reasons) text += reason + "\n";
    return text +
           (comparison.verdict == Verdict::kFailure   ? "FAILURE"
            : comparison.verdict == Verdict::kWarning ? "WARNING"
                                                      : "PASS") +
           "\n";
}

}  // namespace

Answer compare_answer(const CompareRequest& command, const ComparedInputs& inputs) {
    const Comparison& comparison = inputs.comparison;
    const std::vector<LayerComparison>& layers = inputs.layers;
    Answer answer;
    answer.is_report = true;
    const CompareCounts& c = comparison.counts;
    const CompareOptions& o = command.options;
    answer.fields["ref"] = {{"file", command.reference}};
    answer.fields["test"] = {{"file", command.test}};
    answer.fields["thresholds"] = thresholds_json(o, command.limits);
    answer.fields["left_out"] = {{"ref", inputs.images.only_reference}, {"test", inputs.images.only_test}};
    answer.fields["counts"] = {{"pixels", c.pixels},   {"fail", c.fail},         {"warn", c.warn},
                               {"hard", c.hard},       {"nan_ref", c.nan_ref},   {"nan_test", c.nan_test},
                               {"inf_ref", c.inf_ref}, {"inf_test", c.inf_test}, {"masked", c.masked}};
    answer.fields["metrics"]["RGB"] = metrics_json(comparison.metrics);
    answer.fields["seen"] = seen_json(total_seen(layers));
    answer.fields["displacement_px"] = displacement_json(total_displacement(layers, o.layer));
    for (const LayerComparison& layer : layers) {
        Json entry = Json::object();
        if (layer.seen) entry["seen"] = seen_json(*layer.seen);
        if (layer.displacement) entry["displacement_px"] = displacement_json(*layer.displacement);
        if (layer.bounds) entry["bounds_px"] = bounds_json(*layer.bounds);
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
    answer.text = summary_text(inputs, o);
    answer.code = comparison.verdict == Verdict::kFailure ? ExitCode::kExceeded : ExitCode::kDone;
    return answer;
}

namespace {

Json metrics_json(const TestComparison& comparison) {
    Json json = Json::object();
    for (const NamedMetric& metric : comparison.metrics) json[metric.name] = optional_json(metric.value);
    return json;
}

Json test_json(const TestResult& test) {
    Json json{{"name", test.name},       {"folder", test.folder},    {"state", test_state_name(test.state)},
              {"reasons", test.reasons}, {"notes", test.notes},      {"tags", test.tags},
              {"seconds", test.seconds}, {"metrics", Json::object()}};
    json["update"] = test.update.empty() ? Json(nullptr) : Json(test.update);
    for (const TestComparison& comparison : test.comparisons)
        json["metrics"][comparison.against] = metrics_json(comparison);
    return json;
}

std::string test_text(const TestResult& test) {
    std::string text;
    if (!test.update.empty() && test.update != "unchanged")
        text += test.name + ": reference " + test.update + "\n";
    if (test.state == TestState::kPassed) return text;
    text += test.name + ": " + test_state_name(test.state) + "\n";
    for (const std::string& reason : test.reasons) text += "  " + reason + "\n";
    return text;
}

ExitCode exit_code(const SuiteResult& result) {
    if (result.count(TestState::kError) > 0) return ExitCode::kSomeJobsFailed;
    if (result.count(TestState::kFailed) > 0) return ExitCode::kExceeded;
    return result.count(TestState::kSkipped) == result.tests.size() ? ExitCode::kSkipped : ExitCode::kDone;
}

}  // namespace

Answer answer_of(const SuiteRequest& request, const SuiteResult& result) {
    Answer answer;
    answer.is_report = true;
    answer.code = exit_code(result);
    answer.fields["tests"] = Json::array();
    for (const TestResult& test : result.tests) {
        answer.fields["tests"].push_back(test_json(test));
        answer.text += test_text(test);
        if (test.state == TestState::kError)
            for (const std::string& reason : test.reasons) answer.errors.push_back(test.name + ": " + reason);
    }
    Json counts = Json::object();
    std::string line;
    for (const TestState state :
         {TestState::kPassed, TestState::kFailed, TestState::kError, TestState::kSkipped}) {
        counts[test_state_name(state)] = result.count(state);
        line += fmt::format("{}{} {}", line.empty() ? "" : ", ", result.count(state), test_state_name(state));
    }
    answer.fields["counts"] = counts;
    answer.fields["seconds"] = result.seconds;
    answer.text += fmt::format("{} in {:.1f} s\n", line, result.seconds);
    if (!request.html.empty()) answer.text += request.html + "\n";
    return answer;
}

}  // namespace trilens
