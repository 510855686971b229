#include "trilinear/curves.h"

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

// Scene triangle tessellation (Vallance 2005, section 4.3).

std::vector<TrianglePiece> tessellate(const SceneTriangle& triangle, int pieces) {
    TRILENS_CHECK(pieces >= 1, "a triangle has at least one piece");
    // Whole-number barycentrics: on an edge one term is zero and the sum of two does not depend on their
    // order.
    const auto at = [&](int i, int j) { return Vec3(pieces - i - j, i, j) / static_cast<double>(pieces); };
    std::vector<TrianglePiece> result;
    const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
        result.push_back({{{triangle.point(a), triangle.point(b), triangle.point(c)}}, {a, b, c}});
    };
    for (int i = 0; i < pieces; ++i) {
        for (int j = 0; i + j < pieces; ++j) {
            add(at(i, j), at(i + 1, j), at(i, j + 1));
            if (i + j + 1 < pieces) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
    return result;
}

}  // namespace trilens
