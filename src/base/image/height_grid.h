// Heights over a regular grid, as a file of a terrain holds them.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace trilens {

/// Samples along one side at most: the square around them then takes up to 1.1 GB while it is thinned.
inline constexpr int kMostHeightsSide = 8193;

/// Samples, row by row from the top. Unsigned integers of 8 and 16 bits are shares of the greatest (0..1),
/// all other values stand as the file has them, those that are not finite among them.
struct HeightGrid {
    int columns = 0, rows = 0;
    int channels = 1;  // of the file; the first is taken
    std::vector<float> values;
    double greatest = 0;   // of the integers whose shares the values are; 0: they are numbers of the file
    bool is_half = false;  // numbers of half precision
    std::optional<double> no_data = {};  // what the file itself says holds nothing: those values are NaN

    float at(int column, int row) const {
        return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                      static_cast<std::size_t>(column)];
    }
    /// Whether `value` is what the file's number `raw` has become, as far as the file tells numbers apart (a
    /// float from the next); never for NaN.
    bool stands_for(float value, double raw) const;
};

}  // namespace trilens
