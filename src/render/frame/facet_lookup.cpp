#include "render/frame/facet_lookup.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

/// A position this far outside of a facet, as a share of its height, is still in it.
constexpr double kOutside = 1e-9;
/// Facets reach further than that into the bins around them.
constexpr double kLookupReach = 1e-7;

bool holds(const std::array<Vec2, 3>& facet, const Vec2& uv) {
    const auto& [a, b, c] = facet;
    const auto side = [](const Vec2& p, const Vec2& q, const Vec2& r) {
        return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    };
    const double area = side(a, b, c);
    return area != 0 && side(a, b, uv) / area >= -kOutside && side(b, c, uv) / area >= -kOutside &&
           side(c, a, uv) / area >= -kOutside;
}

}  // namespace

std::size_t FacetLookup::cell_of(double x, const FaceBins& bins) const {
    const double last = static_cast<double>(bins.side - 1);
    return static_cast<std::size_t>(std::clamp(std::floor(x * static_cast<double>(bins.side)), 0.0, last));
}

template <typename Body>
void FacetLookup::for_each_bin(std::size_t facet, const Body& body) const {
    const FaceBins& bins = faces_[grid_.facet_face[facet]];
    const auto& [a, b, c] = grid_.facet_uv[facet];
    const Vec2 low = glm::min(a, glm::min(b, c)) - kLookupReach,
               high = glm::max(a, glm::max(b, c)) + kLookupReach;
    for (std::size_t y = cell_of(low.y, bins); y <= cell_of(high.y, bins); ++y)
        for (std::size_t x = cell_of(low.x, bins); x <= cell_of(high.x, bins); ++x)
            body(bins.first + y * bins.side + x);
}

FacetLookup::FacetLookup(const SurfaceGrid& grid, std::size_t faces) : grid_(grid), faces_(faces) {
    std::vector<std::size_t> count(faces, 0);
    for (const Id face : grid.facet_face) ++count[face];
    std::size_t bins = 0;
    for (std::size_t f = 0; f < faces; ++f) {
        const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(count[f]) / 2));
        faces_[f] = {bins, std::max<std::size_t>(side, 1)};
        bins += faces_[f].side * faces_[f].side;
    }
    begin_.assign(bins + 1, 0);
    for (std::size_t f = 0; f < grid.facets.size(); ++f)
        for_each_bin(f, [&](std::size_t bin) { ++begin_[bin + 1]; });
    for (std::size_t bin = 0; bin < bins; ++bin) begin_[bin + 1] += begin_[bin];
    facets_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t f = 0; f < grid.facets.size(); ++f)
        for_each_bin(f, [&](std::size_t bin) { facets_[next[bin]++] = static_cast<Id>(f); });
}

Id FacetLookup::at(Id face, const Vec2& uv) const {
    const FaceBins& bins = faces_[face];
    const std::size_t bin = bins.first + cell_of(uv.y, bins) * bins.side + cell_of(uv.x, bins);
    for (std::size_t k = begin_[bin]; k < begin_[bin + 1]; ++k)
        if (holds(grid_.facet_uv[facets_[k]], uv)) return facets_[k];
    return kNone;
}

}  // namespace trilens
