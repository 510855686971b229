// A few levels of uniform refinement as a tree: from a face's (u, v) to the small face that holds it.
#pragma once

#include <vector>

#include "base/math/vec.h"

namespace trilens {

/// The children of the faces of one level: child k of face f is child[first[f] + k], in OpenSubdiv's order.
/// Quads have a child per corner, with their parent's directions; other polygons a child per corner that
/// starts there; triangles a child per corner and one in the middle, turned by half a turn.
struct FaceChildren {
    std::vector<int> first;  // one entry per face, and the end
    std::vector<int> child;

    int operator()(int face, int k) const { return child[first[face] + k]; }
    int count(int face) const { return first[face + 1] - first[face]; }
};

struct FaceTree {
    bool triangles = false;
    std::vector<FaceChildren> levels;  // empty: every face is its own leaf

    /// A face of the last level, (u, v) in it, and the derivative of that (u, v) by the one given.
    struct Leaf {
        int face;
        Vec2 uv;
        double scale;
    };
    /// sub_face: the child of the first level whose (u, v) is given, or -1 for the face's own (u, v).
    Leaf leaf(int face, int sub_face, const Vec2& uv) const;
};

}  // namespace trilens
