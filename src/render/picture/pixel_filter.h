// How the samples around a pixel make its colour.
#pragma once

#include <functional>
#include <vector>

#include "render/frame/views.h"
#include "scene/data/scene.h"

namespace trilens {

/// The weights of samples by their place along one axis; a sample's weight is the product of both axes'.
/// Symmetric; they need not sum to 1, for at the film's border samples are missing: whoever sums divides.
struct PixelFilter {
    int reach = 0;                // pixels to either side whose samples count
    std::vector<double> weights;  // of the 2 reach + 1 pixels' samples along the axis, in order
    std::function<Vec3(const Vec3& light)> shown = {};  // as LayerRequest::shown

    /// What of a sample's colour is averaged.
    SampleColour averaged(const SampleColour& sample) const;
};

/// For side x side samples a pixel. Box: those of the pixel alone. Mitchell: Mitchell and Netravali,
/// Reconstruction Filters in Computer Graphics (1988), B = C = 1/3, reaching 2 pixels. Gaussian: deviation
/// 0.5, reaching 1.5 pixels, less its value there (Pharr, Jakob, Humphreys, Physically Based Rendering, 8.8).
PixelFilter make_pixel_filter(FilterKind kind, int side);

}  // namespace trilens
