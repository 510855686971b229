// The mesh that limit patches are made of: the cage after as many uniform refinements as patches need.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "surfaces/checked_cage.h"
#include "surfaces/face_tree.h"

namespace trilens {

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

/// Throws InputError(name, ...) where OpenSubdiv refuses the topology, and, before anything large is made,
/// where the limit surface needs more than `memory` bytes. cage.face_count() > 0.
PatchMesh make_patch_mesh(const CheckedCage& cage, const std::string& name, double memory);

}  // namespace trilens
