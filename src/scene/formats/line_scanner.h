// Lines of a text format as words and numbers.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trilens {

/// The words of a line between spaces and tabs, up to a word that begins with '#'.
std::vector<std::string_view> split_words(std::string_view line);

/// What follows `first_word`, which must point into `line`, without spaces at the ends.
std::string rest_of_line(std::string_view line, std::string_view first_word);

/// A decimal number with an optional sign; one too small for a double is 0. None for anything else. May be
/// NaN or infinite, the latter also for what is too large for a double.
std::optional<double> parse_number(std::string_view word);

/// A decimal integer that fits an int, with an optional minus. None for anything else.
std::optional<int> parse_integer(std::string_view word);

}  // namespace trilens
