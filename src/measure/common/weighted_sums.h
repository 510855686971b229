// Sums of weighted rows, several columns side by side.
#pragma once

#include <cstddef>
#include <span>

namespace trilens {

/// sums[i] = the sum over k, in rising order from zero, of weights[k] * rows[k][i], for every i below the
/// number of sums. The same bits with any instruction set. Each row has as many values as there are sums, and
/// there is one row for each weight.
void weighted_sums(std::span<const double> weights, std::span<const double* const> rows,
                   std::span<double> sums);

}  // namespace trilens
