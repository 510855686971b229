// Bounds of the second derivatives of the optical path over boxes, and Krawczyk's operator.
#include "specular/chain/path_chain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "base/util/check.h"
#include "specular/chain/sight.h"

namespace trilens {
namespace {

constexpr double kMatrixRounding = 64 * std::numeric_limits<double>::epsilon();
constexpr double kMostSpread = 0.5;  // of a box's half sides, as newton_bounds' users ask

/// What is known of one event over its box.
struct EventReach {
    std::array<Reach, 2> tangent;
    std::array<Reach, 3> second;  // uu, uv, vv
};

EventReach reach_of(const SurfaceBounds& bounds) {
    const SurfacePoint& m = bounds.middle;
    return {{Reach::of(m.du, bounds.du_radius), Reach::of(m.dv, bounds.dv_radius)},
            {Reach::of(m.duu, bounds.duu_radius), Reach::of(m.duv, bounds.duv_radius),
             Reach::of(m.dvv, bounds.dvv_radius)}};
}

/// The chain over its boxes: all that the operator is made of.
struct BoundedChain {
    const PathChain& chain;
    const ChainBox& box;
    std::vector<SurfacePoint> middle;
    std::vector<EventReach> reach;
    std::vector<Sight> sight;  // of each stretch, from the eye on

    bool find_sights();
    bool sides_are_known() const;
    double coordinate(std::size_t event) const;
};

/// False where a stretch may have no length.
bool BoundedChain::find_sights() {
    const std::size_t k = middle.size();
    sight.resize(k + 1);
    for (std::size_t i = 0; i <= k; ++i) {
        const ChainEnd* const end = i == 0 ? &chain.eye : i == k ? &chain.point : nullptr;
        if (end && end->is_direction) {
            sight[i].direction = end->place;
            continue;
        }
        const Vec3& from = i == 0 ? chain.eye.place : middle[i - 1].position;
        const Vec3& to = i == k ? chain.point.place : middle[i].position;
        const double radius =
            (i == 0 ? 0 : box.bounds[i - 1].position_radius) + (i == k ? 0 : box.bounds[i].position_radius);
        if (!sight_from(from, radius, to, sight[i])) return false;
    }
    return true;
}

/// Whether everywhere in the boxes each event leaves light on the side that its kind says.
bool BoundedChain::sides_are_known() const {
    for (std::size_t i = 0; i < middle.size(); ++i) {
        const double normals = box.bounds[i].normal_radius;
        const double before = dot(sight[i].direction, middle[i].normal),
                     after = dot(sight[i + 1].direction, middle[i].normal);
        if (!(normals < 1) || !(std::fabs(before) > sight[i].turn + normals) ||
            !(std::fabs(after) > sight[i + 1].turn + normals))
            return false;
        if ((before * after < 0) != chain.events[i].reflects) return false;
    }
    return true;
}

/// The largest of an event and its neighbours: what their differences round by.
double BoundedChain::coordinate(std::size_t event) const {
    double largest = largest_coordinate(middle[event].position);
    const auto include = [&](const Vec3& place) { largest = std::max(largest, largest_coordinate(place)); };
    if (event > 0)
        include(middle[event - 1].position);
    else if (!chain.eye.is_direction)
        include(chain.eye.place);
    if (event + 1 < middle.size())
        include(middle[event + 1].position);
    else if (!chain.point.is_direction)
        include(chain.point.place);
    return largest;
}

std::vector<double> radii_of(const BoundedChain& known) {
    const ChainBend bend = chain_bend(known.chain, known.middle);
    const std::size_t k = known.middle.size(), size = 2 * k;
    std::vector<double> radii(size * size, 0.0);
    for (std::size_t i = 0; i < k; ++i) {
        const ChainEvent& event = known.chain.events[i];
        const Sight &before = known.sight[i], &after = known.sight[i + 1];
        const double n_before = event.index_before, n_after = event.index_after;
        const double turn = n_before * before.turn + n_after * after.turn,
                     size_of_bend = length(bend.bend[i]);
        const EventReach& own = known.reach[i];
        for (std::size_t a = 0; a < 2; ++a) {
            for (std::size_t b = 0; b < 2; ++b) {
                const Reach& second = own.second[a + b];
                radii[(2 * i + a) * size + 2 * i + b] =
                    n_before * turning_radius(before, before.stretch(), own.tangent[a], own.tangent[b]) +
                    n_after * turning_radius(after, after.stretch(), own.tangent[a], own.tangent[b]) +
                    turn * second.all + size_of_bend * second.radius;
                if (i + 1 == k) continue;
                radii[(2 * i + a) * size + 2 * i + 2 + b] = radii[(2 * i + 2 + b) * size + 2 * i + a] =
                    n_after *
                    turning_radius(after, after.stretch(), own.tangent[a], known.reach[i + 1].tangent[b]);
            }
        }
    }
    return radii;
}

/// What rounding leaves of the law at the middle, two numbers per event.
std::vector<double> law_rounding(const BoundedChain& known) {
    std::vector<double> rounding;
    for (std::size_t i = 0; i < known.middle.size(); ++i) {
        const ChainEvent& event = known.chain.events[i];
        const Sight &before = known.sight[i], &after = known.sight[i + 1];
        const double coordinate = known.coordinate(i);
        const double of_way =
            rounding_of_way(event.index_before, before.by_distance + before.stretch(), coordinate) +
            rounding_of_way(event.index_after, after.by_distance + after.stretch(), coordinate);
        for (const Reach& tangent : known.reach[i].tangent) rounding.push_back(of_way * tangent.all);
    }
    return rounding;
}

/// The matrix's inverse, row by row, as far as elimination finds it.
std::vector<double> inverse_of(const ChainHessian& hessian, std::size_t size) {
    std::vector<double> inverse(size * size);
    std::vector<Vec2> unit(size / 2, Vec2(0));
    for (std::size_t column = 0; column < size; ++column) {
        unit[column / 2][static_cast<int>(column % 2)] = 1;
        const PerEvent<Vec2> solved = hessian.solve(unit);
        unit[column / 2] = Vec2(0);
        for (std::size_t row = 0; row < size; ++row)
            inverse[row * size + column] = solved[row / 2][static_cast<int>(row % 2)];
    }
    return inverse;
}

/// A system of linear equations, its matrix known up to radii, and an approximate inverse.
struct BoundedSystem {
    std::size_t size = 0;
    ChainMatrix matrix;
    std::vector<double> radii, inverse;

    /// How far one row of inverse times matrix may be from that of the unit matrix, times the half sides.
    double spread(std::size_t row, std::span<const Vec2> half) const {
        double sum = 0;
        for (std::size_t j = 0; j < size; ++j) {
            double product = row == j ? -1 : 0, all = 0;
            for (std::size_t l = 0; l < size; ++l) {
                const double c = inverse[row * size + l], a = matrix[l * size + j];
                product += c * a;
                all += std::fabs(c) * (radii[l * size + j] + kMatrixRounding * std::fabs(a));
            }
            sum += (std::fabs(product) + all) * half[j / 2][static_cast<int>(j % 2)];
        }
        return sum;
    }
};

BoundedChain over_boxes(const PathChain& chain, const ChainBox& box) {
    const std::size_t k = chain.events.size();
    TRILENS_CHECK(box.bounds.size() == k && box.half.size() == k, "a box for each event");
    BoundedChain known{chain, box, {}, {}, {}};
    for (const SurfaceBounds& bounds : box.bounds) {
        known.middle.push_back(bounds.middle);
        known.reach.push_back(reach_of(bounds));
    }
    return known;
}

}  // namespace

std::vector<double> second_derivative_radii(const PathChain& chain, const ChainBox& box) {
    BoundedChain known = over_boxes(chain, box);
    return known.find_sights() ? radii_of(known) : std::vector<double>();
}

bool holds_one_path(const PathChain& chain, const ChainBox& box) {
    BoundedChain known = over_boxes(chain, box);
    if (!known.find_sights() || !known.sides_are_known()) return false;

    const ChainBend bend = chain_bend(chain, known.middle);
    const ChainHessian hessian(chain, bend, known.middle);
    if (!hessian.is_regular()) return false;
    const std::size_t size = 2 * chain.events.size();
    const BoundedSystem system{size, chain_second_derivatives(chain, bend, known.middle), radii_of(known),
                               inverse_of(hessian, size)};
    const PerEvent<Vec2> law = chain_law(bend, known.middle);
    const std::vector<double> rounding = law_rounding(known);

    // From the middle, every zero lies within spread + rounding of Newton's step; if that is inside the boxes
    // there is one.
    for (std::size_t row = 0; row < size; ++row) {
        double step = 0, rest = 0;
        for (std::size_t j = 0; j < size; ++j) {
            const double c = system.inverse[row * size + j];
            step -= c * law[j / 2][static_cast<int>(j % 2)];
            rest += std::fabs(c) * rounding[j];
        }
        const double spread = system.spread(row, box.half),
                     half = box.half[row / 2][static_cast<int>(row % 2)];
        if (!(spread < kMostSpread * half) || !(std::fabs(step) + spread + rest < half)) return false;
    }
    return true;
}

}  // namespace trilens
