// A cage after the gate: every index in range, every face a simple polygon, every tag on something that
// exists; and numbers for its edges.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/description/optic_description.h"
#include "base/raymesh/surface.h"
#include "base/util/error.h"

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

// Numbers for edges: the same for every face that runs along the same two ends, in either direction.

/// Hands out edge ids 0, 1, ... in the order in which edges are first asked for. An edge's own direction is
/// from its smaller to its larger end.
class EdgeNumbers {
  public:
    /// The whole edge as a side that runs from one end to the other; no edge where the ends are the same.
    FaceSide side(Id from, Id to) {
        if (from == to) return {};
        const std::uint64_t key = (std::uint64_t{std::min(from, to)} << 32) | std::max(from, to);
        const Id edge = number_.try_emplace(key, static_cast<Id>(number_.size())).first->second;
        return {edge, FaceSide::Part::kWhole, from > to};
    }
    Id size() const { return static_cast<Id>(number_.size()); }

  private:
    std::unordered_map<std::uint64_t, Id> number_;
};

}  // namespace trilens
