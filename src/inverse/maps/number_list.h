// Numbers in texts: "1,2.5,-3e4".
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

namespace trilens {

/// A whole number of at least 0; none where the text is anything else.
inline std::optional<int> whole_number(std::string_view text) {
    int value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || stop != text.data() + text.size() || value < 0) return std::nullopt;
    return value;
}

/// Finite numbers with commas between them; none where the text is anything else.
inline std::optional<std::vector<double>> number_list(std::string_view text) {
    std::vector<double> numbers;
    while (true) {
        const std::size_t comma = std::min(text.find(','), text.size());
        double value = 0;
        const auto [stop, error] = std::from_chars(text.data(), text.data() + comma, value);
        if (error != std::errc() || stop != text.data() + comma || !std::isfinite(value)) return std::nullopt;
        numbers.push_back(value);
        if (comma == text.size()) return numbers;
        text.remove_prefix(comma + 1);
    }
}

}  // namespace trilens
