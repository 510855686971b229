// Parametric triangle slices (Vallance 2005, section 4.4).
#include "trilinear/slices.h"

#include <algorithm>

#include "base/check.h"

namespace trilens {

std::vector<double> slice_levels(const Shape& shape, int pieces) {
    TRILENS_CHECK(pieces >= 1, "a stretch has at least one piece");
    std::vector<double> t;
    for (const ShapeVertex& vertex : shape) t.push_back(vertex.at.t);
    std::sort(t.begin(), t.end());
    std::vector<double> levels;
    for (std::size_t i = 0; i + 1 < t.size(); ++i) {
        for (int k = 1; k < pieces; ++k) levels.push_back(t[i] + (t[i + 1] - t[i]) * k / pieces);
    }
    return levels;
}

std::vector<ImageVertex> slice_ends(const Coplanarity& facet, const SceneTriangle& triangle, std::size_t edge,
                                    const std::vector<double>& levels, Stretch stretch) {
    std::vector<ImageVertex> ends;
    const double low = std::min(stretch.from, stretch.to), high = std::max(stretch.from, stretch.to);
    for (const double t : levels) {
        if (!(t > low && t < high)) continue;
        if (const auto end = edge_cut(facet, triangle, edge, t)) ends.push_back(*end);
    }
    if (stretch.from > stretch.to) std::reverse(ends.begin(), ends.end());
    return ends;
}

}  // namespace trilens
