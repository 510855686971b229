#include "cli/print/print.h"

#include <cmath>

#include "terminal/libraries.h"

namespace trilens {
namespace {

Json fit_json(const SweepFit& fit) {
    return {{"optic", fit.optic},
            {"layer", fit.layer},
            {"axis", fit.axis},
            {"group", point_text(fit.group)},
            {"metric", fit.metric},
            {"order", optional_json(fit.order)},
            {"order_low", optional_json(fit.order_low)},
            {"order_high", optional_json(fit.order_high)},
            {"constant", optional_json(fit.constant)},
            {"r2", optional_json(fit.r2)},
            {"n_for_1px", optional_json(fit.n_for_1px)},
            {"n_for_half_px", optional_json(fit.n_for_half_px)},
            {"coverage", optional_json(fit.coverage)}};
}

}  // namespace

Json left_out_json(const std::vector<LeftOutScene>& left_out) {
    Json json = Json::array();
    for (const LeftOutScene& one : left_out) json.push_back({{"scene", one.scene}, {"reason", one.reason}});
    return json;
}

namespace {

Json summary_json(const SweepSummary& summary) {
    Json json{{"folder", summary.folder},
              {"runs", summary.runs.size()},
              {"done", summary.count(RunState::kDone)},
              {"failed", summary.count(RunState::kFailed)},
              {"missing", summary.count(RunState::kMissing)},
              {"fits", Json::array()}};
    for (const SweepFit& fit : summary.fits) json["fits"].push_back(fit_json(fit));
    return json;
}

std::string fit_line(const SweepFit& fit) {
    std::string line =
        fmt::format("  {:<8} {:<14} {:<16} order {:5.2f}  constant {:8.4g}  r2 {:.4f}", fit.layer, fit.optic,
                    fit.metric, *fit.order, fit.constant.value_or(0), fit.r2.value_or(0));
    if (!fit.group.empty()) line += "  " + point_text(fit.group);
    if (fit.coverage) line += fmt::format("  measured >= {:.1f} %", 100 * *fit.coverage);
    if (fit.n_for_1px)
        line += "  1 px at n = " + std::to_string(static_cast<long long>(std::ceil(*fit.n_for_1px)));
    if (fit.n_for_half_px)
        line += "  0.5 px at n = " + std::to_string(static_cast<long long>(std::ceil(*fit.n_for_half_px)));
    return line + "\n";
}

/// What another line says: of all optics, where there is one; off the folds, where there are none.
bool is_said_twice(const SweepFit& fit, const std::vector<SweepFit>& fits) {
    const auto is_like = [&](const SweepFit& other) {
        return other.layer == fit.layer && point_text(other.group) == point_text(fit.group);
    };
    const auto has_same = [&](const char* optic, const char* metric) {
        return std::ranges::any_of(fits, [&](const SweepFit& other) {
            return is_like(other) && other.optic == optic && other.metric == metric &&
                   other.order == fit.order && other.constant == fit.constant;
        });
    };
    const auto optics = std::ranges::count_if(fits, [&](const SweepFit& other) {
        return is_like(other) && other.metric == fit.metric && other.optic != "all";
    });
    if (fit.optic != "all" && optics == 1) return true;
    return fit.metric == "disp_mean_off_folds_px" && has_same(fit.optic.c_str(), "disp_mean_px");
}

std::string summary_text(const SweepSummary& summary) {
    std::string text = summary.manifest.subject.title + ": " +
                       std::to_string(summary.count(RunState::kDone)) + " of " +
                       std::to_string(summary.runs.size()) + " runs done\n";
    for (const SweepFit& fit : summary.fits)
        if (fit.order &&
            (fit.metric == "disp_mean_px" || fit.metric == "disp_mean_off_folds_px" ||
             fit.metric == "disp_p50_px") &&
            !is_said_twice(fit, summary.fits))
            text += fit_line(fit);
    return text;
}

/// What is missing, as the indices of a job array with a part per run: "3,17,20-24".
std::string missing_text(const SweepSummary& summary) {
    std::string text;
    const std::vector<RunRecord>& runs = summary.runs;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        if (runs[i].state == RunState::kDone) continue;
        std::size_t last = i;
        while (last + 1 < runs.size() && runs[last + 1].state != RunState::kDone) ++last;
        text += (text.empty() ? "" : ",") + std::to_string(i) + (last > i ? "-" + std::to_string(last) : "");
        i = last;
    }
    return text;
}

}  // namespace

Answer answer_of(const std::vector<SweepSummary>& summaries, const std::string& report,
                 const std::vector<LeftOutScene>& left_out) {
    Answer answer;
    std::vector<LeftOutScene> all_left_out = left_out;
    for (const SweepSummary& summary : summaries)
        for (const LeftOutScene& one : summary.manifest.subject.left_out) all_left_out.push_back(one);
    answer.fields["left_out"] = left_out_json(all_left_out);
    answer.fields["report"] = report.empty() ? Json(nullptr) : Json(report);
    answer.fields["sweeps"] = Json::array();
    for (const SweepSummary& summary : summaries) {
        answer.text += summary_text(summary);
        answer.fields["sweeps"].push_back(summary_json(summary));
        for (const RunRecord& run : summary.runs) {
            if (run.state != RunState::kFailed) continue;
            answer.code = ExitCode::kSomeJobsFailed;
            const std::string point = point_text(run.plan.at);
            answer.text += "  " + point + " failed: " + run.error + "\n";
            answer.errors.push_back(summary.manifest.subject.title + ", " + point + ": " + run.error);
        }
    }
    if (summaries.size() == 1) answer.fields["fits"] = answer.fields["sweeps"][0]["fits"];
    if (!report.empty()) answer.text += report + "\n";
    return answer;
}

Answer status_answer(const std::vector<SweepSummary>& summaries, const std::string& folder,
                     const std::vector<LeftOutScene>& left_out) {
    Answer answer = answer_of(summaries, folder, left_out);
    for (std::size_t i = 0; i < summaries.size(); ++i) {
        const std::string missing = missing_text(summaries[i]);
        answer.fields["sweeps"][i]["missing_parts"] = missing;
        if (!missing.empty())
            answer.text +=
                "not done: parts " + missing + " of " + std::to_string(summaries[i].runs.size()) + "\n";
    }
    return answer;
}

}  // namespace trilens
