#include "scene/points_file.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "scene/scene.h"

namespace trilens {
namespace {

/// Whether a line that is no point holds only words.
bool is_header(const std::string& line) {
    std::string field;
    for (const char letter : line + ",") {
        if (letter != ',') {
            if (!std::isspace(static_cast<unsigned char>(letter)) && letter != '"' && letter != '\'')
                field += letter;
            continue;
        }
        double value = 0;
        const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
        if (!field.empty() && end == field.data() + field.size()) return false;
        field.clear();
    }
    return true;
}

}  // namespace

std::optional<Vec3> parse_point(const std::string& text) {
    Vec3 point(0);
    const char *at = text.data(), *end = at + text.size();
    const auto skip_blanks = [&] {
        while (at < end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
    };
    for (int k = 0; k < 3; ++k) {
        skip_blanks();
        if (at < end && *at == '+') ++at;
        const auto [next, error] = std::from_chars(at, end, point[k]);
        if (error != std::errc() || !(std::abs(point[k]) <= kLargestCoordinate)) return std::nullopt;
        at = next;
        skip_blanks();
        if (k < 2 && (at >= end || *at++ != ',')) return std::nullopt;
    }
    return at == end ? std::optional(point) : std::nullopt;
}

namespace {

std::vector<Vec3> read_points(std::istream& in, const std::string& file) {
    std::vector<Vec3> points;
    std::string line;
    for (std::size_t number = 1; std::getline(in, line); ++number) {
        if (number == 1 && line.rfind("\xef\xbb\xbf", 0) == 0) line.erase(0, 3);  // a byte order mark
        if (line.find_first_not_of(" \t\r") == std::string::npos || line[0] == '#') continue;
        const std::optional<Vec3> point = parse_point(line);
        if (point)
            points.push_back(*point);
        else if (number > 1 || !is_header(line))
            throw InputError(file, "line " + std::to_string(number),
                             "needs x,y,z within 1e30, not \"" + line + "\"");
    }
    if (in.bad()) throw InputError(file, "", "cannot be read");
    if (points.empty()) throw InputError(file, "", "holds no points");
    return points;
}

}  // namespace

std::vector<Vec3> parse_points(const std::string& text, const std::string& name) {
    std::istringstream in(text);
    return read_points(in, name);
}

std::vector<Vec3> read_points(const std::string& file) {
    std::ifstream in(file);
    if (!in) throw InputError(file, "", "cannot be read");
    return read_points(in, file);
}

}  // namespace trilens
