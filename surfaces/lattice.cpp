// Numbering of a face's samples, and the facets between them.
#include "surfaces/lattice.h"

#include <algorithm>
#include <cstddef>

namespace trilens {
namespace {

/// A diagonal counts as shorter by at least this share of squared length, so that rounding does not decide
/// ties.
constexpr double kShorter = 1e-9;

double squared_distance(const Vec3& a, const Vec3& b) {
    return dot(a - b, a - b);
}

}  // namespace

Lattice::Lattice(FaceDomain domain, int n, const std::array<bool, 4>& split) : domain_(domain), n_(n) {
    const double steps = n;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= (domain == FaceDomain::kSquare ? n : n - j); ++i)
            uv_.emplace_back(i / steps, j / steps);
    for (int k = 0; k < side_count(); ++k) {
        if (!split[static_cast<std::size_t>(k)]) continue;
        first_middle_[static_cast<std::size_t>(k)] = static_cast<int>(uv_.size());
        for (int step = 0; step < n; ++step)
            uv_.push_back(0.5 * (uv_[side_at(k, step)] + uv_[side_at(k, step + 1)]));
    }
}

int Lattice::at(int i, int j) const {
    return domain_ == FaceDomain::kSquare ? j * (n_ + 1) + i : j * (n_ + 1) - j * (j - 1) / 2 + i;
}

int Lattice::side_at(int k, int step) const {
    if (domain_ == FaceDomain::kTriangle)
        return k == 0 ? at(step, 0) : k == 1 ? at(n_ - step, step) : at(0, n_ - step);
    return k == 0 ? at(step, 0) : k == 1 ? at(n_, step) : k == 2 ? at(n_ - step, n_) : at(0, n_ - step);
}

std::vector<int> Lattice::side(int k) const {
    std::vector<int> samples;
    for (int step = 0; step <= n_; ++step) {
        samples.push_back(side_at(k, step));
        const int middles = first_middle_[static_cast<std::size_t>(k)];
        if (middles >= 0 && step < n_) samples.push_back(middles + step);
    }
    return samples;
}

void Lattice::add_square(int i, int j, const std::vector<Vec3>& positions,
                         std::vector<std::array<int, 3>>& facets) const {
    const std::array<int, 4> corner = {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
    // Per side of the square: the middle on it, if it lies on a split side of the face.
    const auto middle = [this](int k, bool on_border, int step) {
        const int first = first_middle_[static_cast<std::size_t>(k)];
        return on_border && first >= 0 ? first + step : -1;
    };
    const std::array<int, 4> middles = {middle(0, j == 0, i), middle(1, i == n_ - 1, j),
                                        middle(2, j == n_ - 1, n_ - 1 - i), middle(3, i == 0, n_ - 1 - j)};

    // The border of the square, begun at the point that all facets share.
    std::vector<int> border;
    std::size_t begin = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        border.push_back(corner[k]);
        if (middles[k] < 0) continue;
        if (begin == 0) begin = border.size();
        border.push_back(middles[k]);
    }
    if (begin == 0) {
        const double from_first = squared_distance(positions[corner[0]], positions[corner[2]]);
        const double from_second = squared_distance(positions[corner[1]], positions[corner[3]]);
        begin = from_second < from_first * (1 - kShorter) ? 1 : 0;
    }
    std::rotate(border.begin(), border.begin() + static_cast<std::ptrdiff_t>(begin), border.end());
    for (std::size_t k = 1; k + 1 < border.size(); ++k)
        facets.push_back({border[0], border[k], border[k + 1]});
}

std::vector<std::array<int, 3>> Lattice::facets(const std::vector<Vec3>& positions) const {
    std::vector<std::array<int, 3>> facets;
    for (int j = 0; j < n_; ++j) {
        if (domain_ == FaceDomain::kSquare) {
            for (int i = 0; i < n_; ++i) add_square(i, j, positions, facets);
            continue;
        }
        for (int i = 0; i < n_ - j; ++i) {
            facets.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
            if (i + 1 < n_ - j) facets.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return facets;
}

}  // namespace trilens
