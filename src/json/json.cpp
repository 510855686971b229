// Builds JSON documents strictly: no key twice, no number beyond double, no bottomless nesting.
#include "json/json.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <system_error>
#include <unordered_set>
#include <utility>
#include <vector>

namespace trilens {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array<std::pair<const char*, double>, 3> kNotFinite{
    {{"nan", std::numeric_limits<double>::quiet_NaN()}, {"inf", kInfinity}, {"-inf", -kInfinity}}};

constexpr std::size_t kDeepest = 64;  // levels; the scene format itself needs 6

std::string line_and_column(const std::string& text, std::size_t position) {
    const std::size_t at = position == 0 ? 0 : std::min(position, text.size() + 1) - 1;
    const auto begin = text.begin(),
               end = text.begin() + static_cast<std::ptrdiff_t>(std::min(at, text.size()));
    const auto line = std::count(begin, end, '\n') + 1;
    const std::size_t newline = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
    const std::size_t column = newline == std::string::npos ? at + 1 : at - newline;
    return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

class Builder : public nlohmann::json_sax<Json> {
  public:
    Builder(const std::string& text, const std::string& file) : text_(text), file_(file) {}
    Json take() { return std::move(root_); }

    bool null() override { return add(nullptr); }
    bool boolean(bool value) override { return add(value); }
    bool number_integer(number_integer_t value) override { return add(value); }
    bool number_unsigned(number_unsigned_t value) override { return add(value); }
    bool number_float(number_float_t value, const string_t&) override { return add(value); }
    bool string(string_t& value) override { return add(value); }
    bool binary(binary_t&) override { return false; }
    bool start_object(std::size_t) override { return open(Json::object()); }
    bool start_array(std::size_t) override { return open(Json::array()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& key) override {
        levels_.back().key = key;
        if (!levels_.back().keys.insert(key).second)
            fail_at(file_, place(), "this key stands twice in its object");
        return true;
    }

    bool parse_error(std::size_t position, const std::string&,
                     const nlohmann::detail::exception& error) override {
        std::string message = error.what();
        for (const char* start : {"syntax error", "number overflow", "parse error"}) {
            const std::size_t found = message.find(start);
            if (found == std::string::npos) continue;
            message = message.substr(found);
            break;
        }
        fail_at(file_, line_and_column(text_, position), message);
    }

  private:
    struct Level {
        Json* value;
        std::string key;  // the one being read
        std::unordered_set<std::string> keys;
    };

    /// Of the value that comes next.
    std::string place() const {
        std::string pointer;
        for (const Level& level : levels_) {
            const bool next_is_inside =
                &level != &levels_.back();  // then the entry stands in its array already
            pointer += "/" + (level.value->is_object()
                                  ? escape_key(level.key)
                                  : std::to_string(level.value->size() - (next_is_inside ? 1 : 0)));
        }
        return pointer;
    }
    Json* insert(Json&& value) {
        if (levels_.empty()) return &(root_ = std::move(value));
        Json& parent = *levels_.back().value;
        if (parent.is_object()) return &(parent[levels_.back().key] = std::move(value));
        parent.push_back(std::move(value));
        return &parent.back();
    }
    bool add(Json&& value) {
        insert(std::move(value));
        return true;
    }
    bool open(Json&& value) {
        if (levels_.size() >= kDeepest)
            fail_at(file_, place(), "nested deeper than " + std::to_string(kDeepest) + " levels");
        levels_.push_back({insert(std::move(value)), {}, {}});
        return true;
    }
    bool close() {
        levels_.pop_back();
        return true;
    }

    const std::string& text_;
    const std::string& file_;
    Json root_;
    std::vector<Level> levels_;
};

}  // namespace

Json parse_json(const std::string& bytes, const std::string& file) {
    const std::string text(utf8_text(bytes, file));
    if (text.find_first_not_of(" \t\r\n") == std::string::npos) fail_at(file, "", "is empty");
    Builder builder(text, file);
    constexpr bool kWholeText = true, kIgnoreComments = true;
    Json::sax_parse(text, &builder, Json::input_format_t::json, kWholeText, kIgnoreComments);
    return builder.take();
}

void fail_at(const std::string& file, const std::string& place, const std::string& message) {
    throw InputError(file, one_line(place), one_line(message));
}

std::string escape_key(std::string_view key) {
    std::string escaped;
    for (const char letter : key) {
        if (letter == '~')
            escaped += "~0";
        else if (letter == '/')
            escaped += "~1";
        else
            escaped += letter;
    }
    return escaped;
}

std::string describe(double number) {
    std::array<char, 32> text{};
    const auto result = std::to_chars(text.data(), text.data() + text.size(), number);
    return {text.data(), result.ptr};
}

std::string describe(const Json& value) {
    constexpr std::size_t kLongest = 40;
    if (value.is_object()) return "an object";
    if (value.is_array()) return "an array of " + std::to_string(value.size());
    if (value.is_number_float()) return "the number " + describe(value.get<double>());
    const std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (value.is_number()) return "the number " + text;
    if (value.is_string())
        return "the string " + (text.size() <= kLongest ? text : text.substr(0, kLongest) + "...\"");
    return text;
}

Vec3 to_vec3(const Json& value) {
    return {value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>()};
}

Vec2 to_vec2(const Json& value) {
    return {value.at(0).get<double>(), value.at(1).get<double>()};
}

Vec3 vec3_or(const Node& parent, const char* key, const Vec3& fallback) {
    return parent.has(key) ? to_vec3(parent.json.at(key)) : fallback;
}

double number_or(const Node& parent, const char* key, double fallback) {
    return parent.has(key) ? parent.json.at(key).get<double>() : fallback;
}

std::string string_or(const Node& parent, const char* key, const std::string& fallback) {
    return parent.has(key) ? parent.json.at(key).get<std::string>() : fallback;
}

Json json_of_number(std::optional<double> value) {
    if (!value) return nullptr;
    if (std::isfinite(*value)) return *value;
    return std::isnan(*value) ? "nan" : *value > 0 ? "inf" : "-inf";
}

std::optional<double> number_of_json(const Json& json) {
    if (json.is_null()) return std::nullopt;
    if (!json.is_string()) return json.get<double>();
    for (const auto& [name, value] : kNotFinite)
        if (json == name) return value;
    throw std::invalid_argument("\"" + json.get<std::string>() + "\" is no number");
}

std::string json_document(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

namespace {

void write_rows(const Json& json, const std::string& indent, std::string& text) {
    const auto is_plain = [](const Json& one) { return one.is_primitive() && !one.is_string(); };
    const bool is_row = json.is_array() && std::all_of(json.begin(), json.end(), is_plain);
    if (!json.is_structured() || json.empty() || is_row) {
        text += json.dump(-1, ' ', false, Json::error_handler_t::replace);
        return;
    }
    const std::string inner = indent + "  ";
    const char* before = "";
    text += json.is_array() ? "[" : "{";
    for (const auto& [key, value] : json.items()) {
        text += before + std::string("\n") + inner;
        if (json.is_object()) text += Json(key).dump(-1, ' ', false, Json::error_handler_t::replace) + ": ";
        write_rows(value, inner, text);
        before = ",";
    }
    text += "\n" + indent + (json.is_array() ? "]" : "}");
}

}  // namespace

std::string json_rows(const Json& json) {
    std::string text;
    write_rows(json, "", text);
    return text + "\n";
}

std::string json_line(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string read_required_file(const std::string& file) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw InputError(file, "", "is a directory, not a file");
    if (std::filesystem::is_character_file(file, ignored) || std::filesystem::is_block_file(file, ignored))
        throw InputError(file, "", "is a device, not a file");
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw InputError(file, "", std::string("cannot be opened: ") + std::strerror(errno));
    std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (stream.bad()) throw InputError(file, "", "cannot be read");
    return text;
}

std::string_view utf8_text(std::string_view bytes, const std::string& file) {
    constexpr std::string_view kUtf8 = "\xEF\xBB\xBF", kLittle = "\xFF\xFE", kBig = "\xFE\xFF";
    constexpr std::string_view kBig32("\0\0\xFE\xFF", 4);
    for (const std::string_view mark : {kLittle, kBig, kBig32})
        if (bytes.substr(0, mark.size()) == mark)
            throw InputError(file, "", "is UTF-16 or UTF-32 text: save it as UTF-8");
    return bytes.substr(0, kUtf8.size()) == kUtf8 ? bytes.substr(kUtf8.size()) : bytes;
}

}  // namespace trilens
