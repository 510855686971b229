#include "inverse/unwrap/photo.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math/catmull_rom.h"

namespace trilens {
namespace {

/// use(index of the pixel, its weight) for the pixels of a bicubic sample that have any: at most sixteen.
template <typename Use>
void for_each_pixel(const Texture& photo, const Vec2& at, const Use& use) {
    const double x = at.x - 0.5, y = at.y - 0.5, left = std::floor(x), top = std::floor(y);
    const std::array<double, 4> across = catmull_rom(x - left), down = catmull_rom(y - top);
    std::array<std::size_t, 4> column{};
    for (std::size_t i = 0; i < 4; ++i)
        column[i] =
            static_cast<std::size_t>(std::clamp(left + static_cast<double>(i) - 1, 0.0, photo.width - 1.0));
    for (std::size_t j = 0; j < 4; ++j) {
        const auto row =
            static_cast<std::size_t>(std::clamp(top + static_cast<double>(j) - 1, 0.0, photo.height - 1.0));
        for (std::size_t i = 0; i < 4; ++i)
            if (const double weight = across[i] * down[j]; weight != 0)
                use(row * static_cast<std::size_t>(photo.width) + column[i], weight);
    }
}

Vec3 colour_of(const Texture& photo, std::size_t pixel) {
    const float* rgb = &photo.rgb[3 * pixel];
    return {rgb[0], rgb[1], rgb[2]};
}

/// The places whose bicubic samples make up the mean over a footprint.
struct FootprintPlaces {
    Vec2 at{0};
    Mat2 sides{0};
    int along = 1, down = 1;

    /// A pixel of the photograph is a mean over itself already: variances of boxes add up (L^2 / 12).
    FootprintPlaces(const Vec2& middle, const Mat2& jacobian) : at(middle), sides(jacobian) {
        std::array<int, 2> count{};
        for (int k = 0; k < 2; ++k) {
            const double whole = length(jacobian[k]), left = std::sqrt(std::max(0.0, whole * whole - 1));
            sides[k] = whole > 1 ? left / whole * jacobian[k] : Vec2(0);
            count[static_cast<std::size_t>(k)] =
                std::clamp(static_cast<int>(std::ceil(left - 0.25)), 1, kMostFootprint);
        }
        along = count[0], down = count[1];
    }

    /// use(place)
    template <typename Use>
    void for_each(const Use& use) const {
        if (along == 1 && down == 1) return use(at);
        for (int j = 0; j < down; ++j)
            for (int i = 0; i < along; ++i)
                use(at + sides * Vec2((i + 0.5) / along - 0.5, (j + 0.5) / down - 0.5));
    }
};

}  // namespace

Vec3 sample_bicubic(const Texture& photo, const Vec2& at) {
    Vec3 sum{0};
    for_each_pixel(photo, at,
                   [&](std::size_t pixel, double weight) { sum += weight * colour_of(photo, pixel); });
    return glm::max(sum, Vec3(0));
}

Vec3 sample_footprint(const Texture& photo, const Vec2& at, const Mat2& jacobian) {
    const FootprintPlaces places(at, jacobian);
    Vec3 sum{0};
    places.for_each([&](const Vec2& place) { sum += sample_bicubic(photo, place); });
    return sum / (double(places.along) * places.down);
}

float brightest_in_footprint(const Texture& photo, const Vec2& at, const Mat2& jacobian) {
    float brightest = 0;
    FootprintPlaces(at, jacobian).for_each([&](const Vec2& place) {
        for_each_pixel(photo, place, [&](std::size_t pixel, double) {
            const float* rgb = &photo.rgb[3 * pixel];
            brightest = std::max({brightest, rgb[0], rgb[1], rgb[2]});
        });
    });
    return brightest;
}

UsableMean sample_usable(const Texture& photo, const Texture& mask, const Vec2& at, const Mat2& jacobian) {
    UsableMean mean;
    double all = 0;
    FootprintPlaces(at, jacobian).for_each([&](const Vec2& place) {
        for_each_pixel(photo, place, [&](std::size_t pixel, double weight) {
            all += weight;
            if (mask.rgb[3 * pixel] < 0.5f) return;
            mean.colour += weight * colour_of(photo, pixel);
            mean.share += weight;
        });
    });
    mean.colour = mean.share > 0 ? glm::max(mean.colour / mean.share, Vec3(0)) : Vec3(0);
    mean.share /= all;
    return mean;
}

}  // namespace trilens
