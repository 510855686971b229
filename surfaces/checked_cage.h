// A cage after the gate: every index in range, every face a simple polygon, every tag on something that
// exists.
#pragma once

#include <string>
#include <vector>

#include "base/description/cage.h"
#include "base/util/progress.h"

namespace trilens {

/// What subdivision works on. Face f has the corners vertices[first[f]] .. vertices[first[f + 1] - 1], all
/// different.
struct CheckedCage {
    std::vector<Vec3> points;
    std::vector<int> first{0};  // one entry per face, and the end
    std::vector<int> vertices;
    std::vector<int> crease_vertices;  // two per crease edge; each is an edge of some face
    std::vector<float> crease_sharpness;
    std::vector<int> corner_vertices;
    std::vector<float> corner_sharpness;
    std::vector<int> holes;  // faces, ascending
    SubdivisionScheme scheme = SubdivisionScheme::kCatmullClark;
    InterpolateBoundary interpolate_boundary = InterpolateBoundary::kEdgeAndCorner;

    int face_count() const { return static_cast<int>(first.size()) - 1; }
    int face_size(int face) const { return first[face + 1] - first[face]; }
};

/// Faces have at most this many corners.
inline constexpr int kMostCorners = 255;
/// From this sharpness on a crease or corner is infinitely sharp (UsdGeomMesh, OpenSubdiv).
inline constexpr float kInfiniteSharpness = 10;

/// The cage ready for subdivision. Throws InputError(name, field, ...) where the cage cannot be used at all.
/// Told to `warn` and repaired: corners that a face repeats in a row (one is kept), faces that still visit a
/// vertex twice or have fewer than three corners left (left out), under Loop triangles on the same three
/// vertices (the first is kept: refined, two of them share an edge twice), creases along no edge (left out).
CheckedCage check_cage(const Cage& cage, const std::string& name, const Warn& warn);

}  // namespace trilens
