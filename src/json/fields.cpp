#include "json/fields.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace trilens {
namespace {

bool has_kind(const std::vector<std::string>& kinds, const std::string& kind) {
    return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

/// "a # camera" of a kind: "an oblique camera".
std::string title_of_kind(std::string title, const std::string& kind) {
    const bool vowel = std::string("aeiou").find(kind[0]) != std::string::npos;
    title.replace(title.find('#'), 1, kind);
    return vowel && title[0] == 'a' ? "an" + title.substr(1) : title;
}

/// What objects of that type must have and must not.
Json condition_of(const std::string& kind, const ObjectSchema& object,
                  const std::vector<FieldSchema>& fields) {
    Json test;
    if (!object.default_kind.empty() && kind != object.default_kind) test["required"] = {"type"};
    test["properties"]["type"]["const"] = kind;
    Json rule;
    rule["title"] = title_of_kind(object.kind_title, kind);
    for (const FieldSchema& field : fields) {
        if (has_kind(field.needed_by, kind)) rule["required"].push_back(field.key);
        if (!field.kinds.empty() && !has_kind(field.kinds, kind)) rule["properties"][field.key] = false;
    }
    return {{"if", test}, {"then", rule}};
}

}  // namespace

Json to_json_value(double value) {
    const bool is_whole = std::floor(value) == value && std::abs(value) < 1e9;
    return is_whole ? Json(static_cast<int>(value)) : Json(value);
}

Json number_in(double least, double most) {
    return {{"type", "number"}, {"minimum", to_json_value(least)}, {"maximum", to_json_value(most)}};
}

Json number_above(double least, double most) {
    return {{"type", "number"}, {"exclusiveMinimum", to_json_value(least)}, {"maximum", to_json_value(most)}};
}

Json number_between(double least, double most) {
    return {{"type", "number"},
            {"exclusiveMinimum", to_json_value(least)},
            {"exclusiveMaximum", to_json_value(most)}};
}

Json whole_in(int least, int most) {
    return {{"type", "integer"}, {"minimum", least}, {"maximum", most}};
}

Json several(int count, const Json& each) {
    return {{"type", "array"}, {"minItems", count}, {"maxItems", count}, {"items", each}};
}

Json list_of(const Json& each, int least) {
    Json list{{"type", "array"}};
    if (least > 0) list["minItems"] = least;
    list["items"] = each;
    return list;
}

Json ref(const std::string& definition) {
    return {{"$ref", "#/definitions/" + definition}};
}

Json word_of(const std::vector<std::string>& names) {
    return {{"enum", names}};
}

Json yes_or_no() {
    return {{"type", "boolean"}};
}

Json some_text() {
    return {{"type", "string"}, {"minLength", 1}};
}

Json described(Json schema, const std::string& help) {
    if (!help.empty()) schema["description"] = help;
    return schema;
}

Json object_schema(const ObjectSchema& object, const std::vector<FieldSchema>& fields) {
    Json schema{{"title", object.title}};
    if (!object.description.empty()) schema["description"] = object.description;
    schema["type"] = "object";
    schema["additionalProperties"] = false;
    schema["patternProperties"]["^(x-|extras$)"] = Json::object();
    if (!object.required.empty()) schema["required"] = object.required;
    for (const FieldSchema& field : fields) {
        schema["properties"][field.key] = field.schema;
        if (field.key != "type" || object.kind_title.empty()) continue;
        for (const Json& kind : field.schema.at("enum"))
            schema["allOf"].push_back(condition_of(kind.get<std::string>(), object, fields));
    }
    return schema;
}

Json file_schema(const std::string& name, const Json& object) {
    Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"$id", name + ".schema.json"}};
    schema.update(object);
    schema["properties"]["$schema"] = {{"type", "string"}};
    return schema;
}

}  // namespace trilens
