#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "base/files/file_bytes.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/suggestion.h"
#include "suite/json.h"
#include "suite/render_test.h"

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

const std::vector<std::string> kKeys = {
    "scene", "against", "reference", "reference_from", "engine",   "camera",       "resolution",
    "set",   "max",     "fail",      "failpercent",    "hardfail", "failrelative", "allowfailures",
    "layer", "radius",  "tags",      "platforms",      "about"};

template <class Value>
std::vector<std::string> names_of(const std::map<std::string, Value>& values) {
    std::vector<std::string> names;
    for (const auto& [name, value] : values) names.push_back(name);
    return names;
}

/// A key that stands twice would hide a threshold.
Json parse(const std::string& bytes, const std::string& file) {
    std::vector<std::set<std::string>> open;
    std::string twice;
    const auto watch = [&](int, Json::parse_event_t event, Json& parsed) {
        if (event == Json::parse_event_t::object_start) open.emplace_back();
        if (event == Json::parse_event_t::object_end) open.pop_back();
        if (event == Json::parse_event_t::key && !open.back().insert(parsed.get<std::string>()).second)
            twice = parsed.get<std::string>();
        return true;
    };
    try {
        Json json = Json::parse(bytes, watch, true, true);
        if (!twice.empty()) throw InputError(file, twice, "stands there twice");
        if (!json.is_object()) throw InputError(file, "", "a test is a JSON object");
        return json;
    } catch (const Json::parse_error& error) {
        const std::string what = error.what();
        const std::size_t text = what.find("] ");
        throw InputError(file, "", one_line(text == std::string::npos ? what : what.substr(text + 2)));
    }
}

struct TestReader {
    const std::string& file;
    const Json& json;

    [[noreturn]] void fail(const std::string& place, const std::string& message) const {
        throw InputError(file, "/" + place, one_line(message));
    }

    std::string text(const std::string& place, const Json& value) const {
        if (!value.is_string() || value.get<std::string>().empty()) fail(place, "expected a text");
        return value.get<std::string>();
    }
    std::string text_or(const std::string& key, const std::string& fallback) const {
        return json.contains(key) ? text(key, json[key]) : fallback;
    }

    std::vector<std::string> texts(const std::string& key) const {
        std::vector<std::string> all;
        if (!json.contains(key)) return all;
        if (!json[key].is_array()) fail(key, "expected a list of texts");
        for (std::size_t i = 0; i < json[key].size(); ++i)
            all.push_back(text(key + "/" + std::to_string(i), json[key][i]));
        return all;
    }

    double number(const std::string& place, const Json& value, double least, double most) const {
        if (!value.is_number()) fail(place, "expected a number");
        const double read = value.get<double>();
        if (!(read >= least && read <= most)) {
            fail(place, std::isfinite(most) ? fmt::format("{} is not from {} to {}", read, least, most)
                                            : fmt::format("{} is less than {}", read, least));
        }
        return read;
    }
    double number_or(const std::string& key, double least, double most, double fallback) const {
        return json.contains(key) ? number(key, json[key], least, most) : fallback;
    }

    int whole(const std::string& place, const Json& value, int least, int most) const {
        if (!value.is_number_integer()) fail(place, "expected a whole number");
        return static_cast<int>(number(place, value, least, most));
    }

    template <class Value>
    Value one_of(const std::string& place, const Json& value,
                 const std::map<std::string, Value>& known) const {
        const std::string name = text(place, value);
        const auto found = known.find(name);
        if (found == known.end())
            fail(place, "there is no \"" + name + "\"" + suggestion(name, names_of(known)));
        return found->second;
    }
};

void check_keys(const TestReader& reader) {
    for (const auto& [key, value] : reader.json.items()) {
        const bool is_free = key == "extras" || key.rfind("x-", 0) == 0;
        if (!is_free && std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end())
            reader.fail(key, "unknown key \"" + key + "\"" + suggestion(key, kKeys));
    }
}

std::vector<Against> read_against(const TestReader& reader) {
    if (!reader.json.contains("against"))
        throw InputError(reader.file, "", "\"against\" is missing: \"golden\", \"truth\" or \"facets\"");
    const Json& value = reader.json["against"];
    std::vector<Against> all;
    const auto add = [&](const std::string& place, const Json& one) {
        const Against against = reader.one_of(place, one, kAgainst);
        if (std::find(all.begin(), all.end(), against) != all.end()) reader.fail(place, "is there twice");
        all.push_back(against);
    };
    if (!value.is_array()) add("against", value);
    for (std::size_t i = 0; value.is_array() && i < value.size(); ++i)
        add("against/" + std::to_string(i), value[i]);
    if (all.empty()) reader.fail("against", "names nothing: \"golden\", \"truth\" or \"facets\"");
    return all;
}

std::vector<int> read_resolutions(const TestReader& reader) {
    if (!reader.json.contains("resolution")) return {};
    const Json& value = reader.json["resolution"];
    if (!value.is_array()) return {reader.whole("resolution", value, 1, 1024)};
    std::vector<int> all;
    for (std::size_t i = 0; i < value.size(); ++i) {
        const std::string place = "resolution/" + std::to_string(i);
        all.push_back(reader.whole(place, value[i], 1, 1024));
        if (i > 0 && all[i] <= all[i - 1]) reader.fail(place, "resolutions rise");
    }
    if (all.empty()) reader.fail("resolution", "is an empty list");
    return all;
}

std::vector<SceneSetting> read_settings(const TestReader& reader) {
    std::vector<SceneSetting> all;
    if (!reader.json.contains("set")) return all;
    if (!reader.json["set"].is_object()) reader.fail("set", "expected an object of /json/pointer: value");
    for (const auto& [pointer, value] : reader.json["set"].items()) {
        if (pointer.empty() || pointer[0] != '/')
            reader.fail("set", "\"" + pointer + "\" is no JSON pointer: it starts with /");
        all.push_back({pointer, value.dump()});
    }
    return all;
}

std::vector<MetricLimit> read_limits(const TestReader& reader, std::size_t resolutions) {
    std::vector<MetricLimit> all;
    if (!reader.json.contains("max")) return all;
    if (!reader.json["max"].is_object()) reader.fail("max", "expected an object of metric: number");
    if (reader.json["max"].empty()) reader.fail("max", "limits nothing, so that nothing could fail");
    const std::vector<std::string> known = limited_names();
    for (const auto& [metric, value] : reader.json["max"].items()) {
        if (std::find(known.begin(), known.end(), metric) == known.end())
            reader.fail("max", "there is no metric \"" + metric + "\"" + suggestion(metric, known));
        if (metric.find("displacement_order") != std::string::npos && resolutions < 2)
            reader.fail("max/" + metric, "an order needs several resolutions: \"resolution\": [4, 8, 16]");
        all.push_back({metric, reader.number("max/" + metric, value, -kAny, kAny)});
    }
    return all;
}

CompareOptions read_compare(const TestReader& reader) {
    const Json& json = reader.json;
    CompareOptions options;
    options.layer = reader.text_or("layer", "");
    bool has_rule = false;
    for (const char* key : {"fail", "failpercent", "failrelative", "hardfail", "allowfailures"})
        has_rule = has_rule || json.contains(key);
    if (!has_rule) {
        // Counted, for limits on the counts, but no rule of their own.
        if (json.contains("max")) options.allowfailures = std::numeric_limits<std::size_t>::max();
        return options;
    }
    const double fail = json.contains("failpercent") ? options.fail : kAny;
    options.hardfail = reader.number_or("hardfail", 0, kAny, kAny);
    options.fail = reader.number_or("fail", 0, kAny, fail);
    options.failrelative = reader.number_or("failrelative", 0, kAny, 0);
    options.failpercent = reader.number_or("failpercent", 0, 100, 0);
    if (json.contains("allowfailures"))
        options.allowfailures = static_cast<std::size_t>(
            reader.whole("allowfailures", json["allowfailures"], 0, std::numeric_limits<int>::max()));
    // A count of pixels beyond nothing would hold whatever happens.
    if (json.contains("max") && json["max"].contains("fail") &&
        std::isinf(std::min(options.fail, options.hardfail)))
        reader.fail("max/fail", "counts the pixels beyond fail or hardfail, and neither is given");
    if (json.contains("max") && json["max"].contains("hard") && std::isinf(options.hardfail))
        reader.fail("max/hard", "counts the pixels beyond hardfail, which is not given");
    return options;
}

}  // namespace

std::string against_name(Against against) {
    for (const auto& [name, value] : kAgainst)
        if (value == against) return name;
    return "";
}

std::vector<std::string> limited_names() {
    std::vector<std::string> names = metric_names();
    for (const char* layer : {"", "reflect.", "refract."})
        names.push_back(std::string(layer) + "displacement_order");
    return names;
}

RenderTest read_render_test(const std::string& folder) {
    const std::string file = (fs::path(folder) / "test.json").string();
    const std::optional<std::string> bytes = read_whole_file(file);
    if (!bytes) throw InputError(file, "", "cannot be read");
    const Json json = parse(*bytes, file);
    const TestReader reader{file, json};
    check_keys(reader);

    RenderTest test;
    test.folder = folder;
    const auto beside = [&](const std::string& name) {
        return (fs::path(folder) / name).lexically_normal().string();
    };
    test.scene = beside(reader.text_or("scene", "scene.json"));
    test.reference = beside(reader.text_or("reference", "ref/main.exr"));
    test.against = read_against(reader);
    if (json.contains("reference_from"))
        test.reference_maker = reader.one_of("reference_from", json["reference_from"], kMakers);
    test.engine = reader.text_or("engine", "exact");
    test.camera = reader.text_or("camera", "");
    test.resolutions = read_resolutions(reader);
    test.set = read_settings(reader);
    test.max = read_limits(reader, test.resolutions.size());
    test.compare = read_compare(reader);
    test.radius = reader.number_or("radius", 1, 4096, test.radius);
    test.platforms = reader.texts("platforms");
    test.tags = reader.texts("tags");
    test.about = reader.text_or("about", "");
    return test;
}

}  // namespace trilens
