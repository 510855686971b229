// The samples and facets of one face's grid, as (u, v): the same for all faces with the same domain and
// seams.
#pragma once

#include <array>
#include <vector>

#include "base/raymesh/surface.h"

namespace trilens {

/// Samples of a face: the lattice of n steps per side, and on each split side the middles between them.
///
/// A side is split where its edge meets two sub-faces of an n-gon on the other side: they bring 2n segments
/// to it.
class Lattice {
  public:
    Lattice(FaceDomain domain, int n, const std::array<bool, 4>& split);

    const std::vector<Vec2>& uv() const { return uv_; }
    int side_count() const { return domain_ == FaceDomain::kSquare ? 4 : 3; }
    /// The samples along side k from its first to its second corner: n + 1, or 2n + 1 where split.
    std::vector<int> side(int k) const;
    /// Two triangles per square, cut along its shorter diagonal in the world (a tie: from (0,0) to (1,1)); a
    /// square on a split side is a fan around the first middle on its border. `positions`: one per sample.
    std::vector<std::array<int, 3>> facets(const std::vector<Vec3>& positions) const;

  private:
    int at(int i, int j) const;
    int side_at(int k, int step) const;
    void add_square(int i, int j, const std::vector<Vec3>& positions,
                    std::vector<std::array<int, 3>>& facets) const;

    FaceDomain domain_;
    int n_;
    std::array<int, 4> first_middle_{-1, -1, -1, -1};  // per side: its middles' first sample; -1: not split
    std::vector<Vec2> uv_;
};

}  // namespace trilens
