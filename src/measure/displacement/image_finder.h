// What searches ask of a reference image, made once for many tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/math/vec.h"
#include "measure/field/field_pyramid.h"
#include "measure/field/position_field.h"
#include "measure/pixel/flip.h"

namespace trilens {

/// Of one image, which must outlive it: its layers' indices, and what FLIP makes of its beauty, each made
/// when it is first asked for. Thread-safe.
class ReferenceLayers {
  public:
    struct Layer {
        FieldPyramid index;
        std::vector<std::uint8_t> near_folds;                  // of position_field.h
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

// Finds where a reference image shows what the pixels of another see, each nearest to its pixel.

/// Two fields of one size, each with its index, which must outlive it. Its search may be called by many
/// threads.
class ImageFinder {
  public:
    /// `test`: the field that points are looked for from; it guides the reference beyond its borders. `kept`:
    /// where given, bounds that depend on the reference alone, one for each of its cells, for many finders.
    ImageFinder(const FieldPyramid& reference, const FieldPyramid& test,
                LazyValues<FieldCellBounds>* kept = nullptr)
        : reference_(reference), test_(test), kept_(kept), reaches_(reference.cell_count()) {}

    /// For each point that `test` sees, the screen vector from its pixel to the nearest place where the
    /// reference shows it; nothing where there is none. A place more than `reach` pixels away need not be
    /// found. Pixels of the point's own triangle are preferred to others of its object. Where the reference
    /// shows nearly the point at the pixel or next to it, but cannot say where, a place farther away than the
    /// slopes there allow is another image of the point (a curved mirror may show it several times) and no
    /// answer. Points of neighbouring pixels are found fastest together; an answer does not depend on which.
    std::vector<std::optional<Vec2>> find(std::span<const FieldSample> wanted, double reach) const;

    /// The bounds of a cell of the reference, made when it is first asked for.
    const FieldCellBounds& reach_of(int column, int row) const;

    const FieldPyramid& reference() const { return reference_; }
    const FieldPyramid& test() const { return test_; }

  private:
    const FieldPyramid &reference_, &test_;
    LazyValues<FieldCellBounds>* kept_;
    mutable LazyValues<FieldCellBounds> reaches_;
};

}  // namespace trilens
