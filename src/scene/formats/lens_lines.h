// What readers of lens files have in common: the lens so far, the line that is read, numbers in its words.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/util/error.h"
#include "lens/prescription.h"
#include "scene/formats/line_scanner.h"

namespace trilens {

class LensLines {
  protected:
    LensLines(const std::string& file, std::span<const Glass> glasses)
        : glasses_(glasses.begin(), glasses.end()) {
        lens_.file = file;
    }

    std::string place() const { return "line " + std::to_string(line_); }

    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(lens_.file, place(), message);
    }

    /// Exponents may be Fortran's, 1.5D-3.
    double number(const std::vector<std::string_view>& words, std::size_t index) const {
        const std::string key(words[0]);
        if (index >= words.size()) fail(key + " needs a number");
        std::string text(words[index]);
        for (char& letter : text)
            if (letter == 'd' || letter == 'D') letter = 'E';
        const std::optional<double> value = parse_number(text);
        if (!value || !std::isfinite(*value))
            fail(key + " needs a number, not \"" + std::string(words[index]) + "\"");
        return *value;
    }

    LensPrescription lens_;
    std::vector<Glass> glasses_;  // beside the catalogue's
    std::size_t line_ = 0;
};

}  // namespace trilens
