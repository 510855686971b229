#include "measure/compare.h"

#include <cmath>
#include <utility>

#include "measure/common/comparable.h"

namespace trilens {

std::optional<SeenMismatch> compare_seen(const Image& reference, const Image& test, const std::string& layer,
                                         std::optional<Id> mask_object) {
    require_comparable(reference, test);
    const auto channel = [&](const Image& image, const char* name) {
        return seen_channel(image, layer, name);
    };
    if (!reference.find(channel(reference, "object"))) return std::nullopt;
    const std::vector<std::uint8_t> mask = compared_pixels(reference, test, mask_object);
    const std::vector<Id>& object_reference = id_channel(reference, channel(reference, "object"));
    const std::vector<Id>& object_test = id_channel(test, channel(test, "object"));

    // Without a channel of primitives every object is one piece.
    const bool has_primitive = reference.find(channel(reference, "primitive")) != nullptr;
    const std::vector<Id>& primitive_reference =
        has_primitive ? id_channel(reference, channel(reference, "primitive")) : object_reference;
    const std::vector<Id>& primitive_test =
        has_primitive ? id_channel(test, channel(test, "primitive")) : object_test;

    SeenMismatch result;
    for (std::size_t i = 0; i < mask.size(); ++i) {
        const Id a = object_reference[i], b = object_test[i];
        if (!mask[i] || (a == kNone && b == kNone)) continue;
        ++result.pixels;
        if (a == kNone || b == kNone)
            ++result.coverage_mismatch;
        else if (a != b)
            ++result.object_mismatch;
        else if (primitive_reference[i] != primitive_test[i])
            ++result.primitive_mismatch;
    }
    return result;
}

std::vector<LayerComparison> compare_layers(const Image& reference, const Image& test,
                                            const DisplacementOptions& options) {
    std::vector<LayerComparison> layers;
    for (const char* name : {"reflect", "refract", "direct"}) {
        LayerComparison layer{name, compare_seen(reference, test, name, options.mask_object),
                              measure_displacement(reference, test, name, options)};
        if (layer.displacement && layer.layer != "direct" && layer.seen && layer.seen->pixels > 0)
            layer.bounds = check_bounds(reference, test, name, *layer.displacement);
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

namespace {

/// Adds one layer to the total; `lengths`: of all shifts found so far. `seen`: pixels that show a layer.
struct Adding {
    Displacement& total;
    std::vector<double>& lengths;
    double seen = 0, off_folds = 0;
    std::size_t off_fold_pixels = 0;

    void add(const Displacement& one) {
        total.pixels += one.pixels;
        total.lost += one.lost;
        total.unmeasured += one.unmeasured;
        total.beyond_radius += one.beyond_radius;
        total.missing += one.missing;
        total.near_folds += one.near_folds;
        if (*one.coverage > 0)
            seen += static_cast<double>(one.pixels) / *one.coverage;
        else
            seen += static_cast<double>(one.lost + one.unmeasured + one.missing);
        if (one.mean_off_folds) {
            const std::size_t count = one.pixels - one.near_folds;
            off_folds += *one.mean_off_folds * static_cast<double>(count);
            off_fold_pixels += count;
        }
        for (std::size_t p = 0; p < one.state.size(); ++p)
            if (one.state[p] == Shift::kFound)
                lengths.push_back(
                    std::hypot(static_cast<double>(one.shift_x[p]), static_cast<double>(one.shift_y[p])));
    }
};

}  // namespace

Displacement total_displacement(const std::vector<LayerComparison>& layers, const std::string& asked) {
    for (const LayerComparison& layer : layers)
        if (layer.layer == asked && layer.displacement) return *layer.displacement;
    std::vector<const Displacement*> shown;
    for (const LayerComparison& layer : layers)
        if (layer.displacement && layer.displacement->coverage) shown.push_back(&*layer.displacement);
    if (shown.size() == 1) return *shown[0];
    Displacement total;
    std::vector<double> lengths;
    Adding adding{total, lengths};
    for (const Displacement* one : shown) adding.add(*one);
    if (!lengths.empty()) total.summary = summarize(std::move(lengths));
    if (!shown.empty())
        total.coverage = adding.seen > 0 ? static_cast<double>(total.pixels) / adding.seen : 0;
    if (adding.off_fold_pixels > 0)
        total.mean_off_folds = adding.off_folds / static_cast<double>(adding.off_fold_pixels);
    return total;
}

}  // namespace trilens
