// Krawczyk's operator and Newton's method on the laws of a chain of events.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "base/linear_camera.h"
#include "base/surface.h"
#include "camera/specular_bounds.h"
#include "camera/specular_cells.h"

namespace trilens {

/// One cell of a box, with the event on it.
struct ChainCell {
    const Surface* surface = nullptr;
    CellBox box;
    const SurfaceBounds* bounds = nullptr;
    double before = 1, after = 1;  // refractive indices of the ways that arrive and leave, from the eye
};
using ChainCells = std::vector<ChainCell>;

enum class ChainVerdict { kEmpty, kOneAtMost, kUnknown };

/// A zero of all laws in the box.
struct ChainZero {
    std::vector<Vec3> positions;
    bool is_in_domain = true;  // of its faces; else of faces continued
};

/// Of the system F_i = (g . du, g . dv), g = n e - n' e' the bend at event i, whose matrix is the Hessian of
/// the optical path: symmetric, block tridiagonal.
class ChainKrawczyk {
  public:
    /// `sights`: the ways between eye, cells and point, one more than there are cells.
    ChainKrawczyk(const ChainCells& cells, std::span<const Sight> sights);

    ChainVerdict verdict() const { return verdict_; }

    /// Newton's method from the box's middle; none where it does not come to rest in the box.
    std::optional<ChainZero> find_zero(const LinearCamera& camera, const Vec3& point) const;

  private:
    const ChainCells& cells_;
    std::vector<double> step_;
    ChainVerdict verdict_ = ChainVerdict::kUnknown;
};

}  // namespace trilens
