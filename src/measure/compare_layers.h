// What two pictures show through their optics, layer by layer: the same things, and in the same places?
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "measure/displacement/displacement.h"
#include "measure/displacement/seen.h"

namespace trilens {

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
