// What two pictures show through their optics, layer by layer: the same things, and in the same places?
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/util/ids.h"
#include "measure/displacement/displacement.h"

namespace trilens {

/// Counts of pixels. Each mismatching pixel is in exactly one of the three.
struct SeenMismatch {
    std::size_t pixels = 0;              // at least one of the images sees something
    std::size_t coverage_mismatch = 0;   // one sees something, the other nothing (4294967295)
    std::size_t object_mismatch = 0;     // both see something, but different objects
    std::size_t primitive_mismatch = 0;  // both see the same object, but different triangles of it
};

/// Compares the objects and triangles that `layer` shows ("reflect", "refract"; for "optic", which has no
/// triangles, only objects). `mask_object` as in CompareOptions. Nothing where the images have no such layer.
/// Throws InputError where they cannot be compared.
std::optional<SeenMismatch> compare_seen(const Image& reference, const Image& test, const std::string& layer,
                                         std::optional<Id> mask_object = std::nullopt);

/// One layer of both images.
struct LayerComparison {
    std::string layer;  // "reflect", "refract", "direct"
    std::optional<SeenMismatch> seen;
    std::optional<Displacement> displacement;
};

/// The layers that the reference has. Throws InputError where the images cannot be compared.
std::vector<LayerComparison> compare_layers(const Image& reference, const Image& test,
                                            const DisplacementOptions& options = {});

/// Adds the shifts of every layer that shows something to the difference of the same two images (add_shift,
/// and its errors).
void add_shifts(const std::vector<LayerComparison>& layers, Image& difference);

/// Sums over the layers.
SeenMismatch total_seen(const std::vector<LayerComparison>& layers);

/// The displacement of the layer `asked`, where it was measured; else that of all layers that show something,
/// together: statistics over the found pixels of all, counts added up, without places by pixel. Unset numbers
/// where none does.
Displacement total_displacement(const std::vector<LayerComparison>& layers, const std::string& asked);

}  // namespace trilens
