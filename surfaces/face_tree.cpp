// Walks down the levels of uniform refinement.
#include "surfaces/face_tree.h"

#include <cstddef>

namespace trilens {
namespace {

/// The child of a quad that holds (u, v), which becomes the child's own.
int enter_child_quad(Vec2& uv) {
    const bool right = uv.x >= 0.5, upper = uv.y >= 0.5;
    uv = 2.0 * uv - Vec2(right ? 1 : 0, upper ? 1 : 0);
    if (upper) return right ? 2 : 3;
    return right ? 1 : 0;
}

int enter_child_triangle(Vec2& uv, double& scale) {
    const double u = uv.x, v = uv.y;
    if (u >= 0.5) {
        uv = Vec2(2 * u - 1, 2 * v);
        return 1;
    }
    if (v >= 0.5) {
        uv = Vec2(2 * u, 2 * v - 1);
        return 2;
    }
    if (u + v <= 0.5) {
        uv = Vec2(2 * u, 2 * v);
        return 0;
    }
    uv = Vec2(1 - 2 * u, 1 - 2 * v);
    scale = -scale;
    return 3;
}

}  // namespace

FaceTree::Leaf FaceTree::leaf(int face, int sub_face, const Vec2& uv) const {
    Leaf leaf{face, uv, 1};
    std::size_t level = 0;
    if (sub_face >= 0) leaf.face = levels[level++](face, sub_face);
    for (; level < levels.size(); ++level) {
        const int child = triangles ? enter_child_triangle(leaf.uv, leaf.scale) : enter_child_quad(leaf.uv);
        leaf.face = levels[level](leaf.face, child);
        leaf.scale *= 2;
    }
    return leaf;
}

}  // namespace trilens
