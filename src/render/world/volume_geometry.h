// A volume's cells made ready for rays: gradients, faces for the projector, boxes for Embree.
#pragma once

#include <memory>
#include <vector>

#include "base/util/parallel.h"
#include "intersect/box_tree.h"
#include "projector/projector.h"
#include "volume/cell_faces.h"

namespace trilens {

/// Trees are built when first asked for. Thread-safe to read.
class VolumeGeometry {
  public:
    explicit VolumeGeometry(std::shared_ptr<const TetMesh> cells);

    const TetMesh& cells() const { return *cells_; }
    const std::vector<Vec3>& gradients() const { return gradients_; }  // per cell

    /// For the projector.
    const CellFaces& faces() const;
    const PreparedScene& prepared_faces() const;
    /// For rays: a box of each cell.
    const BoxTree& cell_boxes() const;

  private:
    std::shared_ptr<const TetMesh> cells_;
    std::vector<Vec3> gradients_;
    Lazy<CellFaces> faces_;
    Lazy<PreparedScene> prepared_;
    Lazy<BoxTree> boxes_;
};

}  // namespace trilens
