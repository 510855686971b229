// The sweep's own JSON files: written so that people can read them, read so that damage is noticed.
#include "sweep/results_json.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <stdexcept>
#include <utility>

#include "base/error.h"
#include "base/files.h"
#include "sweep/json.h"

namespace trilens {
namespace {

constexpr const char* kManifestSchema = "trilens.sweep-manifest/2";
constexpr const char* kRunSchema = "trilens.sweep-run/1";
constexpr const char* kSummarySchema = "trilens.sweep-summary/1";

Json json_of_metrics(const MetricValues& metrics) {
    Json json = Json::object();
    for (const auto& [name, value] : metrics) json[name] = json_of_number(value);
    return json;
}

MetricValues metrics_of_json(const Json& json) {
    MetricValues metrics;
    for (const auto& [name, value] : json.items())
        if (const std::optional<double> number = number_of_json(value)) metrics[name] = *number;
    return metrics;
}

Json json_of_run(const RunRecord& run) {
    Json json = {
        {"id", run.plan.id}, {"n", run.plan.n}, {"hash", run.plan.hash}, {"status", state_name(run.state)}};
    if (run.state == RunState::kFailed) {
        json["exit_code"] = run.exit_code;
        json["error"] = run.error;
    }
    if (run.state == RunState::kDone) {
        json["metrics"] = json_of_metrics(run.metrics);
        json["displacement"] = Json::array();
        for (const OpticDisplacement& one : run.displacement)
            json["displacement"].push_back(
                {{"layer", one.layer}, {"optic", one.optic}, {"metrics", json_of_metrics(one.metrics)}});
    }
    json["warnings"] = run.warnings;
    return json;
}

/// Resolutions are whole numbers.
Json json_of_resolution(std::optional<double> n) {
    return n ? Json(static_cast<std::int64_t>(*n)) : Json(nullptr);
}

Json json_of_fit(const SweepFit& fit) {
    Json json = {{"optic", fit.optic}};
    json["layer"] = fit.layer.empty() ? Json(nullptr) : Json(fit.layer);
    json["metric"] = fit.metric;
    json["order"] = json_of_number(fit.order);
    json["constant"] = json_of_number(fit.constant);
    json["r2"] = json_of_number(fit.r2);
    json["n_for_1px"] = json_of_resolution(fit.n_for_1px);
    json["n_for_half_px"] = json_of_resolution(fit.n_for_half_px);
    json["coverage"] = json_of_number(fit.coverage);
    json["points"] = Json::array();
    for (const SweepPoint& point : fit.points)
        json["points"].push_back(
            {{"n", point.n}, {"value", json_of_number(point.value)}, {"used", point.used}});
    return json;
}

Json json_of_subject(const SweepSubject& subject) {
    Json json = {{"title", subject.title},
                 {"scene", subject.scene},
                 {"scene_name", subject.scene_name},
                 {"scene_digest", subject.scene_digest},
                 {"camera", subject.camera},
                 {"mesh", subject.mesh},
                 {"method", subject.method},
                 {"truth", subject.truth},
                 {"spp", subject.spp},
                 {"threads", subject.threads},
                 {"isa", subject.isa}};
    json["optics"] = Json::array();
    for (const SweptOptic& optic : subject.optics)
        json["optics"].push_back({{"object", optic.object}, {"name", optic.name}});
    json["commands"] = subject.commands;
    json["versions"] = Json::object();
    for (const auto& [name, version] : subject.versions) json["versions"][name] = version;
    return json;
}

SweepSubject subject_of_json(const Json& json) {
    SweepSubject subject{json.at("title"),      json.at("scene"),
                         json.at("scene_name"), json.at("scene_digest"),
                         json.at("camera"),     json.at("mesh"),
                         json.at("method"),     json.at("truth"),
                         json.at("spp"),        json.at("threads"),
                         json.at("isa"),        {},
                         json.at("commands"),   {}};
    for (const Json& optic : json.at("optics"))
        subject.optics.push_back({optic.at("object"), optic.at("name")});
    for (const auto& [name, version] : json.at("versions").items())
        subject.versions.emplace_back(name, version);
    return subject;
}

/// `read` of the JSON in `file`; whatever goes wrong is an InputError with the file's name.
template <typename Read>
auto read_json_file(const std::string& file, const Read& read) {
    const std::optional<std::string> text = read_whole_file(file);
    if (!text) throw InputError(file, "", "cannot be read");
    try {
        return read(*text);
    } catch (const std::exception& error) {
        throw InputError(file, "", std::string("is no part of a sweep's results: ") + error.what());
    }
}

}  // namespace

std::string manifest_text(const SweepManifest& manifest, const std::vector<PlannedRun>& plan) {
    Json json = {{"schema", kManifestSchema}};
    json["axis"] = {{"name", manifest.axis.name}, {"values", manifest.axis.values}};
    json["runs"] = plan.size();
    json["subject"] = json_of_subject(manifest.subject);
    return json_document(json);
}

std::string plan_text(const std::vector<PlannedRun>& plan) {
    std::string text;
    for (const PlannedRun& run : plan)
        text += json_line({{"id", run.id}, {"n", run.n}, {"hash", run.hash}, {"truth", run.truth}});
    return text;
}

std::string run_text(const RunRecord& run) {
    Json json = {{"schema", kRunSchema}};
    json.update(json_of_run(run));
    return json_document(json);
}

std::string summary_text(const SweepSummary& summary) {
    Json json = {{"schema", kSummarySchema}, {"title", summary.manifest.subject.title}};
    json["counts"] = {{"done", summary.count(RunState::kDone)},
                      {"failed", summary.count(RunState::kFailed)},
                      {"missing", summary.count(RunState::kMissing)}};
    json["fits"] = Json::array();
    for (const SweepFit& fit : summary.fits) json["fits"].push_back(json_of_fit(fit));
    json["runs"] = Json::array();
    for (const RunRecord& run : summary.runs) json["runs"].push_back(json_of_run(run));
    return json_document(json);
}

SweepManifest read_manifest(const std::string& file) {
    return read_json_file(file, [](const std::string& text) {
        const Json json = Json::parse(text);
        if (json.at("schema") != kManifestSchema) throw std::invalid_argument("another schema");
        const Json& axis = json.at("axis");
        return SweepManifest{subject_of_json(json.at("subject")), Axis{axis.at("name"), axis.at("values")}};
    });
}

std::vector<PlannedRun> read_plan(const std::string& file) {
    return read_json_file(file, [](const std::string& text) {
        std::vector<PlannedRun> plan;
        for (std::size_t at = 0; at < text.size();) {
            const std::size_t end = std::min(text.find('\n', at), text.size());
            const Json json = Json::parse(text.substr(at, end - at));
            plan.push_back({json.at("id"), json.at("n"), json.at("hash"), json.at("truth")});
            at = end + 1;
        }
        return plan;
    });
}

std::optional<RunRecord> parse_run(const std::string& text, const PlannedRun& plan) {
    // Damage is a reason to run again, not to stop: any way in which the text is not what run_text writes
    // gives none.
    try {
        const Json json = Json::parse(text);
        if (json.at("schema") != kRunSchema || json.at("hash") != plan.hash) return std::nullopt;
        RunRecord run;
        run.plan = plan;
        run.warnings = json.at("warnings");
        if (json.at("status") == state_name(RunState::kFailed)) {
            run.state = RunState::kFailed;
            run.exit_code = json.at("exit_code");
            run.error = json.at("error");
            return run;
        }
        run.state = RunState::kDone;
        run.metrics = metrics_of_json(json.at("metrics"));
        for (const Json& one : json.at("displacement"))
            run.displacement.push_back(
                {one.at("layer"), one.at("optic"), metrics_of_json(one.at("metrics"))});
        return run;
    } catch (const std::exception&) {
        return std::nullopt;
    }
}

}  // namespace trilens
