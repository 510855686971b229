// Points in files: x,y,z, one per line of a text, or PLY.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/math/vec.h"

namespace trilens {

/// Three numbers within kLargestCoordinate, separated by commas and blanks; none where the text is anything
/// else.
std::optional<Vec3> parse_point(const std::string& text);

/// The points of a text as read_points reads it; messages call it `name`.
std::vector<Vec3> parse_points(const std::string& text, const std::string& name);

/// The points of a file: of a PLY its vertices, of a text one x,y,z per line; empty lines, lines that begin
/// with # and a first line of words (a header) are passed over. Throws InputError with the file and the line
/// of the first that is no point, for a header that names the columns in another order, or where there is no
/// point.
std::vector<Vec3> read_points(const std::string& file);

/// What a line of a table holds, as messages name it: "x,y,z". Where `names` are as many words between commas
/// as there are numbers, a header with one of them at another's place is refused.
struct LineForm {
    std::size_t numbers = 3;
    std::string names = "x,y,z";
    std::string what = "points";
};

/// As parse_points and read_points, of lines of so many numbers: all of them, line by line.
std::vector<double> parse_numbers(const std::string& text, const std::string& name, const LineForm& form);
std::vector<double> read_numbers(const std::string& file, const LineForm& form);

}  // namespace trilens
