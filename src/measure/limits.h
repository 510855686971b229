// Limits on any number that a comparison gives, by the number's name.
//
//     #include <trilens/image.h>
//     const trilens::Image truth = trilens::read_image("truth.exr"), image = trilens::read_image("mine.exr");
//     const std::vector<trilens::NamedMetric> metrics =
//         trilens::named_metrics(trilens::compare(truth, image), trilens::compare_layers(truth, image));
//     for (const std::string& sentence : trilens::broken_limits({{"displacement_p95", 0.5}}, metrics))
//         std::puts(sentence.c_str());
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "measure/compare.h"
#include "measure/compare_layers.h"

namespace trilens {

/// One number of a comparison.
struct NamedMetric {
    std::string name;             // "rmse", "displacement_p95", "lost_percent"
    std::optional<double> value;  // none: nothing was measured
    bool is_likeness = false;     // more is better: ssim, psnr_db, coverage
};

/// Every number that may be limited, in a fixed order. Of the beauty (or the layer that was compared) the
/// kColourMetrics (flip as rgb_flip), then fail, warn, hard. Of what is seen, summed over
/// the layers, object_mismatch, primitive_mismatch and coverage_mismatch, and each as percent of the pixels
/// that see something. Of the displacement, the worst of the layers, displacement_mean, _p50, _p95, _p99,
/// _max and _mean_off_folds in pixels; summed over the layers lost, unmeasured, beyond_radius and missing;
/// lost_percent and unmeasured_percent of the test's pixels that see something; and the least coverage. Then what is seen and displaced of each
/// layer alone: reflect.object_mismatch, refract.displacement_p95.
std::vector<NamedMetric> named_metrics(const Comparison& comparison,
                                       const std::vector<LayerComparison>& layers);

/// Their names.
std::vector<std::string> metric_names();

struct MetricLimit {
    std::string metric;
    double value = 0;  // the largest that is allowed; of a likeness the least
};

/// One sentence for each limit that is exceeded, or whose number was not measured: a limit on nothing does
/// not hold. Throws UsageError, with the nearest name, for metrics that do not exist.
std::vector<std::string> broken_limits(const std::vector<MetricLimit>& limits,
                                       const std::vector<NamedMetric>& metrics);

}  // namespace trilens
