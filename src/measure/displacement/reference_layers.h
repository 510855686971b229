// What searches ask of a reference image, made once for many tests.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "measure/field/field_cell_bounds.h"
#include "measure/field/field_pyramid.h"
#include "measure/pixel/flip.h"

namespace trilens {

/// Of one image, which must outlive it: its layers' indices, and what FLIP makes of its beauty, each made
/// when it is first asked for. Thread-safe.
class ReferenceLayers {
  public:
    struct Layer {
        FieldPyramid index;
        std::vector<std::uint8_t> near_folds;                  // of folds.h
        std::unique_ptr<LazyValues<FieldCellBounds>> reaches;  // as ImageFinder keeps them
    };

    explicit ReferenceLayers(const Image& image) : image_(image) {}

    const Image& image() const { return image_; }
    /// Null where the image lacks the layer's objects or places.
    std::shared_ptr<const Layer> get(const std::string& layer) const;
    FlipReference& flip() const { return flip_; }

  private:
    const Image& image_;
    mutable FlipReference flip_;
    mutable std::mutex mutex_;
    mutable std::map<std::string, std::shared_ptr<const Layer>> layers_;
};

}  // namespace trilens
