#include "view/numbers.h"

#include <trilens/scene.h>

#include <algorithm>
#include <cmath>

#include "view/session.h"

namespace trilens {
namespace {

const Json& schema_json() {
    static const Json kSchema = Json::parse(scene_schema());
    return kSchema;
}

std::string escaped_key(std::string key) {
    for (std::size_t i = 0; i < key.size(); ++i)
        if (key[i] == '~' || key[i] == '/') {
            key.replace(i, 1, key[i] == '~' ? "~0" : "~1");
            ++i;
        }
    return key;
}

/// Whether a branch's constants and enumerations are those of the value.
bool fits(const Json& branch, const Json& value) {
    if (!value.is_object() || !branch.contains("properties")) return true;
    for (const auto& [key, rule] : branch.at("properties").items()) {
        if (!value.contains(key) || !rule.is_object()) continue;
        if (rule.contains("const") && rule.at("const") != value.at(key)) return false;
        if (rule.contains("enum")) {
            const Json& words = rule.at("enum");
            if (std::find(words.begin(), words.end(), value.at(key)) == words.end()) return false;
        }
    }
    return true;
}

/// All schemas that hold for a value: the schema itself, what it refers to, its parts, and branches that fit.
void gather_schemas(const Json& schema, const Json& value, std::vector<const Json*>& found) {
    if (!schema.is_object() || found.size() > 200) return;
    if (schema.contains("$ref")) {
        const Json* target =
            find_value(schema_json(), schema.at("$ref").get<std::string>().substr(1));  // "#/definitions/x"
        if (target) gather_schemas(*target, value, found);
    }
    found.push_back(&schema);
    for (const char* parts : {"allOf", "oneOf", "anyOf"})
        if (schema.contains(parts))
            for (const Json& part : schema.at(parts))
                if (fits(part, value)) gather_schemas(part, value, found);
    if (schema.contains("if") && schema.contains("then") && fits(schema.at("if"), value))
        gather_schemas(schema.at("then"), value, found);
    if (schema.contains("if") && schema.contains("else") && !fits(schema.at("if"), value))
        gather_schemas(schema.at("else"), value, found);
}

/// One step down, in every schema that has it.
std::vector<const Json*> schemas_below(const std::vector<const Json*>& above, const std::string& key,
                                       const Json& value) {
    std::vector<const Json*> below;
    for (const Json* schema : above) {
        if (schema->contains("properties") && schema->at("properties").contains(key))
            gather_schemas(schema->at("properties").at(key), value, below);
        if (!schema->contains("items")) continue;
        const Json& items = schema->at("items");
        const std::size_t index = key.find_first_not_of("0123456789") == std::string::npos && key.size() < 9
                                      ? std::stoul("0" + key)
                                      : 0;
        if (items.is_object())
            gather_schemas(items, value, below);
        else if (items.is_array() && index < items.size())
            gather_schemas(items[index], value, below);
    }
    return below;
}

void narrow(NumberRange& range, const Json& schema) {
    const std::string type =
        schema.value("type", Json()).is_string() ? schema.at("type").get<std::string>() : "";
    range.known = range.known || type == "number" || type == "integer";
    range.whole = range.whole || type == "integer";
    for (const char* key : {"minimum", "exclusiveMinimum"})
        if (schema.contains(key) && schema.at(key).is_number())
            range.least = std::max(range.least, schema.at(key).get<double>());
    for (const char* key : {"maximum", "exclusiveMaximum"})
        if (schema.contains(key) && schema.at(key).is_number())
            range.most = std::min(range.most, schema.at(key).get<double>());
    for (const char* key : {"description", "title"})
        if (range.help.empty() && schema.contains(key)) range.help = schema.at(key).get<std::string>();
}

void gather_numbers(const Json& value, const std::string& pointer, std::size_t most_items,
                    std::vector<std::string>& found) {
    if (value.is_number() && pointer != "/version") found.push_back(pointer);
    if (value.is_object())
        for (const auto& [key, below] : value.items())
            gather_numbers(below, pointer + "/" + escaped_key(key), most_items, found);
    if (value.is_array() && value.size() <= most_items)
        for (std::size_t i = 0; i < value.size(); ++i)
            gather_numbers(value[i], pointer + "/" + std::to_string(i), most_items, found);
}

}  // namespace

NumberRange number_range(const Json& scene, const std::string& pointer) {
    std::vector<const Json*> schemas;
    gather_schemas(schema_json(), scene, schemas);
    const Json* value = &scene;
    static const Json kNothing;
    for (std::size_t from = 1; from <= pointer.size();) {
        const std::size_t slash = std::min(pointer.find('/', from), pointer.size());
        const std::string key = pointer.substr(from, slash - from);
        value = find_value(scene, pointer.substr(0, slash));
        if (!value) value = &kNothing;
        schemas = schemas_below(schemas, key, *value);
        from = slash + 1;
    }
    NumberRange range;
    for (const Json* schema : schemas) narrow(range, *schema);
    return range;
}

SliderSpan slider_span(const NumberRange& range, double value) {
    const double reach = std::max(1.0, 2 * std::abs(value));
    SliderSpan span{std::max(range.least, value - reach), std::min(range.most, value + reach)};
    if (std::isfinite(range.least) && std::isfinite(range.most) && range.most - range.least <= 1000)
        span = {range.least, range.most};
    if (!(span.least < span.most)) span.most = span.least + 1;
    return span;
}

std::vector<std::string> scene_numbers(const Json& scene, std::size_t most_items) {
    std::vector<std::string> found;
    gather_numbers(scene, "", most_items, found);
    return found;
}

}  // namespace trilens
