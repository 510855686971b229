// Two images, pixel against pixel: how far apart they are, and whether that is too far.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/util/ids.h"

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

}  // namespace trilens
