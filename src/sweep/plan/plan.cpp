#include "sweep/plan/plan.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <map>
#include <optional>
#include <string_view>

#include "base/description/digest.h"
#include "base/files/files.h"
#include "base/util/error.h"
#include "json/fields.h"
#include "json/json.h"
#include "json/schema.h"

namespace trilens {
namespace {

// Part of every hash: raise it when what a run stores changes.
constexpr const char* kFormat = "trilens.sweep/3";

/// Hash of parts such that no two lists of parts read the same.
std::string hash_parts(const std::vector<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts) text += std::to_string(part.size()) + ":" + part;
    return hash_text(text);
}

/// Optics whose names tell them apart from each other and from "all": where they do not, the object's id is
/// added.
std::vector<SweptOptic> distinct_optics(const std::vector<SweptOptic>& optics) {
    std::map<std::string, int> uses = {{"all", 1}};
    for (const SweptOptic& optic : optics) ++uses[optic.name];
    std::vector<SweptOptic> distinct = optics;
    for (SweptOptic& optic : distinct)
        if (uses[optic.name] > 1) optic.name += " #" + std::to_string(optic.object);
    return distinct;
}

PlannedRun planned_run(const SweepAxes& axes, const Coordinates& point, const RunKeys& keys) {
    PlannedRun run{point_id(axes, point), point, "", hash_parts({kFormat, "truth", keys.truth})};
    run.optics = distinct_optics(keys.optics);
    std::vector<std::string> parts = {kFormat, run.truth, keys.job};
    for (const SweptOptic& optic : run.optics) {
        parts.push_back(std::to_string(optic.object));
        parts.push_back(optic.name);
    }
    run.hash = hash_parts(parts);
    return run;
}

}  // namespace

std::vector<PlannedRun> make_plan(const SweepAxes& axes,
                                  const std::function<RunKeys(const Coordinates&)>& keys) {
    const std::vector<Coordinates> points = make_points(axes);
    std::map<std::string, const Coordinates*> names;
    for (const Coordinates& point : points) {
        const auto [known, is_new] = names.emplace(point_id(axes, point), &point);
        if (!is_new)
            throw UsageError("two points have one name, " + known->first + ": " + point_text(*known->second) +
                             "; and " + point_text(point));
    }
    std::vector<PlannedRun> plan;
    for (const Coordinates& point : points) plan.push_back(planned_run(axes, point, keys(point)));
    return plan;
}

// Which part of a plan one process does: the text of --shard.

namespace {

/// All of `text` as a whole number; none where it is not one or does not fit.
std::optional<int> whole_number(std::string_view text) {
    int value = 0;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end.ec != std::errc() || end.ptr != text.data() + text.size()) return std::nullopt;
    return value;
}

/// The variables of one kind of job array; null where it has none. The size is `last` or `count`.
struct ArrayVariables {
    const char *index, *first, *step, *last, *count;
    int default_first;
};

constexpr std::array<ArrayVariables, 4> kArrays = {{
    {"SLURM_ARRAY_TASK_ID", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_STEP", nullptr,
     "SLURM_ARRAY_TASK_COUNT", 0},
    {"SGE_TASK_ID", "SGE_TASK_FIRST", "SGE_TASK_STEPSIZE", "SGE_TASK_LAST", nullptr, 1},
    {"LSB_JOBINDEX", nullptr, "LSB_JOBINDEX_STEP", "LSB_JOBINDEX_END", nullptr, 1},
    {"GTEST_SHARD_INDEX", nullptr, nullptr, nullptr, "GTEST_TOTAL_SHARDS", 0},
}};

std::optional<int> variable(const Environment& environment, const char* name) {
    const char* value = name ? environment(name) : nullptr;
    return value ? whole_number(value) : std::nullopt;
}

Shard shard_from(const Environment& environment) {
    for (const ArrayVariables& array : kArrays) {
        const std::optional<int> index = variable(environment, array.index);
        if (!index) continue;
        const int first = variable(environment, array.first).value_or(array.default_first);
        const int step = std::max(1, variable(environment, array.step).value_or(1));
        const std::optional<int> last = variable(environment, array.last);
        const int count = last ? (*last - first) / step + 1 : variable(environment, array.count).value_or(0);
        const Shard shard{(*index - first) / step, count};
        if (*index < first || shard.index >= shard.count)
            throw UsageError(std::string("--shard auto: ") + array.index + "=" + std::to_string(*index) +
                             " does not fit the array's size");
        return shard;
    }
    throw UsageError(
        "--shard auto: no job array's variables are set (SLURM_ARRAY_TASK_ID, SGE_TASK_ID, "
        "LSB_JOBINDEX, GTEST_SHARD_INDEX)");
}

}  // namespace

Shard parse_shard(const std::string& text, const Environment& environment) {
    if (text == "auto") return shard_from(environment);
    const std::size_t slash = text.find('/');
    const auto index = whole_number(std::string_view(text).substr(0, slash));
    const auto count =
        slash == std::string::npos ? std::nullopt : whole_number(std::string_view(text).substr(slash + 1));
    if (!index || !count || *index < 0 || *index >= *count)
        throw UsageError("--shard " + text + ": is not i/n with 0 <= i < n, nor auto");
    return {*index, *count};
}

namespace {

/// What a sweep file may say; axes, scenes and what is set are read by hand.
const std::vector<Field<SweepFile>>& sweep_fields() {
    static const std::vector<Field<SweepFile>> fields = [] {
        const Json axis = object_schema(
            {.title = "an axis", .required = {"axis", "values"}},
            std::vector<FieldSchema>{{.key = "axis", .schema = some_text(), .kinds = {}, .needed_by = {}},
                                     {.key = "values",
                                      .schema = {{"type", {"array", "string"}}, {"minItems", 1}},
                                      .kinds = {},
                                      .needed_by = {}}});
        return std::vector<Field<SweepFile>>{
            part<SweepFile>("version", whole_in(1, 1)),
            part<SweepFile>("scenes", list_of(some_text(), 1)),
            part<SweepFile>("over", list_of(axis, 1)),
            setting("zip", &SweepFile::zip, yes_or_no()),
            setting("truth", &SweepFile::truth, word_of({"limit", "facets"})),
            setting("camera", &SweepFile::camera, some_text()),
            setting("title", &SweepFile::title, some_text()),
            setting("repeats", &SweepFile::repeats, whole_in(1, 1000)),
            part<SweepFile>("set", {{"type", "object"}})};
    }();
    return fields;
}

const Json& sweep_schema_json() {
    static const Json schema = file_schema(
        "trilens-sweep-1", object_schema({.title = "a sweep file", .required = {"over"}}, sweep_fields()));
    return schema;
}

/// A sweep file's JSON, checked.
Json checked_sweep(const std::string& file) {
    Json json = parse_json(read_required_file(file), file);
    if (const auto found = find_problem(json, sweep_schema_json()))
        fail_at(file, found->place, found->message);
    return json;
}

/// As --over takes it: texts bare, all else as JSON.
std::string scalar_text(const Json& json) {
    return json.is_string() ? json.get<std::string>() : json.dump();
}

AxisRequest read_axis(const Json& part) {
    AxisRequest request{part.at("axis").get<std::string>(), {}};
    const Json& values = part.at("values");
    if (values.is_string())
        request.values = parse_over(request.axis + "=" + values.get<std::string>()).values;
    else
        for (const Json& value : values) request.values.push_back(scalar_text(value));
    return request;
}

}  // namespace

std::string sweep_schema() {
    return sweep_schema_json().dump(2) + "\n";
}

SweepFile read_sweep_file(const std::string& file) {
    const Json json = checked_sweep(file);
    SweepFile sweep;
    read_fields(Node{json, "", file}, sweep_fields(), sweep);
    for (const Json& axis : json.at("over")) sweep.over.push_back(read_axis(axis));
    if (json.contains("scenes")) sweep.scenes = json.at("scenes").get<std::vector<std::string>>();
    if (json.contains("set"))
        for (const auto& [pointer, value] : json.at("set").items())
            sweep.set.emplace_back(pointer, value.dump());
    return sweep;
}

bool is_sweep_file(const std::string& file) {
    const std::optional<std::string> text = read_whole_file(file);
    if (!text) return false;
    const Json json = Json::parse(*text, nullptr, false, true);
    return json.is_object() && json.contains("over");
}

}  // namespace trilens
