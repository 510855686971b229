// The mesh that limit patches are made of: the cage after as many uniform refinements as patches need, and
// its small faces as trees over (u, v).
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "base/math/box.h"
#include "base/math/vec.h"
#include "surfaces/checked_cage.h"

namespace trilens {

// A few levels of uniform refinement as a tree: from a face's (u, v) to the small face that holds it.

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

/// Uniform refinements before the patches plus adaptive ones inside them: the most that OpenSubdiv's patch
/// parameters can hold (ten bits).
inline constexpr int kDeepest = 10;

/// Bytes of patches and of the trees that they share that are kept at most, but for a few at a time.
inline constexpr std::size_t kMostPatchBytes = std::size_t{576} << 20;

struct PatchMesh {
    FaceTree tree;             // the uniform refinements
    std::vector<Vec3> points;  // of the last level
    /// The last level alone: an OpenSubdiv::Far::TopologyRefiner, whose header no header here may show.
    std::shared_ptr<const void> refiner;

    int levels() const { return static_cast<int>(tree.levels.size()); }
    /// What it holds: the arrays here, and OpenSubdiv's as counted from its headers.
    std::size_t bytes() const;
};

/// Per face of the last level a box around it and the faces that touch it: the control points of its limit
/// surface, whose weights are not negative and add up to one (Catmull and Clark 1978, Loop 1987), so it lies
/// within.
std::vector<Box> face_hulls_of(const PatchMesh& mesh);

/// Throws InputError(name, ...) where OpenSubdiv refuses the topology, and, before anything large is made,
/// where the limit surface needs more than `memory` bytes. cage.face_count() > 0.
PatchMesh make_patch_mesh(const CheckedCage& cage, const std::string& name, double memory);

}  // namespace trilens
