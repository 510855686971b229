// Two images, pixel against pixel: how far apart they are, and whether that is too far.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/util/ids.h"
#include "measure/displacement/displacement.h"

namespace trilens {

class FlipReference;

/// What is compared, and the thresholds: idiff's options by name and meaning.
struct CompareOptions {
    std::string layer;  // "": the beauty, R G B (and A where there is one); "reflect": reflect.R G B
    std::optional<Id> mask_object;  // only pixels whose optic.object is this in either image
    double fail = 0.004;            // absolute difference beyond which a channel fails ...
    double failrelative =
        0.001;                  // ... if it is also beyond this share of the mean magnitude of the two values
    double failpercent = 0.02;  // percentage of pixels that may fail
    double hardfail = 0.05;     // absolute difference that no pixel may exceed
    std::size_t allowfailures = 0;  // so many pixels may differ by any amount
    double warn = 0.004;            // absolute difference beyond which a pixel is worth a warning
    double warnpercent = 0;         // percentage of pixels that may be so without one
};

/// Errors over the values v (test) and r (reference) of R, G and B of all compared pixels where these six are
/// finite. All zero (psnr_db infinite, ssim 1) where there is no such pixel.
struct Metrics {
    double mae = 0;                    // mean |v - r|
    double rmse = 0;                   // sqrt(mean (v - r)^2)
    double relmse = 0;                 // mean (v - r)^2 / (r^2 + 0.01)
    double psnr_db = 0;                // 20 log10(1 / rmse), peak 1; infinity for equal images
    double ssim = 1;                   // of the luminances 0.2126 R + 0.7152 G + 0.0722 B; see ssim.h
    double flip = 0;                   // mean of the errors of flip.h, 0 (none) to 1
    double max = 0;                    // largest |v - r|
    double p50 = 0, p95 = 0, p99 = 0;  // of each pixel's largest |v - r|
};

/// One of the Metrics, as JSON, limits, the columns of sweeps ("rgb_" before the name) and Python have it.
struct ColourMetric {
    const char* name;
    double Metrics::*value;
    const char* help;
    bool is_likeness = false;          // more is better
    bool is_column = true;             // of a sweep
    const char* limit_name = nullptr;  // null: `name`
};
inline constexpr std::array kColourMetrics{
    ColourMetric{"mae", &Metrics::mae, "Mean |v - r|."},
    ColourMetric{"rmse", &Metrics::rmse, "Root of the mean (v - r)^2."},
    ColourMetric{"relmse", &Metrics::relmse, "Mean (v - r)^2 / (r^2 + 0.01)."},
    ColourMetric{"psnr_db", &Metrics::psnr_db, "Decibels; inf for equal images.", true},
    ColourMetric{"ssim", &Metrics::ssim, "Structural similarity of the luminances.", true},
    ColourMetric{"flip", &Metrics::flip, "Mean of FLIP's errors, 0 (none to be seen) to 1.", false, true,
                 "rgb_flip"},
    ColourMetric{"max", &Metrics::max, "Largest |v - r|."},
    ColourMetric{"p50", &Metrics::p50, "Percentile of each pixel's largest |v - r|.", false, false},
    ColourMetric{"p95", &Metrics::p95, "Likewise."},
    ColourMetric{"p99", &Metrics::p99, "Likewise."}};

struct CompareCounts {
    std::size_t pixels = 0;                    // compared
    std::size_t masked = 0;                    // left out by the mask
    std::size_t fail = 0, warn = 0, hard = 0;  // pixels beyond fail (and failrelative), warn, hardfail
    // Pixels with such a value in any float channel of the image, not only in the layer's.
    std::size_t nan_ref = 0, nan_test = 0, inf_ref = 0, inf_test = 0;
};

/// The largest finite difference; `channel` is empty where there is none.
struct WorstPixel {
    int x = 0, y = 0;  // film pixel
    std::string channel;
    double reference = 0, test = 0;
};

enum class Verdict { kPass, kWarning, kFailure };

struct Comparison {
    Verdict verdict = Verdict::kPass;
    std::vector<std::string> reasons;  // one sentence per rule that was broken; empty exactly for kPass
    Metrics metrics;
    CompareCounts counts;
    WorstPixel worst;
};

/// Compares the channels of one layer. With d the absolute and m the mean magnitude of two values, a pixel
///   is hard  where d > hardfail in a channel,
///   fails    where d > fail and d > failrelative * m in one channel, or it is hard,
///   warns    where d > warn in a channel.
/// The verdict is kFailure where any compared pixel holds a NaN or an infinity in any float channel of either
/// image (even in both), or hard pixels > allowfailures, or failing pixels > allowfailures and > failpercent
/// % of the compared ones; else kWarning where warning pixels > warnpercent % of the compared ones; else
/// kPass. No rule hides another. Throws InputError where the images cannot be compared (see
/// require_comparable, compared_pixels) or the layer has no R, G and B.
/// `flip`: the errors of layer_flip for the same images and layer, where they are known; InputError where
/// they are not as many as pixels.
Comparison compare(const Image& reference, const Image& test, const CompareOptions& options = {},
                   const std::vector<float>* flip = nullptr);

/// The errors of flip.h of all pixels of the window, of a layer as CompareOptions names it. `kept`: as
/// flip_map has it. Throws InputError where the images cannot be compared, or the layer has no R, G and B.
std::vector<float> layer_flip(const Image& reference, const Image& test, const std::string& layer,
                              FlipReference* kept = nullptr);

// What two pictures show through their optics, layer by layer: the same things, and in the same places?

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
    std::optional<BoundCheck> bounds{};  // of paths, where the test has a channel "bound"
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

// The difference of two images as an image to look at.

struct DifferenceOptions {
    std::string layer;              // "": the beauty; as in CompareOptions
    std::optional<Id> mask_object;  // as in CompareOptions
};

/// An image with the window of the two and float channels
///   R G B        test - reference of the layer's R, G, B; zero outside the mask
///   abs.R G B    its magnitude
///   mask.M       1 where the pixel is compared, else 0
///   flip.Y       the error of flip.h, 0 (none to be seen) to 1; zero outside the mask
/// Throws InputError where compare() would.
/// `flip`: the errors of layer_flip for the same images and layer, where they are known; InputError where
/// they are not as many as pixels.
Image make_difference(const Image& reference, const Image& test, const DifferenceOptions& options = {},
                      std::vector<float> flip = {});

/// Adds what `layer` ("reflect", "refract") shows, moved, to the difference of the same two images:
///   LAYER.shift.X Y    Displacement::shift_x, shift_y, in pixels
///   LAYER.shift.M      1 found, -1 lost, -2 unmeasured, 0 nothing seen
/// Throws InputError for a displacement of images of another size.
void add_shift(const std::string& layer, const Displacement& displacement, Image& difference);

// Limits on any number that a comparison gives, by the number's name.
//
//     #include <trilens/image.h>
//     const trilens::Image truth = trilens::read_image("truth.exr"), image = trilens::read_image("mine.exr");
//     const std::vector<trilens::NamedMetric> metrics =
//         trilens::named_metrics(trilens::compare(truth, image), trilens::compare_layers(truth, image));
//     for (const std::string& sentence : trilens::broken_limits({{"displacement_p95", 0.5}}, metrics))
//         std::puts(sentence.c_str());

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
/// _max and _mean_off_folds in pixels; summed over the layers lost, unmeasured, beyond_radius, missing and
/// beyond_bound;
/// lost_percent and unmeasured_percent of the test's pixels that see something; and the least coverage. Then
/// what is seen and displaced of each layer alone: reflect.object_mismatch, refract.displacement_p95.
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
