#include "camera/chain_newton.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trilens {
namespace {

/// The operator has to shrink the box by so much.
constexpr double kContraction = 0.9;
constexpr int kNewtonSteps = 40;
/// A step below this, in parameters, is none.
constexpr double kAtRest = 1e-13;
/// Zeros this far outside of a cell are on its border.
constexpr double kOnBorder = 1e-11;

/// A square matrix, row by row.
struct Matrix {
    std::size_t size = 0;
    std::vector<double> entries;

    explicit Matrix(std::size_t n) : size(n), entries(n * n, 0) {}
    double& at(std::size_t row, std::size_t column) { return entries[row * size + column]; }
    double at(std::size_t row, std::size_t column) const { return entries[row * size + column]; }
};

/// By Gauss and Jordan, with pivots from each column; not finite where there is none.
Matrix inverse_of(Matrix m) {
    Matrix inverse(m.size);
    for (std::size_t i = 0; i < m.size; ++i) inverse.at(i, i) = 1;
    for (std::size_t c = 0; c < m.size; ++c) {
        std::size_t pivot = c;
        for (std::size_t r = c + 1; r < m.size; ++r)
            if (std::fabs(m.at(r, c)) > std::fabs(m.at(pivot, c))) pivot = r;
        for (std::size_t k = 0; k < m.size && pivot != c; ++k) {
            std::swap(m.at(c, k), m.at(pivot, k));
            std::swap(inverse.at(c, k), inverse.at(pivot, k));
        }
        const double by = 1 / m.at(c, c);
        for (std::size_t k = 0; k < m.size; ++k) m.at(c, k) *= by, inverse.at(c, k) *= by;
        for (std::size_t r = 0; r < m.size; ++r) {
            const double factor = r == c ? 0 : m.at(r, c);
            for (std::size_t k = 0; k < m.size && factor != 0; ++k) {
                m.at(r, k) -= factor * m.at(c, k);
                inverse.at(r, k) -= factor * inverse.at(c, k);
            }
        }
    }
    return inverse;
}

std::vector<double> product(const Matrix& m, const std::vector<double>& v, bool absolute = false) {
    std::vector<double> result(m.size, 0);
    for (std::size_t r = 0; r < m.size; ++r)
        for (std::size_t c = 0; c < m.size; ++c)
            result[r] += (absolute ? std::fabs(m.at(r, c)) : m.at(r, c)) * v[c];
    return result;
}

/// (a . Q b) / d, Q the projection across a sight of distance d.
double turned(const Sight& sight, const Vec3& a, const Vec3& b) {
    return sight.by_distance * (dot(a, b) - dot(sight.direction, a) * dot(sight.direction, b));
}

/// The laws and their derivatives at one point of each surface.
struct System {
    std::vector<double> law;
    Matrix hessian;
};

Vec3 bend_at(const ChainCell& cell, const Sight& in, const Sight& out) {
    return cell.before * in.direction - cell.after * out.direction;
}

System system_at(const ChainCells& cells, std::span<const SurfacePoint> points,
                 std::span<const Sight> sights) {
    System system{{}, Matrix(2 * cells.size())};
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const ChainCell& cell = cells[i];
        const SurfacePoint& p = points[i];
        const Sight &in = sights[i], &out = sights[i + 1];
        const Vec3 bend = bend_at(cell, in, out);
        system.law.push_back(dot(bend, p.du));
        system.law.push_back(dot(bend, p.dv));
        const std::array<Vec3, 2> tangent{p.du, p.dv};
        const std::array<std::array<Vec3, 2>, 2> second{{{p.duu, p.duv}, {p.duv, p.dvv}}};
        for (std::size_t a = 0; a < 2; ++a)
            for (std::size_t b = 0; b < 2; ++b) {
                system.hessian.at(2 * i + a, 2 * i + b) = cell.before * turned(in, tangent[a], tangent[b]) +
                                                          cell.after * turned(out, tangent[a], tangent[b]) +
                                                          dot(bend, second[a][b]);
                if (i + 1 == cells.size()) continue;
                const Vec3& next = b == 0 ? points[i + 1].du : points[i + 1].dv;
                const double mixed = -cell.after * turned(out, tangent[a], next);
                system.hessian.at(2 * i + a, 2 * i + 2 + b) = mixed;
                system.hessian.at(2 * i + 2 + b, 2 * i + a) = mixed;
            }
    }
    return system;
}

using Reach = CellTerms::Reach;

/// The derivatives of one cell.
struct Reaches {
    std::array<Reach, 2> tangent;
    std::array<std::array<Reach, 2>, 2> second;
};

Reaches reaches_of(const SurfaceBounds& bounds) {
    const SurfacePoint& m = bounds.middle;
    const Reach uv = reach_of(m.duv, bounds.duv_radius);
    return {{reach_of(m.du, bounds.du_radius), reach_of(m.dv, bounds.dv_radius)},
            {{{reach_of(m.duu, bounds.duu_radius), uv}, {uv, reach_of(m.dvv, bounds.dvv_radius)}}}};
}

/// How far the Hessian's entries lie from the middle's, anywhere in the box.
Matrix radii_of(const ChainCells& cells, std::span<const Sight> sights) {
    std::vector<Reaches> reaches;
    for (const ChainCell& cell : cells) reaches.push_back(reaches_of(*cell.bounds));
    Matrix radii(2 * cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const ChainCell& cell = cells[i];
        const Sight &in = sights[i], &out = sights[i + 1];
        const double bend = length(bend_at(cell, in, out)),
                     turn = cell.before * in.turn + cell.after * out.turn;
        const double in_stretch = in.stretch(), out_stretch = out.stretch();
        const Reaches& own = reaches[i];
        for (std::size_t a = 0; a < 2; ++a)
            for (std::size_t b = 0; b < 2; ++b) {
                radii.at(2 * i + a, 2 * i + b) =
                    cell.before * turning_radius(in, in_stretch, own.tangent[a], own.tangent[b]) +
                    cell.after * turning_radius(out, out_stretch, own.tangent[a], own.tangent[b]) +
                    turn * own.second[a][b].all + bend * own.second[a][b].radius;
                if (i + 1 == cells.size()) continue;
                const double mixed =
                    cell.after * turning_radius(out, out_stretch, own.tangent[a], reaches[i + 1].tangent[b]);
                radii.at(2 * i + a, 2 * i + 2 + b) = mixed;
                radii.at(2 * i + 2 + b, 2 * i + a) = mixed;
            }
    }
    return radii;
}

/// What rounding leaves of the laws at a zero.
std::vector<double> rounding_of(const ChainCells& cells, std::span<const Sight> sights) {
    constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
    std::vector<double> rounding;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const SurfacePoint& m = cells[i].bounds->middle;
        const double size = length(m.position) + cells[i].bounds->position_radius;
        const auto of_way = [&](double index, const Sight& sight) {
            const double far = sight.by_distance > 0 ? 1 / sight.by_distance : 0;
            return index * (1 + (size + far) * (sight.by_distance + sight.stretch()));
        };
        const double bend =
            kRounding * (of_way(cells[i].before, sights[i]) + of_way(cells[i].after, sights[i + 1]));
        rounding.push_back(bend * length(m.du));
        rounding.push_back(bend * length(m.dv));
    }
    return rounding;
}

/// The ways between eye, points of the surfaces and point, of no size.
std::optional<std::vector<Sight>> sights_at(std::span<const SurfacePoint> points, const LinearCamera& camera,
                                            const Vec3& point) {
    std::vector<Sight> sights(points.size() + 1);
    const auto set = [](Sight& sight, const Vec3& way) {
        const double distance = length(way);
        sight.direction = way / distance;
        sight.by_distance = 1 / distance;
        return distance > 0;
    };
    bool apart = set(sights[0], incident_direction(camera, points[0].position));
    if (camera.parallel) sights[0].by_distance = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        apart = apart && set(sights[i + 1],
                             (i + 1 < points.size() ? points[i + 1].position : point) - points[i].position);
    if (!apart) return std::nullopt;
    return sights;
}

}  // namespace

ChainKrawczyk::ChainKrawczyk(const ChainCells& cells, std::span<const Sight> sights) : cells_(cells) {
    std::vector<SurfacePoint> middles;
    std::vector<double> half;
    for (const ChainCell& cell : cells) {
        middles.push_back(cell.bounds->middle);
        half.push_back(cell.box.half().x);
        half.push_back(cell.box.half().y);
    }
    const System system = system_at(cells, middles, sights);
    const Matrix inverse = inverse_of(system.hessian);
    step_ = product(inverse, system.law);
    const std::vector<double> spread = product(inverse, product(radii_of(cells, sights), half), true);
    const std::vector<double> rounding = product(inverse, rounding_of(cells, sights), true);
    bool contracts = true;
    for (std::size_t k = 0; k < half.size(); ++k) {
        step_[k] = -step_[k];
        const double reach = half[k] + spread[k] + rounding[k] + kCellBorder;
        if (!std::isfinite(step_[k] + reach)) return;
        if (std::fabs(step_[k]) > reach) {
            verdict_ = ChainVerdict::kEmpty;
            return;
        }
        contracts = contracts && spread[k] <= kContraction * half[k];
    }
    if (contracts) verdict_ = ChainVerdict::kOneAtMost;
}

std::optional<ChainZero> ChainKrawczyk::find_zero(const LinearCamera& camera, const Vec3& point) const {
    std::vector<Vec2> at;
    for (std::size_t i = 0; i < cells_.size(); ++i)
        at.push_back(glm::clamp(cells_[i].box.middle() + Vec2(step_[2 * i], step_[2 * i + 1]),
                                cells_[i].box.low, cells_[i].box.high));
    for (int walk = 0; walk < kNewtonSteps; ++walk) {
        std::vector<SurfacePoint> points;
        for (std::size_t i = 0; i < cells_.size(); ++i)
            points.push_back(cells_[i].surface->eval(cells_[i].box.face, at[i]));
        const auto sights = sights_at(points, camera, point);
        if (!sights) return std::nullopt;
        const System system = system_at(cells_, points, *sights);
        const std::vector<double> step = product(inverse_of(system.hessian), system.law);
        double far = 0;
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            const Vec2 by(step[2 * i], step[2 * i + 1]);
            if (!std::isfinite(by.x + by.y)) return std::nullopt;
            const CellBox& box = cells_[i].box;
            far = std::max({far, std::fabs(by.x), std::fabs(by.y)});
            at[i] -= by;
            const Vec2 outside = glm::max(glm::max(box.low - at[i], at[i] - box.high), Vec2(0));
            if (std::max(outside.x, outside.y) > kOnBorder && walk > kNewtonSteps / 2) return std::nullopt;
            at[i] = glm::clamp(at[i], box.low - kOnBorder, box.high + kOnBorder);
        }
        if (far > kAtRest) continue;
        ChainZero zero;
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            zero.positions.push_back(points[i].position);
            const bool is_triangle = cells_[i].surface->domain(cells_[i].box.face) == FaceDomain::kTriangle;
            if (is_triangle && at[i].x + at[i].y > 1 + kOnBorder) zero.is_in_domain = false;
        }
        return zero;
    }
    return std::nullopt;
}

}  // namespace trilens
