#include "trilinear/slices.h"

#include <algorithm>

#include "base/util/check.h"

namespace trilens {

std::vector<ImageVertex> slice_ends(const Coplanarity& facet, const SceneTriangle& triangle, std::size_t edge,
                                    Stretch stretch, int pieces) {
    TRILENS_CHECK(pieces >= 1, "a stretch has at least one piece");
    const double low = std::min(stretch.from, stretch.to), high = std::max(stretch.from, stretch.to);
    std::vector<ImageVertex> ends;
    for (int k = 1; k < pieces; ++k) {
        const double t = low + (high - low) * k / pieces;
        if (!(t > low && t < high)) continue;
        if (const auto end = edge_cut(facet, triangle, edge, t)) ends.push_back(*end);
    }
    if (stretch.from > stretch.to) std::reverse(ends.begin(), ends.end());
    return ends;
}

}  // namespace trilens
