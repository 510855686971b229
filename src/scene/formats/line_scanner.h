// Text formats as words and numbers: line by line, or word by word.
#pragma once

#include <cstddef>
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

/// The word with the letters a to z as capitals.
std::string in_capitals(std::string_view word);

/// Words of a text between spaces and line ends, one after the other. Its errors name the line of the last
/// one.
class WordScanner {
  public:
    /// Both must live longer.
    WordScanner(std::string_view text, const std::string& file) : text_(text), file_(file) {}

    /// Throws InputError(file, "line n").
    [[noreturn]] void fail(const std::string& message) const;

    /// The next word; empty at the end of the text.
    std::string_view word();
    /// The same, which stays the next one.
    std::string_view peek();
    /// What is left of the line.
    std::string_view rest_of_line();

    // The next word as something else. Each fails where it is none.
    double number();
    std::size_t count(const char* what);  // a whole number up to 4e9, of what it says
    void keyword(const char* wanted);     // in capitals of any case

    /// As many bytes as they are, from the next line on. Fails where there are fewer.
    std::string_view bytes(std::size_t count, const std::string& what);

    /// Fails where that many numbers cannot follow: each takes two letters at the least.
    void expect(std::size_t numbers, const std::string& what) const;

    std::size_t line() const { return line_; }

  private:
    std::string_view text_;
    const std::string& file_;
    std::size_t at_ = 0, line_ = 1;
};

}  // namespace trilens
