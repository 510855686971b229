// Checks a JSON value against a JSON Schema, in the part of draft 7 that the scene format uses.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "json/json.h"

namespace trilens {

/// What is wrong, and where (JSON pointer).
struct Problem {
    std::string place, message;
};

/// The first problem in document order, or none. An object's type, unknown keys, missing keys and keys that
/// exclude each other come before its parts. `schema` is the whole schema; a keyword that this does not know
/// is a bug.
std::optional<Problem> find_problem(const Json& value, const Json& schema);

/// The schema of the part `key` of values that `schema` describes (`root`: the whole schema; `key`: an
/// object's key, or anything for an array's entry). Null where the schema knows no such part or leaves it
/// free.
const Json* schema_of_part(const Json& schema, const std::string& key, const Json& root);

/// Follows "$ref".
const Json& resolve_schema(const Json& schema, const Json& root);

/// The keys that the schema of an object names, and whether a key is free ('extras', 'x-...').
std::vector<std::string> known_keys(const Json& object_schema);
bool is_free_key(const std::string& key);

/// Every keyword of the schema must be one that the checker obeys or may ignore; another is a bug.
void check_keywords(const Json& schema);

}  // namespace trilens
