// JSON documents: read strictly, with the place of each value for messages, and written; the text of whole
// files. THE door to nlohmann's JSON.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "base/math/vec.h"
#include "base/util/error.h"

namespace trilens {

/// Keys stay in the order in which they are set, or stand in the file.
using Json = nlohmann::ordered_json;

/// Parses JSON with comments, UTF-8 with or without its byte order mark. Throws InputError with line and
/// column of a syntax error or of a number beyond double, and with the JSON pointer of a key that stands
/// twice in one object or of nesting beyond 64 levels.
Json parse_json(const std::string& bytes, const std::string& file);

/// One step of a JSON pointer, escaped (RFC 6901).
std::string escape_key(std::string_view key);

/// What a value is, for messages: `the number 12`, `the string "abc"`, `an array of 3`.
std::string describe(const Json& value);
/// The shortest decimal that reads back as the same number.
std::string describe(double number);

/// Throws InputError; control characters that place or message quote from the document become spaces, so that
/// the message is one line.
[[noreturn]] void fail_at(const std::string& file, const std::string& place, const std::string& message);

/// A value of a checked document together with its place, so that every reader can say where it failed.
struct Node {
    const Json& json;
    std::string place;        // JSON pointer
    const std::string& file;  // for messages

    [[noreturn]] void fail(const std::string& message) const { fail_at(file, place, message); }
    std::size_t size() const { return json.size(); }
    bool has(const char* key) const { return json.contains(key); }
    Node operator[](const char* key) const { return {json.at(key), place + "/" + escape_key(key), file}; }
    Node operator[](std::size_t index) const {
        return {json.at(index), place + "/" + std::to_string(index), file};
    }
};

// Readers for values whose type and length the schema has checked already.
Vec3 to_vec3(const Json& value);
Vec2 to_vec2(const Json& value);
Vec3 vec3_or(const Node& parent, const char* key, const Vec3& fallback);
double number_or(const Node& parent, const char* key, double fallback);
std::string string_or(const Node& parent, const char* key, const std::string& fallback);

/// A number for JSON: what is not finite becomes the string "nan", "inf" or "-inf"; none becomes null.
Json json_of_number(std::optional<double> value);

/// The inverse. Throws nlohmann's exceptions where `json` is something else.
std::optional<double> number_of_json(const Json& json);

/// Indented text with a line end; bytes that are no UTF-8 become U+FFFD.
std::string json_document(const Json& json);
/// The same, with arrays of numbers each on one line.
std::string json_rows(const Json& json);
/// The same on one line.
std::string json_line(const Json& json);

/// A whole file. Throws InputError(file) that says why: missing, a directory, not readable.
std::string read_required_file(const std::string& file);

/// `bytes` as UTF-8, without the byte order mark that some programs write before it. Throws InputError(file)
/// where the mark is that of UTF-16 or UTF-32. The view points into `bytes`.
std::string_view utf8_text(std::string_view bytes, const std::string& file);

}  // namespace trilens
