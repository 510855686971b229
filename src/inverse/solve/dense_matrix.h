// Dense matrices of doubles, row by row, for problems of up to some hundred unknowns.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace trilens {

/// rows x columns numbers; zero at first.
struct DenseMatrix {
    std::size_t rows = 0, columns = 0;
    std::vector<double> values;

    DenseMatrix() = default;
    DenseMatrix(std::size_t row_count, std::size_t column_count)
        : rows(row_count), columns(column_count), values(row_count * column_count) {}

    double& operator()(std::size_t row, std::size_t column) { return values[row * columns + column]; }
    double operator()(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
    std::span<double> row(std::size_t r) { return std::span(values).subspan(r * columns, columns); }
    std::span<const double> row(std::size_t r) const {
        return std::span(values).subspan(r * columns, columns);
    }
};

double dot_product(std::span<const double> a, std::span<const double> b);

/// Where every value is finite.
bool all_finite(std::span<const double> values);

}  // namespace trilens
