// A walk over value and schema together; the schema's titles ("a rayMesh camera") make the messages.
#include "json/schema.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include "base/util/check.h"
#include "base/util/names.h"

namespace trilens {
namespace {

constexpr const char* kFreeKeys =
    "^(x-|extras$)";  // the only patternProperties, so no regular expressions are needed

/// Steps from the root, chained on the stack; written out only for a problem.
struct Path {
    const Path* parent = nullptr;
    std::string_view key;
    std::size_t index = 0;
    bool is_index = false;

    std::string pointer() const {
        if (!parent) return "";
        return parent->pointer() + "/" + (is_index ? std::to_string(index) : escape_key(key));
    }
};

using Found = std::optional<Problem>;

Found problem(const Path& path, const std::string& message) {
    return Problem{path.pointer(), message};
}

std::string title(const Json& schema) {
    return schema.contains("title") ? schema.at("title").get<std::string>() : "this object";
}

std::string quoted_list(const Json& values, const char* last_word) {
    std::string list;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (i > 0) list += i + 1 == values.size() ? std::string(" ") + last_word + " " : ", ";
        list += values[i].is_string() ? "'" + values[i].get<std::string>() + "'" : values[i].dump();
    }
    return list;
}

bool is_integer(const Json& value) {
    return value.is_number_integer() ||
           (value.is_number_float() && value.get<double>() == std::floor(value.get<double>()));
}

bool has_type(const Json& value, const std::string& type) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "number") return value.is_number();
    TRILENS_CHECK(type == "integer", "the schema uses a type that the checker does not know");
    return is_integer(value);
}

/// "an array or an object".
std::string with_articles(const std::vector<std::string>& types) {
    std::string text;
    for (const std::string& type : types) {
        const bool vowel = type[0] == 'o' || type[0] == 'a' || type[0] == 'i';
        text += (text.empty() ? "" : " or ") + std::string(vowel ? "an " : "a ") + type;
    }
    return text;
}

class Checker {
  public:
    explicit Checker(const Json& root) : root_(root) {}

    Found check(const Json& value, const Json& unresolved, const Path& path, const std::string& owner) const {
        const Json& schema = resolve_schema(unresolved, root_);
        if (schema.is_boolean())
            return schema.get<bool>()
                       ? Found()
                       : problem(path, "'" + std::string(path.key) + "' is no key of " + owner);
        if (Found found = check_value(value, schema, path)) return found;
        if (value.is_number()) return check_number(value, schema, path);
        if (value.is_array()) return check_array(value, schema, path);
        if (value.is_object()) return check_object(value, schema, path);
        return {};
    }

  private:
    bool matches(const Json& value, const Json& schema) const { return !check(value, schema, Path(), ""); }

    Found check_value(const Json& value, const Json& schema, const Path& path) const {
        if (schema.contains("const") && value != schema.at("const"))
            return problem(path, describe(value) + " is not " + schema.at("const").dump());
        if (schema.contains("enum")) return check_enum(value, schema.at("enum"), path);
        if (schema.contains("type")) {
            const Json& type = schema.at("type");
            const std::vector<std::string> types =
                type.is_array() ? type.get<std::vector<std::string>>() : std::vector{type.get<std::string>()};
            if (std::none_of(types.begin(), types.end(),
                             [&](const std::string& one) { return has_type(value, one); }))
                return problem(path, "expected " + with_articles(types) + ", found " + describe(value));
        }
        if (schema.contains("minLength") && value.is_string() && value.get_ref<const std::string&>().empty())
            return problem(path, "must not be empty");
        return {};
    }

    Found check_enum(const Json& value, const Json& choices, const Path& path) const {
        if (std::find(choices.begin(), choices.end(), value) != choices.end()) return {};
        if (!value.is_string() || !choices.at(0).is_string())
            return problem(path, "expected " + quoted_list(choices, "or") + ", found " + describe(value));
        const std::vector<std::string> known = choices.get<std::vector<std::string>>();
        return problem(path, "unknown value '" + value.get<std::string>() + "'" +
                                 suggestion(value.get<std::string>(), known));
    }

    Found check_number(const Json& value, const Json& schema, const Path& path) const {
        const double number = value.get<double>();
        const auto limit = [&](const char* keyword) { return schema.at(keyword).get<double>(); };
        const auto wrong = [&](const char* relation, const char* keyword) {
            return problem(path, describe(number) + " is out of range: must be " + relation + " " +
                                     describe(limit(keyword)));
        };
        if (schema.contains("minimum") && number < limit("minimum")) return wrong("at least", "minimum");
        if (schema.contains("maximum") && number > limit("maximum")) return wrong("at most", "maximum");
        if (schema.contains("exclusiveMinimum") && number <= limit("exclusiveMinimum"))
            return wrong("greater than", "exclusiveMinimum");
        if (schema.contains("exclusiveMaximum") && number >= limit("exclusiveMaximum"))
            return wrong("less than", "exclusiveMaximum");
        return {};
    }

    Found check_array(const Json& value, const Json& schema, const Path& path) const {
        const std::size_t least = schema.value("minItems", std::size_t{0});
        const std::size_t most = schema.value("maxItems", static_cast<std::size_t>(-1));
        if (value.size() < least || value.size() > most)
            return problem(
                path,
                "has " + std::to_string(value.size()) + (value.size() == 1 ? " entry" : " entries") +
                    ", must have " +
                    (least == most          ? ""
                     : value.size() < least ? "at least "
                                            : "at most ") +
                    std::to_string(value.size() < least ? least : most) +
                    (schema.contains("$comment") ? ": " + schema.at("$comment").get<std::string>() : ""));
        if (schema.contains("items")) {
            const Json& items = resolve_schema(schema.at("items"), root_);
            for (std::size_t i = 0; i < value.size(); ++i)
                if (Found found = check(value[i], items, Path{&path, {}, i, true}, "")) return found;
        }
        if (!schema.value("uniqueItems", false)) return {};
        for (std::size_t i = 0; i < value.size(); ++i)
            if (std::find(value.begin(), value.begin() + static_cast<std::ptrdiff_t>(i), value[i]) !=
                value.begin() + static_cast<std::ptrdiff_t>(i))
                return problem(Path{&path, {}, i, true}, describe(value[i]) + " stands there twice");
        return {};
    }

    Found check_object(const Json& value, const Json& schema, const Path& path) const {
        if (Found found = check_unknown_keys(value, schema, path)) return found;
        if (Found found = check_required(value, schema, path)) return found;
        if (Found found = check_alternatives(value, schema, path)) return found;
        if (!schema.contains("properties")) return {};
        const Json& properties = schema.at("properties");
        for (const auto& [key, part] : value.items())
            if (properties.contains(key))
                if (Found found = check(part, properties.at(key), Path{&path, key}, title(schema)))
                    return found;
        return {};
    }

    Found check_unknown_keys(const Json& value, const Json& schema, const Path& path) const {
        if (schema.value("additionalProperties", true)) return {};
        for (const auto& [key, part] : value.items()) {
            if (is_free_key(key) || schema.at("properties").contains(key)) continue;
            return problem(Path{&path, key}, "unknown key '" + key + "' of " + title(schema) +
                                                 suggestion(key, known_keys(schema)));
        }
        return {};
    }

    Found check_required(const Json& value, const Json& schema, const Path& path) const {
        if (schema.contains("required"))
            for (const Json& key : schema.at("required"))
                if (!value.contains(key.get<std::string>()))
                    return problem(path, title(schema) + " needs '" + key.get<std::string>() + "'");
        if (schema.contains("dependencies"))
            for (const auto& [key, needs] : schema.at("dependencies").items())
                for (const Json& needed : needs)
                    if (value.contains(key) && !value.contains(needed.get<std::string>()))
                        return problem(path,
                                       "'" + key + "' needs '" + needed.get<std::string>() + "' beside it");
        return {};
    }

    Found check_alternatives(const Json& value, const Json& schema, const Path& path) const {
        if (schema.contains("oneOf")) {
            Json choices = Json::array(), given = Json::array();
            std::string partly;  // of a choice that is there, but lacks what it needs
            for (const Json& branch : schema.at("oneOf")) {
                if (!branch.contains("required")) continue;  // of what is no object
                choices.push_back(branch.at("required").at(0));
                for (const Json& needed : branch.at("required"))
                    if (partly.empty() && value.contains(choices.back()) && !value.contains(needed))
                        partly = "'" + choices.back().get<std::string>() + "' needs '" +
                                 needed.get<std::string>() + "' beside it";
                if (matches(value, branch)) given.push_back(branch.at("required").at(0));
            }
            if (given.empty() && !partly.empty()) return problem(path, partly);
            if (given.empty())
                return problem(path, title(schema) + " needs one of " + quoted_list(choices, "and"));
            if (given.size() > 1)
                return problem(
                    path, title(schema) + " has " + quoted_list(given, "and") + ": only one may be given");
        }
        if (schema.contains("allOf"))
            for (const Json& part : schema.at("allOf"))
                if (Found found = check_condition(value, part, path)) return found;
        return check_condition(value, schema, path);
    }

    Found check_condition(const Json& value, const Json& schema, const Path& path) const {
        if (!schema.contains("if")) return {};
        const char* branch = matches(value, schema.at("if")) ? "then" : "else";
        return schema.contains(branch) ? check(value, schema.at(branch), path, "") : Found();
    }

    const Json& root_;
};

}  // namespace

void check_keywords(const Json& schema) {
    static const std::set<std::string> known = {"$schema",
                                                "$comment",
                                                "$id",
                                                "$ref",
                                                "title",
                                                "description",
                                                "default",
                                                "definitions",
                                                "type",
                                                "const",
                                                "enum",
                                                "minimum",
                                                "maximum",
                                                "exclusiveMinimum",
                                                "exclusiveMaximum",
                                                "minLength",
                                                "minItems",
                                                "maxItems",
                                                "uniqueItems",
                                                "items",
                                                "properties",
                                                "patternProperties",
                                                "additionalProperties",
                                                "required",
                                                "dependencies",
                                                "oneOf",
                                                "allOf",
                                                "if",
                                                "then",
                                                "else"};
    if (!schema.is_object()) return;
    for (const auto& [keyword, value] : schema.items()) {
        TRILENS_CHECK(known.count(keyword) == 1, "the schema uses a keyword that the checker does not know");
        if (keyword == "patternProperties")
            TRILENS_CHECK(value.size() == 1 && value.contains(kFreeKeys),
                          "the schema's only pattern is that of the free keys");
        if (keyword == "properties" || keyword == "definitions" || keyword == "oneOf" || keyword == "allOf")
            for (const auto& part : value) check_keywords(part);
        if (keyword == "items" || keyword == "if" || keyword == "then" || keyword == "else")
            check_keywords(value);
    }
}

std::optional<Problem> find_problem(const Json& value, const Json& schema) {
    return Checker(schema).check(value, schema, Path(), "");
}

const Json& resolve_schema(const Json& schema, const Json& root) {
    if (!schema.is_object() || !schema.contains("$ref")) return schema;
    const std::string name = schema.at("$ref").get<std::string>();
    constexpr std::string_view kDefinitions = "#/definitions/";
    TRILENS_CHECK(name.rfind(kDefinitions, 0) == 0, "the schema refers to its definitions only");
    return resolve_schema(root.at("definitions").at(name.substr(kDefinitions.size())), root);
}

const Json* schema_of_part(const Json& schema, const std::string& key, const Json& root) {
    const Json& resolved = resolve_schema(schema, root);
    if (resolved.contains("items")) return &resolve_schema(resolved.at("items"), root);
    if (!resolved.contains("properties") || !resolved.at("properties").contains(key)) return nullptr;
    return &resolve_schema(resolved.at("properties").at(key), root);
}

std::vector<std::string> known_keys(const Json& object_schema) {
    std::vector<std::string> keys;
    if (object_schema.contains("properties"))
        for (const auto& [key, part] : object_schema.at("properties").items())
            if (key != "$schema") keys.push_back(key);
    return keys;
}

bool is_free_key(const std::string& key) {
    return key == "extras" || key.rfind("x-", 0) == 0;
}

}  // namespace trilens
