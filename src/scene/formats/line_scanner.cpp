// Splits lines and reads numbers, the same in every locale.
#include "scene/formats/line_scanner.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include "base/util/error.h"

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

std::string in_capitals(std::string_view word) {
    std::string text(word);
    for (char& letter : text)
        if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
    return text;
}

void WordScanner::fail(const std::string& message) const {
    throw InputError(file_, "line " + std::to_string(line_), message);
}

std::string_view WordScanner::rest_of_line() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    ++line_;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

std::string_view WordScanner::word() {
    const auto is_between = [](char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; };
    while (at_ < text_.size() && is_between(text_[at_])) line_ += text_[at_++] == '\n';
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_between(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
}

std::string_view WordScanner::peek() {
    const std::size_t at = at_, line = line_;
    const std::string_view next = word();
    at_ = at;
    line_ = line;
    return next;
}

double WordScanner::number() {
    const std::string_view next = word();
    const std::optional<double> value = parse_number(next);
    if (!value)
        fail(next.empty() ? "the file ends where a number must stand"
                          : "a number must stand where '" + std::string(next) + "' does");
    return *value;
}

std::size_t WordScanner::count(const char* what) {
    const double value = number();
    if (!(value >= 0 && value <= 4e9 && value == std::floor(value)))
        fail(std::string("a whole number must stand here: ") + what);
    return static_cast<std::size_t>(value);
}

std::string_view WordScanner::bytes(std::size_t count, const std::string& what) {
    rest_of_line();
    if (count > text_.size() - at_)
        fail("says that " + what + " follow, for which the rest of the file is too short");
    const std::string_view found = text_.substr(at_, count);
    at_ += count;
    return found;
}

void WordScanner::expect(std::size_t numbers, const std::string& what) const {
    if (numbers > (text_.size() - at_ + 1) / 2)
        fail("says that " + what + " follow, for which the rest of the file is too short");
}

void WordScanner::keyword(const char* wanted) {
    const std::string_view next = word();
    if (in_capitals(next) != wanted)
        fail("'" + std::string(wanted) + "' must stand where '" + std::string(next) + "' does");
}

}  // namespace trilens
