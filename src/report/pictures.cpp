// Pictures of images for reports: what is shown, how far two differ, how far things moved.
#include "report/page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/util/check.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "image/image_io.h"

namespace trilens {
namespace {

constexpr LinearRgb kNotFinite = {1.0f, 0.0f, 1.0f};
constexpr LinearRgb kNothing = {0.216f, 0.216f, 0.216f};  // sRGB 0.5
constexpr LinearRgb kLost = {1.0f, 0.2f, 0.0f};
constexpr LinearRgb kUnmeasured = {1.0f, 1.0f, 1.0f};

constexpr std::size_t kRowsAtOnce = 16;

/// Linear RGB triples of a film, rows from the top.
struct Film {
    int width = 0, height = 0;
    std::vector<float> rgb;

    std::size_t index(int x, int y) const {
        return (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)) *
               3;
    }
};

Film make_film(int width, int height) {
    return {width, height,
            std::vector<float>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3)};
}

Film film_of(const Image& image) {
    constexpr std::array<const char*, 3> kNames = {"R", "G", "B"};
    std::array<const float*, 3> values{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const Channel* const found = image.find(kNames[channel]);
        if (!found || found->is_id())
            throw InputError("", kNames[channel], "the image has no such float channel");
        values[channel] = found->floats().data();
    }
    Film film = make_film(image.width, image.height);
    const int left = std::max(0, -image.x0), right = std::min(image.data_width, film.width - image.x0);
    parallel_for(static_cast<std::size_t>(image.data_height), kRowsAtOnce,
                 [&](std::size_t first, std::size_t last) {
                     for (std::size_t y = first; y < last; ++y) {
                         const int film_y = image.y0 + static_cast<int>(y);
                         if (film_y < 0 || film_y >= film.height) continue;
                         for (int x = left; x < right; ++x)
                             for (std::size_t channel = 0; channel < 3; ++channel)
                                 film.rgb[film.index(image.x0 + x, film_y) + channel] =
                                     values[channel][y * static_cast<std::size_t>(image.data_width) +
                                                     static_cast<std::size_t>(x)];
                     }
                 });
    return film;
}

/// |test - truth|; not a number where either is not finite.
Film difference_of(const Image& test, const Image& truth) {
    Film film = film_of(test);
    const Film other = film_of(truth);
    if (film.width != other.width || film.height != other.height)
        throw InputError("", "", "the films differ in size");
    for (std::size_t i = 0; i < film.rgb.size(); ++i) film.rgb[i] = std::abs(film.rgb[i] - other.rgb[i]);
    return film;
}

void mark_not_finite(Film& film) {
    for (std::size_t i = 0; i < film.rgb.size(); i += 3)
        if (!std::isfinite(film.rgb[i]) || !std::isfinite(film.rgb[i + 1]) || !std::isfinite(film.rgb[i + 2]))
            std::copy(kNotFinite.begin(), kNotFinite.end(),
                      film.rgb.begin() + static_cast<std::ptrdiff_t>(i));
}

/// The source pixels under target pixel i where `source` pixels shrink to `target`, and how much of each.
struct Footprint {
    int first = 0, last = 0;  // both included
    double from = 0, to = 0;

    double share(int pixel) const {
        return std::min(to, pixel + 1.0) - std::max(from, static_cast<double>(pixel));
    }
};

Footprint footprint(int i, int target, int source) {
    const double from = static_cast<double>(i) * source / target, to = (i + 1.0) * source / target;
    return {static_cast<int>(from), std::min(source, static_cast<int>(std::ceil(to))) - 1, from, to};
}

int shrunk_width(int width) {
    return std::min(width, kLargestPicture);
}
int shrunk_height(int width, int height) {
    return std::max(1,
                    static_cast<int>(std::lround(static_cast<double>(height) * shrunk_width(width) / width)));
}

/// The film at kLargestPicture at most; each pixel is the mean over its area.
Film shrink(const Film& film) {
    Film small = make_film(shrunk_width(film.width), shrunk_height(film.width, film.height));
    if (small.width == film.width) return film;
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x) {
            const Footprint rows = footprint(y, small.height, film.height);
            const Footprint columns = footprint(x, small.width, film.width);
            std::array<double, 3> sum{};
            for (int row = rows.first; row <= rows.last; ++row)
                for (int column = columns.first; column <= columns.last; ++column)
                    for (std::size_t channel = 0; channel < 3; ++channel)
                        sum[channel] += rows.share(row) * columns.share(column) *
                                        static_cast<double>(film.rgb[film.index(column, row) + channel]);
            const double area = (rows.to - rows.from) * (columns.to - columns.from);
            for (std::size_t channel = 0; channel < 3; ++channel)
                small.rgb[small.index(x, y) + channel] = static_cast<float>(sum[channel] / area);
        }
    return small;
}

PagePicture picture_of(Film film, const std::string& caption) {
    mark_not_finite(film);
    const Film small = shrink(film);
    return {caption, small.width, small.height, encode_png(small.width, small.height, small.rgb), {}, false};
}

LinearRgb displacement_colour(float pixels, const ColourRange& range) {
    if (std::isnan(pixels)) return kNothing;
    if (std::isinf(pixels)) return pixels > 0 ? kLost : kUnmeasured;
    return viridis(range.share(static_cast<double>(pixels)));
}

/// The colour of each value; of those under a pixel that was scaled down the largest's.
template <class Colour>
PagePicture mapped_picture(std::span<const float> values, int width, const std::string& caption,
                           const Colour& colour_of) {
    TRILENS_CHECK(width > 0 && values.size() % static_cast<std::size_t>(width) == 0, "whole rows");
    const int height = static_cast<int>(values.size() / static_cast<std::size_t>(width));
    Film small = make_film(shrunk_width(width), shrunk_height(width, height));
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x) {
            const Footprint rows = footprint(y, small.height, height),
                            columns = footprint(x, small.width, width);
            float largest = NAN;
            for (int row = rows.first; row <= rows.last; ++row)
                for (int column = columns.first; column <= columns.last; ++column)
                    largest = std::fmax(
                        largest, values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                                        static_cast<std::size_t>(column)]);
            const LinearRgb colour = colour_of(largest);
            std::copy(colour.begin(), colour.end(),
                      small.rgb.begin() + static_cast<std::ptrdiff_t>(small.index(x, y)));
        }
    return {caption, small.width, small.height, encode_png(small.width, small.height, small.rgb), {}, false};
}

}  // namespace

PagePicture beauty_picture(const Image& image, const std::string& caption) {
    return picture_of(film_of(image), caption);
}

PagePicture difference_picture(const Image& test, const Image& truth, double scale,
                               const std::string& caption) {
    Film film = difference_of(test, truth);
    for (float& value : film.rgb) value *= static_cast<float>(scale);
    return picture_of(std::move(film), caption);
}

PagePicture displacement_picture(std::span<const float> pixels, int width, const ColourRange& range,
                                 const std::string& caption) {
    PagePicture picture = mapped_picture(pixels, width, caption,
                                         [&](float value) { return displacement_colour(value, range); });
    picture.legend = ColourLegend{range, "px"};
    return picture;
}

std::string displacement_colours(std::span<const float> pixels) {
    const auto has = [&](float value) {
        return std::ranges::any_of(pixels, [&](float pixel) { return pixel == value; });
    };
    std::string text = "; grey: none";
    if (has(INFINITY)) text += ", orange: lost";
    if (has(-INFINITY)) text += ", white: unmeasured";
    return text;
}

PagePicture share_picture(std::span<const float> shares, int width, const std::string& caption) {
    return mapped_picture(shares, width, caption, [](float value) {
        return std::isnan(value) ? kNothing : viridis(static_cast<double>(value));
    });
}

double difference_scale(double difference) {
    double scale = 1;
    while (scale < 1048576 && 2 * scale * difference < 1) scale *= 2;
    return scale;
}

}  // namespace trilens
