// One run's image against the truth, as the columns of a sweep.
#pragma once

#include <string>
#include <vector>

#include "base/image/image.h"
#include "measure/displacement/reference_layers.h"
#include "sweep/store/results.h"

namespace trilens {

struct MeasuredRun {
    MetricValues metrics;  // rgb_*, disp_* (of the worse layer, all optics), mismatches, nonfinite, failed_px
    std::vector<OpticDisplacement> displacement;  // each layer that the images have: all optics, then each
    std::vector<std::string> warnings;            // what could not be measured, and why
    Image diff;
};

/// Compares `test` with `truth`. Throws InputError where they cannot be compared.
MeasuredRun measure_run(const Image& test, const ReferenceLayers& truth,
                        const std::vector<SweptOptic>& optics);

/// The length of the displacement at each pixel of a diff image's data window.
struct DisplacementMap {
    std::string layer;
    std::vector<float> pixels;  // NaN: nothing to measure; infinite: lost
};

/// The maps that a diff image of measure_run holds.
std::vector<DisplacementMap> displacement_maps(const Image& diff);

}  // namespace trilens
