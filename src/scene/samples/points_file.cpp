#include "scene/samples/points_file.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "json/json.h"
#include "scene/data/scene.h"
#include "scene/formats/line_scanner.h"
#include "scene/samples/point_cloud.h"

namespace trilens {
namespace {

/// What stands between separators, without quotes and in small letters; blanks are left out, or separate.
std::vector<std::string> fields_of(std::string_view line, std::string_view separators) {
    std::vector<std::string> fields(1);
    for (const char letter : line) {
        if (separators.find(letter) != std::string_view::npos)
            fields.emplace_back();
        else if (!std::isspace(static_cast<unsigned char>(letter)) && letter != '"' && letter != '\'')
            fields.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    }
    return fields;
}

bool is_number(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    double value = 0;
    return !text.empty() &&
           std::from_chars(text.data(), text.data() + text.size(), value).ptr == text.data() + text.size();
}

/// Whether a line holds numbers alone, whatever separates them.
bool has_only_numbers(std::string_view line) {
    std::vector<std::string> fields = fields_of(line, ",; \t\r|");
    std::erase(fields, "");
    return !fields.empty() && std::ranges::all_of(fields, is_number);
}

/// Whether a line that is no point holds only words.
bool is_header(std::string_view line) {
    return std::ranges::none_of(fields_of(line, ","), is_number) && !has_only_numbers(line);
}

/// Whether a header names a column of the form at another's place.
bool has_other_order(std::string_view line, const LineForm& form) {
    const std::vector<std::string> columns = fields_of(form.names, ","), fields = fields_of(line, ",");
    if (columns.size() != form.numbers) return false;  // the form says what they are in other words
    for (std::size_t k = 0; k < fields.size(); ++k)
        if ((k >= columns.size() || fields[k] != columns[k]) && std::ranges::count(columns, fields[k]) > 0)
            return true;
    return false;
}

/// What is said of a line that is none of the form.
std::string complaint_of(std::string_view line, const LineForm& form) {
    while (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    const std::string text(line);
    if (is_header(line) && has_other_order(line, form))
        return "names the columns " + text + ", and they are " + form.names + ", in this order";
    const std::string separators =
        has_only_numbers(line) && line.find_first_of("; \t|") != std::string_view::npos
            ? ": commas separate numbers"
            : "";
    return "needs " + form.names + " within 1e30, not \"" + text + "\"" + separators;
}

/// Adds the `count` numbers that a text consists of to `numbers`; false, and then nothing is said of what was
/// added, where it is anything else.
bool add_numbers(std::string_view text, std::size_t count, std::vector<double>& numbers) {
    const char *at = text.data(), *end = at + text.size();
    const auto skip_blanks = [&] {
        while (at < end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
    };
    for (std::size_t k = 0; k < count; ++k) {
        skip_blanks();
        if (at < end && *at == '+') ++at;
        double number = 0;
        const auto [next, error] = std::from_chars(at, end, number);
        if (error != std::errc() || !(std::abs(number) <= kLargestCoordinate)) return false;
        numbers.push_back(number);
        at = next;
        skip_blanks();
        if (k + 1 < count && (at >= end || *at++ != ',')) return false;
    }
    return at == end;
}

/// Some lines of a text: their numbers, as far as the first line that holds other things.
struct Piece {
    const LineForm& form;
    std::vector<double> numbers = {};
    std::size_t lines = 0;
    std::optional<std::string_view> bad = {};  // the last line that was looked at

    void take(std::string_view line, bool is_first) {
        ++lines;
        if (is_first && line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);  // a byte order mark
        if (line.find_first_not_of(" \t\r") == std::string_view::npos || line[0] == '#') return;
        const std::size_t held = numbers.size();
        if (add_numbers(line, form.numbers, numbers)) return;
        numbers.resize(held);
        if (!is_first || !is_header(line) || has_other_order(line, form)) bad = line;
    }
    void take_lines(std::string_view text, bool is_first) {
        while (!text.empty() && !bad) {
            const std::size_t end = std::min(text.find('\n'), text.size());
            take(text.substr(0, end), is_first && lines == 0);
            text.remove_prefix(std::min(end + 1, text.size()));
        }
    }
};

/// Bytes, so many that a piece is worth a thread of its own.
constexpr std::size_t kPiece = std::size_t{1} << 16;

/// Where the first line begins that begins at `place` or behind it.
std::size_t line_at(std::string_view text, std::size_t place) {
    if (place == 0 || place >= text.size()) return std::min(place, text.size());
    return std::min(text.find('\n', place - 1), text.size() - 1) + 1;
}

std::string all_of(std::istream& in, const std::string& file) {
    std::string text;
    std::size_t filled = 0;
    while (in) {
        text.resize(std::max(2 * filled, kPiece));
        in.read(text.data() + filled, static_cast<std::streamsize>(text.size() - filled));
        filled += static_cast<std::size_t>(in.gcount());
    }
    if (in.bad()) throw InputError(file, "", "cannot be read");
    text.resize(filled);
    return text;
}

std::vector<Vec3> points_of(const std::vector<double>& numbers) {
    std::vector<Vec3> points(numbers.size() / 3);
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
    return points;
}

bool is_ply_name(const std::string& file) {
    return file_ending(file) == ".ply";
}

/// How many numbers the first line has that begins like one.
std::size_t numbers_in_first_point(std::string_view text) {
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view line = text.substr(0, end);
        line.remove_prefix(std::min(line.find_first_not_of(" \t\xef\xbb\xbf"), line.size()));
        if (!line.empty() && std::string_view("+-.0123456789").find(line[0]) != std::string_view::npos)
            return 1 + static_cast<std::size_t>(std::count(line.begin(), line.end(), ','));
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return 0;
}

}  // namespace

std::vector<double> parse_numbers(const std::string& text, const std::string& name, const LineForm& form) {
    std::vector<Piece> pieces(text.size() / kPiece + 1, Piece{.form = form});
    parallel_for(pieces.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const std::size_t begin = line_at(text, i * kPiece), end = line_at(text, (i + 1) * kPiece);
            pieces[i].take_lines(std::string_view(text).substr(begin, end - begin), i == 0);
        }
    });
    std::vector<double> numbers;
    std::size_t lines = 0;
    for (const Piece& piece : pieces) {
        lines += piece.lines;
        numbers.insert(numbers.end(), piece.numbers.begin(), piece.numbers.end());
        if (piece.bad)
            throw InputError(name, "line " + std::to_string(lines), complaint_of(*piece.bad, form));
    }
    if (numbers.empty()) throw InputError(name, "", "holds no " + form.what);
    return numbers;
}

std::vector<double> read_numbers(const std::string& file, const LineForm& form) {
    std::ifstream in(file);
    if (!in) throw InputError(file, "", "cannot be read");
    return parse_numbers(all_of(in, file), file, form);
}

std::optional<Vec3> parse_point(const std::string& text) {
    std::vector<double> numbers;
    if (!add_numbers(text, 3, numbers)) return std::nullopt;
    return Vec3(numbers[0], numbers[1], numbers[2]);
}

std::vector<Vec3> parse_points(const std::string& text, const std::string& name) {
    return points_of(parse_numbers(text, name, {}));
}

std::vector<Vec3> read_points(const std::string& file) {
    if (is_ply_name(file)) return parse_ply(read_required_file(file), file).points;
    return points_of(read_numbers(file, {}));
}

ColoredPoints parse_cloud(const std::string& bytes, const std::string& file) {
    if (is_ply_name(file)) return parse_ply(bytes, file);
    const std::size_t per_line = numbers_in_first_point(bytes);
    const std::vector<double> numbers =
        per_line == 6 ? parse_numbers(bytes, file, {6, "x,y,z,red,green,blue", "points"})
                      : parse_numbers(bytes, file, {});
    ColoredPoints cloud;
    if (per_line != 6) return {points_of(numbers), {}};
    for (std::size_t i = 0; i < numbers.size(); i += 6) {
        cloud.points.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
        cloud.colors.emplace_back(numbers[i + 3], numbers[i + 4], numbers[i + 5]);
        if (!(numbers[i + 3] >= 0 && numbers[i + 4] >= 0 && numbers[i + 5] >= 0))
            throw InputError(file, "", "point " + std::to_string(i / 6) + " has a negative colour");
    }
    return cloud;
}

}  // namespace trilens
