// Numbers appended to text as decimals: what std::to_chars writes, faster where they are neither tiny nor
// huge.
//
//     std::string text;
//     trilens::append_fixed(text, 640.125, 2);            // 640.12: of two as near the even one
//     trilens::append_significant(text += ' ', 0.1, 12);  // 0.1
//     std::puts(text.c_str());
#pragma once

#include <string>

namespace trilens {

/// With `digits` digits behind the point, 0 to 12: as std::to_chars writes it with std::chars_format::fixed.
/// Throws UsageError for other digits.
void append_fixed(std::string& text, double value, int digits);

/// With `digits` significant digits, 1 to 12: as std::to_chars writes it with std::chars_format::general,
/// without zeros at its end and with an exponent where that is shorter. Throws UsageError for other digits.
void append_significant(std::string& text, double value, int digits);

}  // namespace trilens
