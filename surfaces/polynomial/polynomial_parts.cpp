// Interpolates a part of a face and compares with the face elsewhere.
#include "surfaces/polynomial/polynomial_parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "base/raymesh/rational_patch.h"
#include "base/util/check.h"

namespace trilens {
namespace {

/// Interpolation and comparison disagree by this share of the part's size if it is a polynomial (some
/// thousand rounding errors); derivatives by these, in units of the part's own parameters.
constexpr double kFitTolerance = 1e-11;
constexpr std::array<double, kQuantities> kMoreTolerance = {1, 10, 10, 100, 100, 100};
/// The same as a share of the coordinates, whose rounding the surface's own evaluation carries.
constexpr double kCoordinateTolerance = 1e-14;

/// Bounds are wider than the largest disagreement found by this factor.
constexpr double kSlackFactor = 4;
/// Samples stand for a whole part if their spread is taken this often.
constexpr double kSampleFactor = 2;

constexpr std::array<double, 4> kCubicNodes = {0.05, 0.35, 0.65, 0.95};
constexpr std::array<double, 5> kQuarticNodes = {0.05, 0.25, 0.5, 0.75, 0.95};

/// Interpolation nodes of triangles: the lattice of this order over the triangle shrunk towards its middle.
constexpr int kLattice = 4;
constexpr double kShrink = 0.9, kShift = (1 - kShrink) / 3;

Vec2 at(const PartShape& shape, const Vec2& t) {
    return shape.corner + shape.size * t;
}

/// Lagrange's polynomial of lattice point (i, j) at t (Zienkiewicz, The Finite Element Method: triangular
/// family).
double lattice_basis(int i, int j, const Vec2& t) {
    const Vec2 inner = (t - kShift) / kShrink;
    const auto rising = [](int count, double x) {
        double product = 1;
        for (int m = 0; m < count; ++m) product *= (kLattice * x - m) / (m + 1);
        return product;
    };
    return rising(i, inner.x) * rising(j, inner.y) * rising(kLattice - i - j, 1 - inner.x - inner.y);
}

/// The net over the unit square of the shape's own parameters t, which for negative sizes run against (u, v).
BezierNet interpolated(const Surface& surface, Id face, const FacePart& part) {
    const auto position = [&](const Vec2& t) {
        return surface.eval_first_order(face, at(part.shape, t)).position - part.origin;
    };
    std::array<Vec3, 25> values;
    if (surface.domain(face) == FaceDomain::kSquare) {
        for (std::size_t k = 0; k < 16; ++k) values[k] = position({kCubicNodes[k % 4], kCubicNodes[k / 4]});
        return interpolating_net(kCubicNodes, std::span(values).first(16));
    }
    values.fill(Vec3(0));
    for (int j = 0; j <= kLattice; ++j) {
        for (int i = 0; i + j <= kLattice; ++i) {
            const Vec3 sample = position(kShift + kShrink * Vec2(i, j) / static_cast<double>(kLattice));
            for (std::size_t k = 0; k < 25; ++k)
                values[k] += lattice_basis(i, j, {kQuarticNodes[k % 5], kQuarticNodes[k / 5]}) * sample;
        }
    }
    return interpolating_net(kQuarticNodes, values);
}

/// Points inside a part, four by four in its quarters' quarters, none on a line of halves.
std::vector<Vec2> probes(FaceDomain domain) {
    std::vector<Vec2> points;
    for (int j = 0; j < 4; ++j) {
        for (int i = 0; i < 4; ++i) {
            if (domain == FaceDomain::kSquare) {
                const Vec2 within(0.2 + 0.2 * ((i + 2 * j) % 4), 0.2 + 0.2 * ((3 * i + j) % 4));
                points.push_back((Vec2(i, j) + within) / 4.0);
            } else {
                if (i + j <= 3) points.push_back((Vec2(i, j) + Vec2(0.3, 0.25)) / 4.0);
                if (i + j <= 2) points.push_back((Vec2(i, j) + Vec2(0.7, 0.75)) / 4.0);
            }
        }
    }
    return points;
}

/// Points ever closer to the face's own sides and corners, where creases that are sharp for many refinements
/// show only within a last narrow strip.
void add_border_probes(FaceDomain domain, const PartShape& shape, std::vector<Vec2>& points) {
    const auto add = [&](const Vec2& uv) {
        const Vec2 t = (uv - shape.corner) / shape.size;
        const bool inside =
            t.x >= 0 && t.y >= 0 && (domain == FaceDomain::kSquare ? t.x <= 1 && t.y <= 1 : t.x + t.y <= 1);
        if (inside) points.push_back(t);
    };
    const Vec2 low = shape.low(), size = shape.high() - low;
    for (double off = 0.7 * size.x; off > 0x1p-13; off /= 2) {
        for (const double along : {0.23, 0.61}) {
            const Vec2 here = low + along * size;
            for (const double far : {off, 1 - off}) {
                add({far, here.y});
                add({here.x, far});
            }
            if (domain == FaceDomain::kTriangle) add({here.x - off, 1 - here.x});
        }
        for (const double u : {off, 1 - 2 * off})
            for (const double v : {off, 1 - 2 * off}) add({u, v});
    }
}

double largest_coordinate(const Vec3& v) {
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

using PerQuantity = std::array<double, kQuantities>;

/// By what derivatives by the part's own parameters are divided to be those by the face's.
PerQuantity scales(double size) {
    return {1, size, size, size * size, size * size, size * size};
}

/// What the surface may be off a part's polynomial.
PerQuantity allowed_off(const FacePart& part) {
    double size = 0;
    for (const Vec3& control : part.net.points()) size = std::max(size, length(control));
    const double tolerance = kFitTolerance * size + kCoordinateTolerance * largest_coordinate(part.origin);
    PerQuantity allowed = scales(std::fabs(part.shape.size));
    for (std::size_t q = 0; q < kQuantities; ++q) allowed[q] = kMoreTolerance[q] * tolerance / allowed[q];
    return allowed;
}

/// The differences of the quantities between the surface and the part's nets at t, by the surface's
/// parameters.
PerQuantity differences_at(const Surface& surface, Id face, const FacePart& part,
                           const std::array<BezierNet, kQuantities>& nets, const Vec2& t) {
    SurfacePoint point = surface.eval(face, at(part.shape, t));
    point.position -= part.origin;
    PerQuantity difference = scales(part.shape.size);
    for (std::size_t q = 0; q < kQuantities; ++q)
        difference[q] = length(value(nets[q], t) / difference[q] - point.*kQuantity[q]);
    return difference;
}

/// The largest of them over the part; none as soon as one is more than allowed, or not a number.
std::optional<PerQuantity> differences(const Surface& surface, Id face, const FacePart& part,
                                       const PerQuantity& allowed) {
    std::vector<Vec2> points = probes(surface.domain(face));
    add_border_probes(surface.domain(face), part.shape, points);
    const std::array<BezierNet, kQuantities> nets = part_nets(part.net);
    PerQuantity largest{};
    for (const Vec2& t : points) {
        const PerQuantity difference = differences_at(surface, face, part, nets, t);
        for (std::size_t q = 0; q < kQuantities; ++q) {
            if (!(difference[q] <= allowed[q])) return std::nullopt;
            largest[q] = std::max(largest[q], difference[q]);
        }
    }
    return largest;
}

}  // namespace

FacePart sampled_part(const Surface& surface, Id face, const PartShape& shape) {
    constexpr int kSteps = 6;
    FacePart part;
    part.shape = shape;
    const bool triangle = surface.domain(face) == FaceDomain::kTriangle;
    part.middle = surface.eval(face, at(part.shape, Vec2(triangle ? 1.0 / 3 : 0.5)));
    part.slack.fill(0);
    part.normal_spread = 0;
    for (int j = 0; j <= kSteps; ++j) {
        for (int i = 0; i <= (triangle ? kSteps - j : kSteps); ++i) {
            const Vec2 t = Vec2(i, j) / static_cast<double>(kSteps);
            const SurfacePoint point = surface.eval(face, at(part.shape, t));
            for (std::size_t q = 0; q < kQuantities; ++q) {
                const double off = length(point.*kQuantity[q] - part.middle.*kQuantity[q]);
                part.slack[q] = std::max(part.slack[q], kSampleFactor * off);
            }
            const double turn = kSampleFactor * length(point.normal - part.middle.normal);
            part.normal_spread = std::max(part.normal_spread, turn);
        }
    }
    // Derivatives that are approximations have no second ones that bound their change.
    for (std::size_t q = 3; q < kQuantities; ++q) part.slack[q] = std::numeric_limits<double>::infinity();
    return part;
}

std::array<BezierNet, kQuantities> part_nets(const BezierNet& net) {
    const BezierNet du = derivative(net, 0), dv = derivative(net, 1);
    return {net, du, dv, derivative(du, 0), derivative(du, 1), derivative(dv, 1)};
}

std::optional<FacePart> polynomial_part(const Surface& surface, Id face, const PartShape& shape) {
    FacePart part;
    part.shape = shape;
    part.origin = surface.eval_first_order(face, at(shape, Vec2(0.3))).position;
    part.net = interpolated(surface, face, part);
    const PerQuantity allowed = allowed_off(part);
    const std::optional<PerQuantity> off = differences(surface, face, part, allowed);
    if (!off) return std::nullopt;
    part.is_polynomial = true;
    for (std::size_t q = 0; q < kQuantities; ++q) part.slack[q] = kSlackFactor * (*off)[q];
    add_rounding(part);
    return part;
}

void add_rounding(FacePart& part) {
    const PerQuantity allowed = allowed_off(part);
    for (std::size_t q = 0; q < kQuantities; ++q) part.slack[q] += 0.05 * allowed[q];
}

bool agrees_at(const Surface& surface, Id face, const FacePart& part, const Vec2& t) {
    const PerQuantity off = differences_at(surface, face, part, part_nets(part.net), t);
    for (std::size_t q = 0; q < kQuantities; ++q)
        if (!(off[q] <= part.slack[q])) return false;
    return true;
}

namespace {

constexpr std::size_t kMost = BezierNet::kHighest + 1;
using Weights = BezierWeights<kMost>;

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
    for (int i = 0; i <= degree; ++i)
        rows.row[static_cast<std::size_t>(i)] = blossom<kMost>(degree, i, low, high);
    return rows;
}

/// The inverse of the matrix whose row k holds the Bernstein polynomials at node k, by Gauss and Jordan.
Rows inverse_of_basis(std::span<const double> nodes) {
    const std::size_t n = nodes.size();
    Rows matrix, inverse;
    for (std::size_t k = 0; k < n; ++k) {
        matrix.row[k] = blossom<kMost>(static_cast<int>(n) - 1, static_cast<int>(n) - 1, nodes[k], nodes[k]);
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
    const Weights u = blossom<kMost>(net.nu, net.nu, t.x, t.x), v = blossom<kMost>(net.nv, net.nv, t.y, t.y);
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
    if (low == Vec2(0) && high == Vec2(1)) return net;
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
