#include "suite/suite.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <utility>

#include "json/fields.h"
#include "json/json.h"
#include "json/schema.h"

namespace trilens {
namespace {

namespace fs = std::filesystem;

constexpr double kAny = std::numeric_limits<double>::infinity();

const std::map<std::string, Against> kAgainst = {
    {"golden", Against::kGolden}, {"truth", Against::kTruth}, {"facets", Against::kFacets}};
const std::map<std::string, ReferenceMaker> kMakers = {{"render", ReferenceMaker::kRender},
                                                       {"truth", ReferenceMaker::kTruth},
                                                       {"facets", ReferenceMaker::kFacets},
                                                       {"elsewhere", ReferenceMaker::kElsewhere}};

template <class Value>
std::vector<std::string> names_of(const std::map<std::string, Value>& values) {
    std::vector<std::string> names;
    for (const auto& [name, value] : values) names.push_back(name);
    return names;
}

Json at_least(double least) {
    return {{"type", "number"}, {"minimum", to_json_value(least)}};
}

/// What `max` may hold: a number for each metric.
Json limits_schema() {
    std::vector<FieldSchema> limits;
    for (const std::string& name : limited_names()) limits.push_back({name, {{"type", "number"}}, {}, {}});
    return object_schema({.title = "max"}, limits);
}

/// What a test may say; what is no plain setting is read by hand.
const std::vector<Field<RenderTest>>& test_fields() {
    static const std::vector<Field<RenderTest>> fields = [] {
        const auto fraction_of = [](const char* key) { return part<RenderTest>(key, at_least(0)); };
        return std::vector<Field<RenderTest>>{
            part<RenderTest>("scene", some_text()),
            part<RenderTest>("against",
                             {{"type", {"string", "array"}}, {"minItems", 1}, {"uniqueItems", true}}),
            part<RenderTest>("reference", some_text()),
            part<RenderTest>("reference_from", word_of(names_of(kMakers))),
            setting("engine", &RenderTest::engine, some_text()),
            setting("camera", &RenderTest::camera, some_text()),
            part<RenderTest>("resolution", {{"type", {"integer", "array"}},
                                            {"minimum", 1},
                                            {"maximum", 1024},
                                            {"minItems", 1},
                                            {"items", whole_in(1, 1024)}}),
            part<RenderTest>("set", {{"type", "object"}}),
            part<RenderTest>("max", limits_schema()),
            fraction_of("fail"),
            part<RenderTest>("failpercent", number_in(0, 100)),
            fraction_of("hardfail"),
            fraction_of("failrelative"),
            part<RenderTest>("allowfailures", whole_in(0, std::numeric_limits<int>::max())),
            part<RenderTest>("layer", some_text()),
            setting("radius", &RenderTest::radius, number_in(1, 4096)),
            part<RenderTest>("tags", list_of(some_text())),
            part<RenderTest>("platforms", list_of(some_text())),
            setting("about", &RenderTest::about, some_text())};
    }();
    return fields;
}

const Json& test_schema_json() {
    static const Json schema = file_schema(
        "trilens-test-1", object_schema({.title = "a test", .required = {"against"}}, test_fields()));
    return schema;
}

/// The JSON of a test.json, checked.
Json checked_test(const std::string& file) {
    Json json = parse_json(read_required_file(file), file);
    if (const auto found = find_problem(json, test_schema_json()))
        fail_at(file, found->place, found->message);
    return json;
}

Against against_of(const Node& value) {
    const auto found = value.json.is_string() ? kAgainst.find(value.json.get<std::string>()) : kAgainst.end();
    if (found != kAgainst.end()) return found->second;
    value.fail("is none of \"golden\", \"truth\" and \"facets\", but " + describe(value.json));
}

std::vector<Against> read_against(const Node& value) {
    if (!value.json.is_array()) return {against_of(value)};
    std::vector<Against> all;
    for (std::size_t i = 0; i < value.size(); ++i) all.push_back(against_of(value[i]));
    return all;
}

std::vector<int> read_resolutions(const Node& value) {
    if (!value.json.is_array()) return {value.json.get<int>()};
    std::vector<int> all;
    for (std::size_t i = 0; i < value.size(); ++i) {
        all.push_back(value[i].json.get<int>());
        if (i > 0 && all[i] <= all[i - 1]) value[i].fail("resolutions rise");
    }
    return all;
}

std::vector<SceneSetting> read_settings(const Node& set) {
    std::vector<SceneSetting> all;
    for (const auto& [pointer, value] : set.json.items()) {
        if (pointer.empty() || pointer[0] != '/')
            set.fail("\"" + pointer + "\" is no JSON pointer: it starts with /");
        all.push_back({pointer, value.dump()});
    }
    return all;
}

std::vector<MetricLimit> read_limits(const Node& max, std::size_t resolutions) {
    std::vector<MetricLimit> all;
    for (const auto& [metric, value] : max.json.items()) {
        if (is_free_key(metric)) continue;
        if (metric.find("displacement_order") != std::string::npos && resolutions < 2)
            max[metric.c_str()].fail("an order needs several resolutions: \"resolution\": [4, 8, 16]");
        all.push_back({metric, value.get<double>()});
    }
    if (all.empty()) max.fail("limits nothing, so that nothing could fail");
    return all;
}

CompareOptions read_compare(const Node& test) {
    CompareOptions options;
    options.layer = string_or(test, "layer", "");
    bool has_rule = false;
    for (const char* key : {"fail", "failpercent", "failrelative", "hardfail", "allowfailures"})
        has_rule = has_rule || test.has(key);
    if (!has_rule) {
        // Counted, for limits on the counts, but no rule of their own.
        if (test.has("max")) options.allowfailures = std::numeric_limits<std::size_t>::max();
        return options;
    }
    const double fail = test.has("failpercent") ? options.fail : kAny;
    options.hardfail = number_or(test, "hardfail", kAny);
    options.fail = number_or(test, "fail", fail);
    options.failrelative = number_or(test, "failrelative", 0);
    options.failpercent = number_or(test, "failpercent", 0);
    if (test.has("allowfailures")) options.allowfailures = test.json.at("allowfailures").get<std::size_t>();
    // A count of pixels beyond nothing would hold whatever happens.
    if (!test.has("max")) return options;
    const Node max = test["max"];
    if (max.has("fail") && std::isinf(std::min(options.fail, options.hardfail)))
        max["fail"].fail("counts the pixels beyond fail or hardfail, and neither is given");
    if (max.has("hard") && std::isinf(options.hardfail))
        max["hard"].fail("counts the pixels beyond hardfail, which is not given");
    return options;
}

}  // namespace

std::string against_name(Against against) {
    for (const auto& [name, value] : kAgainst)
        if (value == against) return name;
    return "";
}

std::string test_schema() {
    return test_schema_json().dump(2) + "\n";
}

std::vector<std::string> limited_names() {
    std::vector<std::string> names = metric_names();
    for (const char* layer : {"", "reflect.", "refract."})
        names.push_back(std::string(layer) + "displacement_order");
    return names;
}

RenderTest read_render_test(const std::string& folder) {
    const std::string file = (fs::path(folder) / "test.json").string();
    const Json json = checked_test(file);
    const Node root{json, "", file};
    RenderTest test;
    read_fields(root, test_fields(), test);
    test.folder = folder;
    const auto beside = [&](const std::string& name) {
        return (fs::path(folder) / name).lexically_normal().string();
    };
    test.scene = beside(string_or(root, "scene", "scene.json"));
    test.reference = beside(string_or(root, "reference", "ref/main.exr"));
    test.against = read_against(root["against"]);
    if (root.has("reference_from"))
        test.reference_maker = kMakers.at(json.at("reference_from").get<std::string>());
    if (root.has("resolution")) test.resolutions = read_resolutions(root["resolution"]);
    if (root.has("set")) test.set = read_settings(root["set"]);
    if (root.has("max")) test.max = read_limits(root["max"], test.resolutions.size());
    test.compare = read_compare(root);
    if (root.has("platforms")) test.platforms = json.at("platforms").get<std::vector<std::string>>();
    if (root.has("tags")) test.tags = json.at("tags").get<std::vector<std::string>>();
    return test;
}

}  // namespace trilens
