// Scene triangle tessellation (Vallance 2005, section 4.3).
#include "trilinear/tessellate.h"

#include "base/util/check.h"

namespace trilens {

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
