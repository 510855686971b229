// De Casteljau's algorithm as products of linear polynomials in the shift operator (Farin, Curves and
// Surfaces for CAGD, chapter 5).
#include "surfaces/polynomial/bezier_net.h"

#include <cmath>
#include <cstddef>
#include <utility>

#include "base/util/check.h"

namespace trilens {
namespace {

constexpr std::size_t kMost = BezierNet::kHighest + 1;

/// Weights on the control points of one direction.
using Weights = std::array<double, kMost>;

/// One step of de Casteljau's algorithm at t: the weights times ((1 - t) + t E), E the shift by one.
void step(Weights& weights, double t) {
    for (std::size_t k = kMost - 1; k > 0; --k) weights[k] = (1 - t) * weights[k] + t * weights[k - 1];
    weights[0] *= 1 - t;
}

/// The blossom's weights for `count` arguments, those before `from_high` equal to high, the others to low.
Weights blossom(int count, int from_high, double low, double high) {
    Weights weights{1};
    for (int k = 0; k < count; ++k) step(weights, k < from_high ? high : low);
    return weights;
}

struct Rows {
    std::array<Weights, kMost> row{};
};

/// New control points along one direction as sums of the old ones.
BezierNet combined(const BezierNet& net, const Rows& along_u, const Rows& along_v) {
    const std::size_t wide = static_cast<std::size_t>(net.nu) + 1,
                      high = static_cast<std::size_t>(net.nv) + 1;
    BezierNet half = net, result = net;
    for (std::size_t j = 0; j < high; ++j) {
        for (std::size_t i = 0; i < wide; ++i) {
            Vec3 sum(0);
            for (std::size_t k = 0; k < wide; ++k) sum += along_u.row[i][k] * net.point[j * wide + k];
            half.point[j * wide + i] = sum;
        }
    }
    for (std::size_t j = 0; j < high; ++j) {
        for (std::size_t i = 0; i < wide; ++i) {
            Vec3 sum(0);
            for (std::size_t k = 0; k < high; ++k) sum += along_v.row[j][k] * half.point[k * wide + i];
            result.point[j * wide + i] = sum;
        }
    }
    return result;
}

Rows restriction(int degree, double low, double high) {
    Rows rows;
    for (int i = 0; i <= degree; ++i) rows.row[static_cast<std::size_t>(i)] = blossom(degree, i, low, high);
    return rows;
}

/// The inverse of the matrix whose row k holds the Bernstein polynomials at node k, by Gauss and Jordan.
Rows inverse_of_basis(std::span<const double> nodes) {
    const std::size_t n = nodes.size();
    Rows matrix, inverse;
    for (std::size_t k = 0; k < n; ++k) {
        matrix.row[k] = blossom(static_cast<int>(n) - 1, static_cast<int>(n) - 1, nodes[k], nodes[k]);
        inverse.row[k][k] = 1;
    }
    for (std::size_t column = 0; column < n; ++column) {
        std::size_t pivot = column;
        for (std::size_t k = column + 1; k < n; ++k)
            if (std::fabs(matrix.row[k][column]) > std::fabs(matrix.row[pivot][column])) pivot = k;
        std::swap(matrix.row[column], matrix.row[pivot]);
        std::swap(inverse.row[column], inverse.row[pivot]);
        TRILENS_CHECK(matrix.row[column][column] != 0, "nodes of an interpolation differ");
        for (std::size_t k = 0; k < n; ++k) {
            const double share = matrix.row[k][column] / matrix.row[column][column];
            for (std::size_t c = 0; c < n && k != column; ++c) {
                matrix.row[k][c] -= share * matrix.row[column][c];
                inverse.row[k][c] -= share * inverse.row[column][c];
            }
        }
    }
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t c = 0; c < n; ++c) inverse.row[k][c] /= matrix.row[k][k];
    return inverse;
}

}  // namespace

Vec3 value(const BezierNet& net, const Vec2& t) {
    const Weights u = blossom(net.nu, net.nu, t.x, t.x), v = blossom(net.nv, net.nv, t.y, t.y);
    const std::size_t wide = static_cast<std::size_t>(net.nu) + 1;
    Vec3 sum(0);
    for (std::size_t j = 0; j <= static_cast<std::size_t>(net.nv); ++j)
        for (std::size_t i = 0; i < wide; ++i) sum += u[i] * v[j] * net.point[j * wide + i];
    return sum;
}

BezierNet derivative(const BezierNet& net, int axis) {
    const int degree = axis == 0 ? net.nu : net.nv;
    BezierNet result;
    result.nu = net.nu - (axis == 0 && degree > 0 ? 1 : 0);
    result.nv = net.nv - (axis == 1 && degree > 0 ? 1 : 0);
    if (degree == 0) return result;
    const std::size_t wide = static_cast<std::size_t>(net.nu) + 1, next = axis == 0 ? 1 : wide;
    for (std::size_t j = 0; j <= static_cast<std::size_t>(result.nv); ++j) {
        for (std::size_t i = 0; i <= static_cast<std::size_t>(result.nu); ++i) {
            const Vec3* from = &net.point[j * wide + i];
            result.point[j * (static_cast<std::size_t>(result.nu) + 1) + i] =
                static_cast<double>(degree) * (from[next] - *from);
        }
    }
    return result;
}

BezierNet restricted(const BezierNet& net, const Vec2& low, const Vec2& high) {
    return combined(net, restriction(net.nu, low.x, high.x), restriction(net.nv, low.y, high.y));
}

BezierNet interpolating_net(std::span<const double> nodes, std::span<const Vec3> values) {
    const std::size_t n = nodes.size();
    TRILENS_CHECK(n >= 1 && n <= kMost && values.size() == n * n, "a value at every pair of nodes");
    BezierNet samples;
    samples.nu = samples.nv = static_cast<int>(n) - 1;
    for (std::size_t k = 0; k < values.size(); ++k) samples.point[k] = values[k];
    const Rows inverse = inverse_of_basis(nodes);
    return combined(samples, inverse, inverse);
}

}  // namespace trilens
