#include "measure/pixel/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

#include "base/util/check.h"
#include "base/util/parallel.h"
#include "measure/pixel/separable_filter.h"

namespace trilens {

struct FlipWindow {
    std::vector<std::array<double, 3>> lab;  // filtered, Hunt-adjusted
    std::vector<double> edges, points;       // how strong
};

namespace {

using Planes = std::array<Plane, 3>;

constexpr std::size_t kPixelsAtOnce = 4096;

// --- Colours: linear sRGB (D65), CIE XYZ, YCxCz (Y, red-green, blue-yellow), L*a*b* ---

using Colour = std::array<double, 3>;
using Matrix = std::array<Colour, 3>;

constexpr Matrix kXyzOfRgb = {{{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                               {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                               {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}}};

constexpr Colour times(const Matrix& m, const Colour& c) {
    Colour out{};
    for (std::size_t i = 0; i < 3; ++i) out[i] = m[i][0] * c[0] + m[i][1] * c[1] + m[i][2] * c[2];
    return out;
}

constexpr Matrix inverse(const Matrix& m) {
    const auto minor_at = [&](std::size_t i, std::size_t j) {
        const std::size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
        return m[a][c] * m[b][d] - m[a][d] * m[b][c];
    };
    const double determinant = m[0][0] * minor_at(0, 0) + m[0][1] * minor_at(0, 1) + m[0][2] * minor_at(0, 2);
    Matrix out{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) out[i][j] = minor_at(j, i) / determinant;
    return out;
}

constexpr Matrix kRgbOfXyz = inverse(kXyzOfRgb);
constexpr Colour kWhite = times(kXyzOfRgb, {1, 1, 1});

/// A colour relative to white in XYZ (relative_to_white) as YCxCz; the same form makes L*a*b* of cube roots.
Colour ycxcz_of_relative(const Colour& v) {
    return {116 * v[1] - 16, 500 * (v[0] - v[1]), 200 * (v[1] - v[2])};
}

/// Linear sRGB as XYZ, each divided by white's.
Colour relative_to_white(const Colour& rgb) {
    Colour v = times(kXyzOfRgb, rgb);
    for (std::size_t i = 0; i < 3; ++i) v[i] /= kWhite[i];
    return v;
}

/// YCxCz as linear sRGB.
Colour rgb_of_ycxcz(const Colour& c) {
    const double y = (c[0] + 16) / 116;
    return times(kRgbOfXyz, {(y + c[1] / 500) * kWhite[0], y * kWhite[1], (y - c[2] / 200) * kWhite[2]});
}

/// Linear sRGB as L*a*b* with the chroma weighted by lightness (Hunt: what is dark has less colour).
Colour hunt_lab(const Colour& rgb) {
    constexpr double kDelta = 6.0 / 29;
    Colour v = relative_to_white(rgb);
    for (double& x : v)
        x = x > kDelta * kDelta * kDelta ? std::cbrt(x) : x / (3 * kDelta * kDelta) + 4.0 / 29;
    const Colour lab = ycxcz_of_relative(v);
    return {lab[0], 0.01 * lab[0] * lab[1], 0.01 * lab[0] * lab[2]};
}

/// HyAB (Abasi, Amani Tehran, Fairchild 2020): city blocks in lightness, straight in chroma.
double hyab(const Colour& a, const Colour& b) {
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

// --- Filters ---

template <typename Weight>
Kernel make_kernel(int reach, const Weight& weight) {
    Kernel kernel;
    for (int i = -reach; i <= reach; ++i) kernel.push_back(weight(static_cast<double>(i)));
    return kernel;
}

double sum_of(const Kernel& kernel) {
    double sum = 0;
    for (const double weight : kernel) sum += weight;
    return sum;
}

/// Positive weights sum to 1, negative ones to -1.
void normalize_signs(Kernel& kernel) {
    double positive = 0, negative = 0;
    for (const double weight : kernel) (weight > 0 ? positive : negative) += weight;
    for (double& weight : kernel) weight /= weight > 0 ? positive : -negative;
}

/// One Gaussian a sqrt(pi / b) exp(-pi^2 z^2 / b) of a contrast sensitivity function, z in degrees (the
/// paper's table 1).
struct Sensitivity {
    double a, b;
};

constexpr double kWidest = 0.04;  // the largest b: it gives the reach of all

int sensitivity_reach(double per_degree) {
    constexpr double kPi = std::numbers::pi;
    return static_cast<int>(std::ceil(3 * std::sqrt(kWidest / (2 * kPi * kPi)) * per_degree));
}

/// The plane under a sum of Gaussians whose weights sum to one. The sum of two is not separable, each of them
/// is.
Plane filter_by_sensitivity(const Plane& plane, std::span<const Sensitivity> gaussians, double per_degree) {
    constexpr double kPi = std::numbers::pi;
    const int reach = sensitivity_reach(per_degree);
    std::vector<Kernel> kernels;
    std::vector<double> shares;
    double whole = 0;
    for (const Sensitivity& gaussian : gaussians) {
        kernels.push_back(make_kernel(reach, [&](double i) {
            return std::exp(-kPi * kPi * i * i / (per_degree * per_degree * gaussian.b));
        }));
        const double sum = sum_of(kernels.back());
        shares.push_back(gaussian.a * std::sqrt(kPi / gaussian.b) * sum * sum);
        whole += shares.back();
        for (double& weight : kernels.back()) weight /= sum;
    }
    Plane out{plane.width, plane.height, std::vector<double>(plane.values.size(), 0.0)};
    for (std::size_t k = 0; k < kernels.size(); ++k) {
        const Plane part = filter_plane(plane, kernels[k], kernels[k]);
        for (std::size_t i = 0; i < out.values.size(); ++i)
            out.values[i] += shares[k] / whole * part.values[i];
    }
    return out;
}

/// The standard deviation of the Gaussian that features are found with, pixels.
double feature_width(double per_degree) {
    constexpr double kPeakToTrough = 0.082;  // degrees, of human edge detection
    return 0.5 * kPeakToTrough * per_degree;
}
int feature_reach(double per_degree) {
    return static_cast<int>(std::ceil(3 * feature_width(per_degree)));
}

/// Lengths of the vectors (along rows, along columns) that `feature` across and `smooth` along find.
std::vector<double> feature_strength(const Plane& lightness, const Kernel& feature, const Kernel& smooth) {
    const Plane across = filter_plane(lightness, feature, smooth),
                down = filter_plane(lightness, smooth, feature);
    std::vector<double> lengths(lightness.values.size());
    parallel_for(lengths.size(), kPixelsAtOnce, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) lengths[i] = std::hypot(across.values[i], down.values[i]);
    });
    return lengths;
}

// --- What one picture becomes ---

Planes opponent_planes(const ColourPicture& picture, const std::vector<std::uint8_t>& is_finite) {
    Planes planes;
    for (Plane& plane : planes)
        plane = {picture.width, picture.height, std::vector<double>(is_finite.size(), 0.0)};
    parallel_for(is_finite.size(), kPixelsAtOnce, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const auto shown = [&](float value) {
                return is_finite[i] ? std::clamp(static_cast<double>(value), 0.0, 1.0) : 0.0;
            };
            const Colour colour = ycxcz_of_relative(
                relative_to_white({shown(picture.r[i]), shown(picture.g[i]), shown(picture.b[i])}));
            for (std::size_t c = 0; c < 3; ++c) planes[c].values[i] = colour[c];
        }
    });
    return planes;
}

std::vector<Colour> filtered_lab(const Planes& planes, double per_degree) {
    constexpr std::array<Sensitivity, 1> kLightness = {{{1, 0.0047}}}, kRedGreen = {{{1, 0.0053}}};
    constexpr std::array<Sensitivity, 2> kBlueYellow = {{{34.1, 0.04}, {13.5, 0.025}}};
    const Planes seen = {filter_by_sensitivity(planes[0], kLightness, per_degree),
                         filter_by_sensitivity(planes[1], kRedGreen, per_degree),
                         filter_by_sensitivity(planes[2], kBlueYellow, per_degree)};
    std::vector<Colour> lab(seen[0].values.size());
    parallel_for(lab.size(), kPixelsAtOnce, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            Colour rgb = rgb_of_ycxcz({seen[0].values[i], seen[1].values[i], seen[2].values[i]});
            for (double& value : rgb) value = std::clamp(value, 0.0, 1.0);
            lab[i] = hunt_lab(rgb);
        }
    });
    return lab;
}

FlipWindow prepare(const ColourPicture& picture, const std::vector<std::uint8_t>& is_finite,
                   double per_degree) {
    const double sigma = feature_width(per_degree);
    const int reach = feature_reach(per_degree);
    const auto gaussian = [&](double i) { return std::exp(-i * i / (2 * sigma * sigma)); };
    Kernel smooth = make_kernel(reach, gaussian);
    const double sum = sum_of(smooth);
    for (double& weight : smooth) weight /= sum;
    Kernel edge = make_kernel(reach, [&](double i) { return -i * gaussian(i); });
    Kernel point = make_kernel(reach, [&](double i) { return (i * i / (sigma * sigma) - 1) * gaussian(i); });
    normalize_signs(edge);
    normalize_signs(point);

    const Planes planes = opponent_planes(picture, is_finite);
    Plane lightness = planes[0];
    for (double& value : lightness.values) value = (value + 16) / 116;
    return {filtered_lab(planes, per_degree), feature_strength(lightness, edge, smooth),
            feature_strength(lightness, point, smooth)};
}

// --- The error ---

constexpr double kColourExponent = 0.7, kFeatureExponent = 0.5;

/// Distances up to 0.4 of the largest fill 0..0.95, the others the rest.
double redistributed(double distance, double largest) {
    constexpr double kShareOfLargest = 0.4, kShareOfRange = 0.95;
    const double knee = kShareOfLargest * largest;
    if (distance < knee) return kShareOfRange / knee * distance;
    return kShareOfRange + (distance - knee) / (largest - knee) * (1 - kShareOfRange);
}

double error_at(const FlipWindow& reference, const FlipWindow& test, std::size_t i) {
    // Where nothing differs all powers below are of zero.
    if (reference.lab[i] == test.lab[i] && reference.edges[i] == test.edges[i] &&
        reference.points[i] == test.points[i])
        return 0;
    static const double kLargest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), kColourExponent);
    const double colour =
        redistributed(std::pow(hyab(reference.lab[i], test.lab[i]), kColourExponent), kLargest);
    const double feature = std::max(std::abs(reference.edges[i] - test.edges[i]),
                                    std::abs(reference.points[i] - test.points[i]));
    const double strength = std::clamp(std::pow(feature / std::numbers::sqrt2, kFeatureExponent), 0.0, 1.0);
    return std::pow(std::clamp(colour, 0.0, 1.0), 1 - strength);
}

/// A window's borders a little outward, so that those of many tests are the same.
PictureWindow rounded_outward(const PictureWindow& window, const ColourPicture& inside) {
    constexpr int kStep = 32;
    return {window.x0 / kStep * kStep, window.y0 / kStep * kStep,
            std::min(inside.width, (window.x1 + kStep - 1) / kStep * kStep),
            std::min(inside.height, (window.y1 + kStep - 1) / kStep * kStep)};
}

struct WindowPair {
    PictureWindow window;
    CroppedPicture reference, test;
    std::vector<std::uint8_t> is_finite;
    bool all_finite = true;

    WindowPair(const ColourPicture& one, const ColourPicture& other, const PictureWindow& where)
        : window(where), reference(one, where), test(other, where) {
        const ColourPicture a = reference.picture(), b = test.picture();
        is_finite.resize(a.r.size());
        for (std::size_t i = 0; i < is_finite.size(); ++i) {
            is_finite[i] = is_number(a, i) && is_number(b, i);
            all_finite = all_finite && is_finite[i];
        }
    }
};

/// The errors of a window's pixels.
std::vector<float> measure_window(const WindowPair& pair, double per_degree, FlipReference* kept) {
    const auto make = [&] { return prepare(pair.reference.picture(), pair.is_finite, per_degree); };
    const PictureWindow& w = pair.window;
    // What is not finite in the test changes what is made of the reference.
    const auto a = kept && pair.all_finite ? kept->get({w.x0, w.y0, w.x1, w.y1}, make)
                                           : std::make_shared<const FlipWindow>(make());
    const FlipWindow b = prepare(pair.test.picture(), pair.is_finite, per_degree);
    std::vector<float> errors(pair.is_finite.size());
    parallel_for(errors.size(), kPixelsAtOnce, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            errors[i] = pair.is_finite[i] ? static_cast<float>(error_at(*a, b, i))
                                          : std::numeric_limits<float>::quiet_NaN();
    });
    return errors;
}

}  // namespace

std::shared_ptr<const FlipWindow> FlipReference::get(const std::array<int, 4>& window,
                                                     const std::function<FlipWindow()>& make) {
    {
        const std::lock_guard guard(mutex_);
        if (kept_ && window_ == window) return kept_;
    }
    auto made = std::make_shared<const FlipWindow>(make());
    const std::lock_guard guard(mutex_);
    window_ = window;
    return kept_ = std::move(made);
}

std::vector<float> flip_map(const ColourPicture& reference, const ColourPicture& test,
                            double pixels_per_degree, FlipReference* kept) {
    TRILENS_CHECK(reference.width == test.width && reference.height == test.height, "pictures of one size");
    TRILENS_CHECK(pixels_per_degree > 0, "some pixels per degree");
    const std::size_t width = static_cast<std::size_t>(reference.width);
    std::vector<float> errors(width * static_cast<std::size_t>(reference.height), 0.0f);
    // A pixel whose filters read no pixel that differs has an error of exactly zero: both pictures hold the
    // same numbers there, and make the same sums of them.
    const PictureWindow differing = differing_window(reference, test);
    if (differing.is_empty()) return errors;
    const int reach = std::max(sensitivity_reach(pixels_per_degree), feature_reach(pixels_per_degree));
    const PictureWindow measured = differing.grown(reach, reference);
    const WindowPair pair(reference, test, rounded_outward(measured.grown(reach, reference), reference));
    const std::vector<float> there = measure_window(pair, pixels_per_degree, kept);
    const std::size_t columns = static_cast<std::size_t>(pair.window.x1 - pair.window.x0);
    for (int y = measured.y0; y < measured.y1; ++y) {
        const auto from = there.begin() +
                          static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y - pair.window.y0) * columns);
        std::copy(
            from + (measured.x0 - pair.window.x0), from + (measured.x1 - pair.window.x0),
            errors.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y) * width) + measured.x0);
    }
    return errors;
}

}  // namespace trilens
