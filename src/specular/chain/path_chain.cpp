#include "specular/chain/path_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/util/check.h"
#include "specular/chain/sight.h"

namespace trilens {
namespace {

constexpr int kMostChainSteps = 60, kMostHalvings = 30;
constexpr double kChainTolerance = 1e-13;  // residual of a solution per index: some hundred rounding errors
constexpr double kChainRounding = 64;      // units of rounding that coordinates carry through
constexpr double kChainParameterStep = 1e-11;  // a step below it, in (u, v), ends the search
constexpr double kChainReach = 0.5;  // a step goes no farther than this in (u, v), of the unit square

double index_along(const PathChain& chain, std::size_t stretch) {
    return stretch == 0 ? chain.events[0].index_before : chain.events[stretch - 1].index_after;
}

ChainShape shape_at(const PathChain& chain, std::span<const SurfaceParameter> at) {
    ChainShape shape;
    shape.at.assign(at.begin(), at.end());
    for (std::size_t i = 0; i < at.size(); ++i)
        shape.points.push_back(chain.events[i].surface->eval(at[i].face, at[i].uv));
    return shape;
}

/// The residual that rounding of coordinates leaves.
double chain_floor(const PathChain& chain, const ChainBend& bend, std::span<const SurfacePoint> points) {
    double coordinate = 0, shortest = std::numeric_limits<double>::infinity(), index = 1;
    for (const ChainEnd* end : {&chain.eye, &chain.point})
        if (!end->is_direction) coordinate = std::max(coordinate, length(end->place));
    for (const SurfacePoint& point : points) coordinate = std::max(coordinate, length(point.position));
    for (const double way : bend.length) shortest = std::min(shortest, way);
    for (const ChainEvent& event : chain.events)
        index = std::max({index, event.index_before, event.index_after});
    return 2 * index *
           (kChainTolerance + kChainRounding * std::numeric_limits<double>::epsilon() *
                                  std::min(coordinate, 1e6 * shortest) / shortest);
}

}  // namespace

ChainBend chain_bend(const PathChain& chain, std::span<const SurfacePoint> points) {
    const std::size_t k = points.size();
    ChainBend bend;
    bend.way.resize(k + 1);
    bend.length.resize(k + 1);
    bend.bend.resize(k);
    for (std::size_t i = 0; i <= k; ++i) {
        const bool open = (i == 0 && chain.eye.is_direction) || (i == k && chain.point.is_direction);
        if (open) {
            bend.way[i] = i == 0 ? chain.eye.place : chain.point.place;
            bend.length[i] = std::numeric_limits<double>::infinity();
            continue;
        }
        const Vec3& from = i == 0 ? chain.eye.place : points[i - 1].position;
        const Vec3& to = i == k ? chain.point.place : points[i].position;
        bend.way[i] = normalize_or_zero(to - from);
        bend.length[i] = length(to - from);
    }
    for (std::size_t i = 0; i < k; ++i)
        bend.bend[i] =
            chain.events[i].index_before * bend.way[i] - chain.events[i].index_after * bend.way[i + 1];
    return bend;
}

PerEvent<Vec2> chain_law(const ChainBend& bend, std::span<const SurfacePoint> points) {
    PerEvent<Vec2> law;
    for (std::size_t i = 0; i < points.size(); ++i)
        law.push_back({dot(bend.bend[i], points[i].du), dot(bend.bend[i], points[i].dv)});
    return law;
}

double chain_residual(const ChainBend& bend, std::span<const SurfacePoint> points) {
    double most = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3& n = points[i].normal;
        if (n == Vec3(0)) return std::numeric_limits<double>::infinity();
        const double along = length(bend.bend[i] - dot(bend.bend[i], n) * n);
        most = std::isfinite(along) ? std::max(most, along) : std::numeric_limits<double>::infinity();
    }
    return most;
}

bool chain_sides_fit(const PathChain& chain, const ChainBend& bend, std::span<const SurfacePoint> points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double sides = dot(bend.way[i], points[i].normal) * dot(bend.way[i + 1], points[i].normal);
        if (!(chain.events[i].reflects ? sides < 0 : sides > 0)) return false;
    }
    return true;
}

ChainMatrix chain_second_derivatives(const PathChain& chain, const ChainBend& bend,
                                     std::span<const SurfacePoint> points) {
    TRILENS_CHECK(points.size() == chain.events.size(), "a point for each event");
    const std::size_t size = 2 * points.size();
    ChainMatrix matrix(size * size, 0.0);
    const auto at = [&](std::size_t row, std::size_t column) -> double& {
        return matrix[row * size + column];
    };
    for (std::size_t i = 0; i < points.size(); ++i) {
        const SurfacePoint& p = points[i];
        const Vec3 tangent[2] = {p.du, p.dv};
        const Vec3 second[3] = {p.duu, p.duv, p.dvv};
        for (std::size_t a = 0; a < 2; ++a) {
            const Vec3 turn =
                turn_of_way(index_along(chain, i) / bend.length[i], bend.way[i], tangent[a]) +
                turn_of_way(index_along(chain, i + 1) / bend.length[i + 1], bend.way[i + 1], tangent[a]);
            for (std::size_t b = 0; b < 2; ++b)
                at(2 * i + b, 2 * i + a) = dot(turn, tangent[b]) + dot(bend.bend[i], second[a + b]);
            if (i + 1 == points.size()) continue;
            const Vec3 next =
                turn_of_way(index_along(chain, i + 1) / bend.length[i + 1], bend.way[i + 1], tangent[a]);
            const Vec3 other[2] = {points[i + 1].du, points[i + 1].dv};
            for (std::size_t b = 0; b < 2; ++b)
                at(2 * i + 2 + b, 2 * i + a) = at(2 * i + a, 2 * i + 2 + b) = -dot(next, other[b]);
        }
    }
    return matrix;
}

ChainHessian::ChainHessian(const PathChain& chain, const ChainBend& bend,
                           std::span<const SurfacePoint> points)
    : size_(2 * points.size()), matrix_(chain_second_derivatives(chain, bend, points)), pivot_(size_) {
    factor();
}

/// LU in place; what elimination reaches stays within three rows below and, with exchanges, six columns.
void ChainHessian::factor() {
    constexpr std::size_t kBelow = 3, kRight = 6;
    for (std::size_t c = 0; c < size_; ++c) {
        const std::size_t last_row = std::min(size_ - 1, c + kBelow), last = std::min(size_ - 1, c + kRight);
        std::size_t best = c;
        for (std::size_t r = c + 1; r <= last_row; ++r)
            if (std::fabs(at(r, c)) > std::fabs(at(best, c))) best = r;
        pivot_[c] = best;
        if (best != c)
            for (std::size_t j = c; j <= last; ++j) std::swap(at(best, j), at(c, j));
        if (!(std::fabs(at(c, c)) > 0)) {
            is_regular_ = false;
            return;
        }
        for (std::size_t r = c + 1; r <= last_row; ++r) {
            const double factor = at(r, c) / at(c, c);
            at(r, c) = factor;
            for (std::size_t j = c + 1; j <= last; ++j) at(r, j) -= factor * at(c, j);
        }
    }
}

PerEvent<Vec2> ChainHessian::solve(std::span<const Vec2> right) const {
    TRILENS_CHECK(is_regular_ && 2 * right.size() == size_, "a regular system of this size");
    Few<double, 2 * kFewEvents> x(size_);
    for (std::size_t i = 0; i < size_; ++i) x[i] = right[i / 2][static_cast<int>(i % 2)];
    for (std::size_t c = 0; c < size_; ++c) {
        std::swap(x[c], x[pivot_[c]]);
        for (std::size_t r = c + 1; r < std::min(size_, c + 4); ++r) x[r] -= at(r, c) * x[c];
    }
    for (std::size_t r = size_; r-- > 0;) {
        for (std::size_t c = r + 1; c < std::min(size_, r + 7); ++c) x[r] -= at(r, c) * x[c];
        x[r] /= at(r, r);
    }
    PerEvent<Vec2> solution;
    for (std::size_t i = 0; i < right.size(); ++i) solution.push_back({x[2 * i], x[2 * i + 1]});
    return solution;
}

PathSensitivity::PathSensitivity(const PathChain& chain, std::span<const SurfacePoint> points,
                                 const std::array<Vec3, 2>& slope) {
    const ChainBend bend = chain_bend(chain, points);
    is_light_ = chain_residual(bend, points) <= chain_floor(chain, bend, points);
    const ChainHessian hessian(chain, bend, points);
    is_regular_ = hessian.is_regular();
    if (!is_regular_) return;
    const std::size_t count = points.size();
    by_surface_.resize(count);
    by_index_.resize(count + 1);
    for (std::size_t axis = 0; axis < 2; ++axis) {
        PerEvent<Vec2> right(count, Vec2(0));
        right[0] = {dot(slope[axis], points[0].du), dot(slope[axis], points[0].dv)};
        const PerEvent<Vec2> lambda = hessian.solve(right);
        Few<Vec3, kFewEvents + 2> yields(count + 2, Vec3(0));
        for (std::size_t i = 0; i < count; ++i) {
            yields[i + 1] = lambda[i].x * points[i].du + lambda[i].y * points[i].dv;
            by_surface_[i].du[axis] = -lambda[i].x * bend.bend[i];
            by_surface_[i].dv[axis] = -lambda[i].y * bend.bend[i];
        }
        follow(axis, chain, bend, yields);
        by_surface_[0].position[axis] += slope[axis];
    }
}

/// lambda . dF is the sum over events of y_i . dg_i, where y_i = lambda_i . (du, dv) and no end yields. Of a
/// stretch of index n both its events have a part: it is n de . (y_after - y_before), and
/// de = (1 - e e^T) (dP_after - dP_before) / l. The image moves by as much the other way.
void PathSensitivity::follow(std::size_t axis, const PathChain& chain, const ChainBend& bend,
                             std::span<const Vec3> yields) {
    const std::size_t last = by_surface_.size();
    Vec3 before(0);
    for (std::size_t s = 0; s <= last; ++s) {
        const Vec3 gap = yields[s + 1] - yields[s];
        const double index = index_along(chain, s);
        by_index_[s][static_cast<int>(axis)] = -dot(bend.way[s], gap);
        const Vec3 pull = turn_of_way(index / bend.length[s], bend.way[s], gap);
        if (s > 0) by_surface_[s - 1].position[axis] = pull - before;
        // At infinity it is the way itself that turns.
        if (s == 0) by_eye_[axis] = chain.eye.is_direction ? -turn_of_way(index, bend.way[s], gap) : pull;
        if (s == last)
            by_point_[axis] = -(chain.point.is_direction ? turn_of_way(index, bend.way[s], gap) : pull);
        before = pull;
    }
}

Vec2 PathSensitivity::by_surface(std::size_t event, const SurfacePoint& before,
                                 const SurfacePoint& after) const {
    const BySurface& by = by_surface_[event];
    const Vec3 position = after.position - before.position, du = after.du - before.du,
               dv = after.dv - before.dv;
    return {dot(by.position[0], position) + dot(by.du[0], du) + dot(by.dv[0], dv),
            dot(by.position[1], position) + dot(by.du[1], du) + dot(by.dv[1], dv)};
}

namespace {

/// One iterate of Newton's method.
struct ChainIterate {
    ChainShape shape;
    ChainBend bend;
    double residual = std::numeric_limits<double>::infinity();
};

ChainIterate iterate_at(const PathChain& chain, std::span<const SurfaceParameter> at) {
    ChainIterate iterate;
    iterate.shape = shape_at(chain, at);
    iterate.bend = chain_bend(chain, iterate.shape.points);
    iterate.residual = chain_residual(iterate.bend, iterate.shape.points);
    return iterate;
}

/// The parameters after a step, each kept on its face or carried over to the next one.
PerEvent<SurfaceParameter> stepped(const PathChain& chain, const ChainIterate& now,
                                   std::span<const Vec2> step, const FindParameter& find) {
    PerEvent<SurfaceParameter> at = now.shape.at;
    for (std::size_t i = 0; i < at.size(); ++i) {
        const Vec2 wanted = at[i].uv + step[i];
        const Vec2 uv = clamped_to(chain.events[i].surface->domain(at[i].face), wanted);
        at[i].uv = uv;
        if (uv == wanted || !find) continue;
        // From the eye along the path's first stretch, as seen in the tangent plane; else from the event
        // before.
        const SurfacePoint& p = now.shape.points[i];
        const Vec3 towards = p.position + step[i].x * p.du + step[i].y * p.dv;
        const Vec3 from = std::isinf(now.bend.length[i]) ? towards - now.bend.way[i]
                                                         : p.position - now.bend.length[i] * now.bend.way[i];
        if (const auto found = find({i, at[i], from, towards})) at[i] = *found;
    }
    return at;
}

double largest_step(std::span<const Vec2> step) {
    double most = 0;
    for (const Vec2& s : step) most = std::max({most, std::fabs(s.x), std::fabs(s.y)});
    return most;
}

}  // namespace

std::optional<ChainShape> solve_chain(const PathChain& chain, std::span<const SurfaceParameter> start,
                                      const FindParameter& find) {
    TRILENS_CHECK(!chain.events.empty() && start.size() == chain.events.size(), "a start for each event");
    ChainIterate now = iterate_at(chain, start);
    bool solved = false;
    for (int i = 0; i < kMostChainSteps && std::isfinite(now.residual); ++i) {
        const bool was_solved = now.residual <= chain_floor(chain, now.bend, now.shape.points);
        const ChainHessian hessian(chain, now.bend, now.shape.points);
        if (!hessian.is_regular()) break;
        PerEvent<Vec2> law = chain_law(now.bend, now.shape.points);
        for (Vec2& f : law) f = -f;
        PerEvent<Vec2> step = hessian.solve(law);
        double size = largest_step(step);
        if (!std::isfinite(size)) break;
        if (size > kChainReach) {
            for (Vec2& s : step) s *= kChainReach / size;
            size = kChainReach;
        }
        // One more step after the law holds, for what the tolerance leaves; kept where it is no worse.
        bool fell = false;
        for (int h = 0; h < kMostHalvings && !fell; ++h) {
            ChainIterate next = iterate_at(chain, stepped(chain, now, step, find));
            fell = next.residual < now.residual;
            if (fell) now = std::move(next);
            if (was_solved) break;
            for (Vec2& s : step) s *= 0.5;
        }
        solved = was_solved || (size < kChainParameterStep && now.residual < 1e-9);
        if (solved || !fell) break;
    }
    if (!solved || !chain_sides_fit(chain, now.bend, now.shape.points)) return std::nullopt;
    return std::move(now.shape);
}

}  // namespace trilens
