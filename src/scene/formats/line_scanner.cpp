// Splits lines and reads numbers, the same in every locale.
#include "scene/formats/line_scanner.h"

#include <charconv>
#include <limits>
#include <system_error>

namespace trilens {
namespace {

bool is_space(char letter) {
    return letter == ' ' || letter == '\t' || letter == '\r' || letter == '\v' || letter == '\f';
}

}  // namespace

std::vector<std::string_view> split_words(std::string_view line) {
    std::vector<std::string_view> words;
    std::size_t i = 0;
    while (i < line.size()) {
        while (i < line.size() && is_space(line[i])) ++i;
        const std::size_t begin = i;
        while (i < line.size() && !is_space(line[i])) ++i;
        if (i == begin || line[begin] == '#') break;
        words.push_back(line.substr(begin, i - begin));
    }
    return words;
}

std::string rest_of_line(std::string_view line, std::string_view first_word) {
    const char* end_of_word = first_word.data() + first_word.size();
    std::string_view rest = line.substr(static_cast<std::size_t>(end_of_word - line.data()));
    while (!rest.empty() && is_space(rest.front())) rest.remove_prefix(1);
    while (!rest.empty() && is_space(rest.back())) rest.remove_suffix(1);
    return std::string(rest);
}

std::optional<double> parse_number(std::string_view word) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    double value = 0;
    const char* end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (stop != end) return std::nullopt;
    if (error == std::errc()) return value;
    if (error != std::errc::result_out_of_range) return std::nullopt;
    // Out of range tells not which way: a negative exponent says too small.
    const std::size_t exponent = word.find_first_of("eE");
    const bool too_small =
        exponent != std::string_view::npos && word.find('-', exponent) != std::string_view::npos;
    return too_small ? 0 : std::numeric_limits<double>::infinity();
}

std::optional<int> parse_integer(std::string_view word) {
    int value = 0;
    const char* end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (error != std::errc() || stop != end) return std::nullopt;
    return value;
}

}  // namespace trilens
