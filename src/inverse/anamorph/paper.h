// Paper sizes (ISO 216 and ANSI), lengths and units as people write them.
#pragma once

#include <string>

namespace trilens {

struct PaperSize {
    double width = 210, height = 297;  // millimetres
};

/// "A0" to "A6", "letter", "legal", "tabloid", or "WxH" in millimetres; upright. Throws UsageError with the
/// names.
PaperSize parse_paper(const std::string& text);

/// Metres: "mm", "cm", "dm", "m", "km", "in" or "ft". Throws UsageError with the names.
double parse_unit(const std::string& text);

/// Millimetres of "2mm", "0.5cm", "1in" or a bare number of millimetres, at least 0. Throws UsageError.
double parse_length(const std::string& text);

}  // namespace trilens
