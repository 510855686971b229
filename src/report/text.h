// Numbers and text as they stand in reports: the same in every locale, safe inside markup.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace trilens {

/// Names with their values, in the order in which a page has them.
using Facts = std::vector<std::pair<std::string, std::string>>;

/// The shortest decimal text that reads back as the same double; "nan", "inf", "-inf".
std::string shortest_text(double value);

/// `value` with `decimals` digits (0..100; the nearest of these for others) after the point; never
/// "-0.00". Not finite: as shortest_text.
std::string fixed_text(double value, int decimals);

/// `value` rounded to `digits` (1..17; the nearest of these for others) significant digits, without trailing
/// zeros; with an exponent below 1e-4 and from 1e6 on. Not finite: as shortest_text.
std::string rounded_text(double value, int digits);

/// `text` for XML and HTML, in elements and in quoted attributes: the five special characters become
/// entities; bytes that are no UTF-8, and control characters that XML forbids, become U+FFFD.
std::string escape_markup(std::string_view text);

/// `text` as a JSON string, quotes around it; bytes that are no UTF-8 become U+FFFD.
std::string json_text(std::string_view text);

/// `text` for LaTeX, in text mode: its ten special characters escaped.
std::string latex_text(std::string_view text);

/// `text` as a cell of a CSV table: quoted as RFC 4180 has it where it holds commas, quotes or line ends.
std::string csv_text(std::string_view text);

/// RFC 4648 base64, padded, on one line.
std::string base64_text(std::span<const unsigned char> bytes);

}  // namespace trilens
