// The sweep's own JSON files: written so that people can read them, read so that damage is noticed.
#include "sweep/store/sweep_folder.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <stdexcept>
#include <utility>

#include "base/files/files.h"
#include "base/util/error.h"
#include "json/json.h"
#include "report/text.h"

namespace trilens {
namespace {

constexpr const char* kManifestSchema = "trilens.sweep-manifest/3";
constexpr const char* kOldManifestSchema = "trilens.sweep-manifest/2";  // one axis, resolution
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

/// A number where the text is one, else the text.
Json json_of_value(const AxisValue& value) {
    if (value.number && value.text == shortest_text(*value.number))
        return *value.number == std::floor(*value.number) && std::abs(*value.number) < 1e15
                   ? Json(static_cast<std::int64_t>(*value.number))
                   : Json(*value.number);
    return value.text;
}

Json json_of_point(const Coordinates& point) {
    Json json = Json::object();
    for (const Coordinate& one : point) json[one.axis] = json_of_value(one.value);
    return json;
}

Json json_of_axis(const Axis& axis) {
    Json json = {{"name", axis.kind.name}, {"short_name", axis.kind.short_name}, {"label", axis.kind.label}};
    json["is_scale"] = axis.kind.is_scale;
    json["values"] = Json::array();
    for (const AxisValue& value : axis.values) json["values"].push_back(json_of_value(value));
    json["numbers"] = Json::array();
    for (const AxisValue& value : axis.values) json["numbers"].push_back(json_of_number(value.number));
    return json;
}

std::string text_of_value(const Json& json) {
    return json.is_number() ? shortest_text(json.get<double>()) : json.get<std::string>();
}

Axis axis_of_json(const Json& json) {
    Axis axis;
    axis.kind.name = json.at("name");
    axis.kind.short_name = json.at("short_name");
    axis.kind.label = json.at("label");
    axis.kind.is_scale = json.at("is_scale");
    const Json &values = json.at("values"), &numbers = json.at("numbers");
    for (std::size_t i = 0; i < values.size(); ++i)
        axis.values.push_back({text_of_value(values.at(i)), number_of_json(numbers.at(i))});
    return axis;
}

/// Of manifests that knew one axis of whole numbers.
Axis old_axis_of_json(const Json& json) {
    Axis axis;
    axis.kind.name = json.at("name");
    axis.kind.short_name = axis.kind.label = "n";
    axis.kind.is_scale = true;
    for (const Json& value : json.at("values"))
        axis.values.push_back({text_of_value(value), value.get<double>()});
    return axis;
}

/// With the numbers that the axes know for the texts.
Coordinates point_of_json(const Json& json, const SweepAxes& axes) {
    Coordinates point;
    if (!json.contains("point")) {
        const double n = json.at("n");
        return {{"resolution", {shortest_text(n), n}}};
    }
    for (const auto& [name, value] : json.at("point").items()) {
        Coordinate one{name, {text_of_value(value), std::nullopt}};
        for (const Axis& axis : axes.axes)
            for (const AxisValue& known : axis.values)
                if (axis.kind.name == name && known.text == one.value.text) one.value.number = known.number;
        point.push_back(one);
    }
    return point;
}

/// "n" where the resolution is an axis, as it was when there was no other.
void add_n(const PlannedRun& run, Json& json) {
    if (run.n() > 0) json["n"] = run.n();
}

Json json_of_run(const RunRecord& run) {
    Json json = {{"id", run.plan.id}};
    add_n(run.plan, json);
    json["point"] = json_of_point(run.plan.at);
    json["hash"] = run.plan.hash;
    json["status"] = state_name(run.state);
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
    Json json = {{"optic", fit.optic}, {"axis", fit.axis}, {"group", json_of_point(fit.group)}};
    json["layer"] = fit.layer.empty() ? Json(nullptr) : Json(fit.layer);
    json["metric"] = fit.metric;
    json["order"] = json_of_number(fit.order);
    json["order_low"] = json_of_number(fit.order_low);
    json["order_high"] = json_of_number(fit.order_high);
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

Json json_of_left_out(const std::vector<LeftOutScene>& scenes) {
    Json json = Json::array();
    for (const LeftOutScene& one : scenes) json.push_back({{"scene", one.scene}, {"reason", one.reason}});
    return json;
}

std::vector<LeftOutScene> left_out_of_json(const Json& json) {
    std::vector<LeftOutScene> scenes;
    for (const Json& one : json) scenes.push_back({one.at("scene"), one.at("reason")});
    return scenes;
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
                 {"spp", subject.spp}};
    json["commands"] = subject.commands;
    json["versions"] = Json::object();
    for (const auto& [name, version] : subject.versions) json["versions"][name] = version;
    if (!subject.left_out.empty()) json["left_out"] = json_of_left_out(subject.left_out);
    return json;
}

SweepSubject subject_of_json(const Json& json) {
    SweepSubject subject{json.at("title"),
                         json.at("scene"),
                         json.at("scene_name"),
                         json.at("scene_digest"),
                         json.at("camera"),
                         json.at("mesh"),
                         json.at("method"),
                         json.at("truth"),
                         json.at("spp"),
                         json.at("commands"),
                         {}};
    for (const auto& [name, version] : json.at("versions").items())
        subject.versions.emplace_back(name, version);
    if (json.contains("left_out")) subject.left_out = left_out_of_json(json.at("left_out"));
    return subject;
}

/// `read` of the JSON in `file`; whatever goes wrong is an InputError with the file's name.
template <typename Read>
auto read_json_file(const std::string& file, const Read& read) {
    const std::optional<std::string> text = read_whole_file(file);
    if (!text) throw InputError(file, "", "cannot be read");
    try {
        return read(*text);
    } catch (const Json::parse_error&) {
        throw InputError(file, "", "is no part of a sweep's results: it is no JSON");
    } catch (const Json::exception&) {
        throw InputError(file, "", "is no part of a sweep's results: a value is missing or of another kind");
    } catch (const std::exception& error) {
        throw InputError(file, "", std::string("is no part of a sweep's results: ") + error.what());
    }
}

}  // namespace

std::string manifest_text(const SweepManifest& manifest, const std::vector<PlannedRun>& plan) {
    Json json = {{"schema", kManifestSchema}};
    json["axes"] = Json::array();
    for (const Axis& axis : manifest.axes.axes) json["axes"].push_back(json_of_axis(axis));
    json["zip"] = manifest.axes.zip;
    json["runs"] = plan.size();
    json["subject"] = json_of_subject(manifest.subject);
    return json_document(json);
}

std::string plan_text(const std::vector<PlannedRun>& plan) {
    std::string text;
    for (const PlannedRun& run : plan) {
        Json json = {{"id", run.id}};
        add_n(run, json);
        json["point"] = json_of_point(run.at);
        json["hash"] = run.hash;
        json["truth"] = run.truth;
        text += json_line(json);
    }
    return text;
}

std::string run_text(const RunRecord& run) {
    Json json = {{"schema", kRunSchema}};
    json.update(json_of_run(run));
    return json_document(json);
}

std::string summary_text(const SweepSummary& summary) {
    Json json = {{"schema", kSummarySchema}, {"title", summary.manifest.subject.title}};
    json["axes"] = Json::array();
    for (const Axis& axis : summary.manifest.axes.axes) json["axes"].push_back(json_of_axis(axis));
    json["zip"] = summary.manifest.axes.zip;
    json["counts"] = {{"done", summary.count(RunState::kDone)},
                      {"failed", summary.count(RunState::kFailed)},
                      {"missing", summary.count(RunState::kMissing)}};
    if (!summary.manifest.subject.left_out.empty())
        json["left_out"] = json_of_left_out(summary.manifest.subject.left_out);
    json["fits"] = Json::array();
    for (const SweepFit& fit : summary.fits) json["fits"].push_back(json_of_fit(fit));
    json["runs"] = Json::array();
    for (const RunRecord& run : summary.runs) json["runs"].push_back(json_of_run(run));
    return json_document(json);
}

std::string left_out_text(const std::vector<LeftOutScene>& scenes) {
    return json_document(json_of_left_out(scenes));
}

std::vector<LeftOutScene> read_left_out(const std::string& file) {
    return read_json_file(file, [](const std::string& text) { return left_out_of_json(Json::parse(text)); });
}

SweepManifest read_manifest(const std::string& file) {
    return read_json_file(file, [](const std::string& text) {
        const Json json = Json::parse(text);
        SweepManifest manifest{subject_of_json(json.at("subject")), {}};
        if (json.at("schema") == kOldManifestSchema) {
            manifest.axes.axes.push_back(old_axis_of_json(json.at("axis")));
            return manifest;
        }
        if (json.at("schema") != kManifestSchema) throw std::invalid_argument("another schema");
        for (const Json& axis : json.at("axes")) manifest.axes.axes.push_back(axis_of_json(axis));
        manifest.axes.zip = json.at("zip");
        return manifest;
    });
}

std::vector<PlannedRun> read_plan(const std::string& file, const SweepAxes& axes) {
    return read_json_file(file, [&](const std::string& text) {
        std::vector<PlannedRun> plan;
        for (std::size_t at = 0; at < text.size();) {
            const std::size_t end = std::min(text.find('\n', at), text.size());
            const Json json = Json::parse(text.substr(at, end - at));
            plan.push_back({json.at("id"), point_of_json(json, axes), json.at("hash"), json.at("truth")});
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
