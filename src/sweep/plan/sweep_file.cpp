#include "sweep/plan/sweep_file.h"

#include <algorithm>
#include <map>

#include "base/files/file_bytes.h"
#include "base/util/error.h"
#include "base/util/suggestion.h"
#include "sweep/store/json.h"

namespace trilens {
namespace {

/// A part of the file, with the place that messages name.
struct JsonPart {
    const std::string& file;
    const Json& json;
    std::string place;

    [[noreturn]] void fail(const std::string& why) const { throw InputError(file, place, why); }
    JsonPart at(const std::string& key) const { return {file, json.at(key), place + "/" + key}; }
    JsonPart at(std::size_t i) const { return {file, json.at(i), place + "/" + std::to_string(i)}; }

    std::string text() const {
        if (!json.is_string()) fail("is no text");
        return json.get<std::string>();
    }
    bool truth_value() const {
        if (!json.is_boolean()) fail("is neither true nor false");
        return json.get<bool>();
    }
    void require_array() const {
        if (!json.is_array()) fail("is no list");
        if (json.empty()) fail("is empty");
    }
    void check_keys(std::initializer_list<const char*> allowed) const {
        if (!json.is_object()) fail("is no object");
        const std::vector<std::string> known(allowed.begin(), allowed.end());
        for (const auto& [key, value] : json.items())
            if (key.rfind("x-", 0) != 0 && key != "extras" &&
                std::find(known.begin(), known.end(), key) == known.end())
                throw InputError(file, place + "/" + key, "unknown key" + suggestion(key, known));
    }
};

/// As --over takes it: texts bare, all else as JSON.
std::string scalar_text(const Json& json) {
    return json.is_string() ? json.get<std::string>() : json.dump();
}

AxisRequest read_axis(const JsonPart& part) {
    part.check_keys({"axis", "values"});
    for (const char* key : {"axis", "values"})
        if (!part.json.contains(key)) part.fail(std::string("has no \"") + key + "\"");
    AxisRequest request{part.at("axis").text(), {}};
    const JsonPart values = part.at("values");
    if (values.json.is_string()) {
        request.values = parse_over(request.axis + "=" + values.text()).values;
        return request;
    }
    if (!values.json.is_array()) values.fail("is no list");
    if (values.json.empty()) values.fail("the axis " + request.axis + " has no point");
    for (const Json& value : values.json) request.values.push_back(scalar_text(value));
    return request;
}

Json parse_file(const std::string& file) {
    const std::optional<std::string> text = read_whole_file(file);
    if (!text) throw InputError(file, "", "cannot be read");
    try {
        return Json::parse(*text, nullptr, true, true);
    } catch (const Json::parse_error& error) {
        throw InputError(file, "", std::string("is no JSON: ") + error.what());
    }
}

}  // namespace

SweepFile read_sweep_file(const std::string& file) {
    const Json json = parse_file(file);
    const JsonPart root{file, json, ""};
    root.check_keys({"version", "scenes", "over", "zip", "truth", "camera", "title", "repeats", "set"});
    SweepFile sweep;
    if (!json.contains("over")) root.fail("has no \"over\"");
    const JsonPart over = root.at("over");
    over.require_array();
    for (std::size_t i = 0; i < over.json.size(); ++i) sweep.over.push_back(read_axis(over.at(i)));
    if (json.contains("scenes")) {
        const JsonPart scenes = root.at("scenes");
        scenes.require_array();
        for (std::size_t i = 0; i < scenes.json.size(); ++i) sweep.scenes.push_back(scenes.at(i).text());
    }
    if (json.contains("zip")) sweep.zip = root.at("zip").truth_value();
    const std::map<std::string, std::string*> texts = {
        {"truth", &sweep.truth}, {"camera", &sweep.camera}, {"title", &sweep.title}};
    for (const auto& [key, target] : texts)
        if (json.contains(key)) *target = root.at(key).text();
    if (json.contains("repeats")) {
        const JsonPart repeats = root.at("repeats");
        if (!repeats.json.is_number_integer() || repeats.json < 1 || repeats.json > 1000)
            repeats.fail("is no whole number from 1 to 1000");
        sweep.repeats = repeats.json;
    }
    if (json.contains("set")) {
        const JsonPart set = root.at("set");
        if (!set.json.is_object()) set.fail("is no object");
        for (const auto& [pointer, value] : set.json.items()) sweep.set.emplace_back(pointer, value.dump());
    }
    return sweep;
}

bool is_sweep_file(const std::string& file) {
    const std::optional<std::string> text = read_whole_file(file);
    if (!text) return false;
    const Json json = Json::parse(*text, nullptr, false, true);
    return json.is_object() && json.contains("over");
}

}  // namespace trilens
