// Settings of JSON objects, each declared once: its key, the values that it takes, what it is for, and the
// member that it fills. The JSON Schema and the reader are made of these tables; a default is the member's
// initialiser.
#pragma once

#include <array>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "base/util/names.h"
#include "json/json.h"

namespace trilens {

inline constexpr int kMostIndex = 2147483647;

/// A range of numbers, as JSON Schema has it.
Json number_in(double least, double most);       // both ends included
Json number_above(double least, double most);    // without `least`
Json number_between(double least, double most);  // without both
Json whole_in(int least, int most);
/// `count` values of one schema.
Json several(int count, const Json& each);
/// At least `least` values of one schema.
Json list_of(const Json& each, int least = 0);
/// A definition of the schema by its name: "number", "positive", "vec3", ...
Json ref(const std::string& definition);
Json word_of(const std::vector<std::string>& names);
Json yes_or_no();
Json some_text();  // not empty

// Values as JSON, for defaults.
Json to_json_value(double value);  // 40, not 40.0
inline Json to_json_value(int value) {
    return value;
}
inline Json to_json_value(bool value) {
    return value;
}
inline Json to_json_value(const Vec2& v) {
    return {to_json_value(v.x), to_json_value(v.y)};
}
inline Json to_json_value(const Vec3& v) {
    return {to_json_value(v.x), to_json_value(v.y), to_json_value(v.z)};
}

// Values out of checked JSON.
inline void from_json_value(const Json& json, double& value) {
    value = json.get<double>();
}
inline void from_json_value(const Json& json, int& value) {
    value = json.get<int>();
}
inline void from_json_value(const Json& json, bool& value) {
    value = json.get<bool>();
}
inline void from_json_value(const Json& json, std::string& value) {
    value = json.get<std::string>();
}
inline void from_json_value(const Json& json, Vec2& value) {
    value = to_vec2(json);
}
inline void from_json_value(const Json& json, Vec3& value) {
    value = to_vec3(json);
}
template <std::size_t N>
void from_json_value(const Json& json, std::array<double, N>& value) {
    for (std::size_t k = 0; k < N; ++k) value[k] = json.at(k).get<double>();
}

/// One key of a JSON object and the schema of its values.
struct FieldSchema {
    std::string key;
    Json schema;
    std::vector<std::string> kinds;      // of the object's `type` that have it; empty: all
    std::vector<std::string> needed_by;  // kinds that must have it
};

/// One setting of a T.
template <typename T>
struct Field : FieldSchema {
    std::function<void(const Json&, T&)> read;  // none: read by hand

    /// The kinds that have it, each required where its name ends in '!'.
    Field of(std::initializer_list<const char*> names) && {
        for (std::string name : names) {
            const bool needs = name.back() == '!';
            if (needs) name.pop_back();
            kinds.push_back(name);
            if (needs) needed_by.push_back(name);
        }
        return std::move(*this);
    }
    /// Without a default: its absence says something that no value does.
    Field without_default() && {
        schema.erase("default");
        return std::move(*this);
    }
};

Json described(Json schema, const std::string& help);

/// A setting that fills `member`, whose initialiser is its default.
template <typename T, typename V>
Field<T> setting(const std::string& key, V T::*member, Json values, const std::string& help = "") {
    Field<T> field;
    field.key = key;
    if constexpr (requires(V v) { to_json_value(v); }) values["default"] = to_json_value(T().*member);
    field.schema = described(std::move(values), help);
    field.read = [member](const Json& json, T& into) { from_json_value(json, into.*member); };
    return field;
}

/// A setting that is one of an enumeration's names.
template <typename T, typename E>
Field<T> choice(const std::string& key, E T::*member, const std::string& help = "") {
    Field<T> field;
    field.key = key;
    field.schema = word_of(names_of<E>());
    field.schema["default"] = name_of(T().*member);
    field.schema = described(std::move(field.schema), help);
    field.read = [member](const Json& json, T& into) {
        into.*member = *find_named<E>(json.get_ref<const std::string&>());
    };
    return field;
}

/// A setting with two values, the first of them false.
template <typename T>
Field<T> either(const std::string& key, bool T::*member, const std::array<const char*, 2>& names,
                const std::string& help = "") {
    Field<T> field;
    field.key = key;
    const bool usual = T().*member;
    field.schema = word_of({names[usual ? 1 : 0], names[usual ? 0 : 1]});
    field.schema["default"] = names[usual ? 1 : 0];
    field.schema = described(std::move(field.schema), help);
    field.read = [member, on = std::string(names[1])](const Json& json, T& into) {
        into.*member = json == on;
    };
    return field;
}

/// A setting of a T's own part; one that is read by hand stays so.
template <typename T, typename U>
Field<T> within(U T::*outer, Field<U> inner) {
    Field<T> field;
    static_cast<FieldSchema&>(field) = inner;
    if (inner.read)
        field.read = [outer, read = inner.read](const Json& json, T& into) { read(json, into.*outer); };
    return field;
}

/// A part that is read by hand.
template <typename T>
Field<T> part(const std::string& key, Json values, const std::string& help = "") {
    Field<T> field;
    field.key = key;
    field.schema = described(std::move(values), help);
    return field;
}

/// Reads what the object has of them.
template <typename T>
void read_fields(const Node& object, const std::vector<Field<T>>& fields, T& into) {
    for (const Field<T>& field : fields)
        if (field.read && object.has(field.key.c_str())) field.read(object.json.at(field.key), into);
}

/// An object's schema: what messages call it ("a film"), what it is for, its fields, and of them those that
/// must be there.
struct ObjectSchema {
    std::string title, description = {};
    std::vector<std::string> required = {};
    // Of an object that has a `type`: the types' names in titles ("a # camera"), and the type that goes
    // without saying.
    std::string kind_title = {}, default_kind = {};
};
Json object_schema(const ObjectSchema& object, const std::vector<FieldSchema>& fields);

/// The schema of a file, of its object's: with its draft and its name, "trilens-wish-1" for instance; files
/// may name it by "$schema", for editors.
Json file_schema(const std::string& name, const Json& object);

template <typename T>
Json object_schema(const ObjectSchema& object, const std::vector<Field<T>>& fields) {
    return object_schema(object, std::vector<FieldSchema>(fields.begin(), fields.end()));
}

}  // namespace trilens
