#include "render/world/volume_geometry.h"

#include <utility>

namespace trilens {

VolumeGeometry::VolumeGeometry(std::shared_ptr<const TetMesh> cells)
    : cells_(std::move(cells)), gradients_(cells_->cells.size()) {
    parallel_for(gradients_.size(), 4096, [&](std::size_t from, std::size_t to) {
        for (std::size_t c = from; c < to; ++c) gradients_[c] = scalar_gradient(*cells_, static_cast<Id>(c));
    });
}

const CellFaces& VolumeGeometry::faces() const {
    return faces_.get([this] {
        std::size_t crowded = 0;
        return std::make_unique<CellFaces>(find_faces(*cells_, crowded));
    });
}

const PreparedScene& VolumeGeometry::prepared_faces() const {
    return prepared_.get([this] { return std::make_unique<PreparedScene>(faces().triangles); });
}

const BoxTree& VolumeGeometry::cell_boxes() const {
    return boxes_.get([this] {
        std::vector<Box> boxes(cells_->cells.size());
        for (std::size_t c = 0; c < boxes.size(); ++c) boxes[c] = cell_box(*cells_, static_cast<Id>(c));
        return std::make_unique<BoxTree>(boxes);
    });
}

}  // namespace trilens
