#include "measure/compare_layers.h"

#include "measure/difference.h"

#include <utility>

namespace trilens {

std::vector<LayerComparison> compare_layers(const Image& reference, const Image& test,
                                            const DisplacementOptions& options) {
    std::vector<LayerComparison> layers;
    for (const char* name : {"reflect", "refract", "direct"}) {
        LayerComparison layer{name, compare_seen(reference, test, name, options.mask_object),
                              measure_displacement(reference, test, name, options)};
        if (layer.seen) layers.push_back(std::move(layer));
    }
    return layers;
}

void add_shifts(const std::vector<LayerComparison>& layers, Image& difference) {
    for (const LayerComparison& layer : layers)
        if (layer.displacement && layer.displacement->coverage)
            add_shift(layer.layer, *layer.displacement, difference);
}

SeenMismatch total_seen(const std::vector<LayerComparison>& layers) {
    SeenMismatch total;
    for (const LayerComparison& layer : layers) {
        if (!layer.seen) continue;
        total.pixels += layer.seen->pixels;
        total.object_mismatch += layer.seen->object_mismatch;
        total.primitive_mismatch += layer.seen->primitive_mismatch;
        total.coverage_mismatch += layer.seen->coverage_mismatch;
    }
    return total;
}

const LayerComparison* main_layer(const std::vector<LayerComparison>& layers, const std::string& asked) {
    for (const LayerComparison& layer : layers)
        if (layer.layer == asked && layer.displacement) return &layer;
    for (const LayerComparison& layer : layers)
        if (layer.displacement && layer.displacement->coverage) return &layer;
    return nullptr;
}

}  // namespace trilens
