#include "shade/microfacets.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "shade/lights/light_sample.h"

namespace trilens {
namespace {

double fraction(double x) {
    return x - std::floor(x);
}

/// Steps of the sequence at later meetings: square roots of primes, two for each; then again the first.
constexpr std::array<double, 12> kPrimes{2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};

}  // namespace

double ggx_distribution(double alpha2, double cos_half) {
    const double f = cos_half * cos_half * (alpha2 - 1) + 1;
    return alpha2 / (std::numbers::pi * f * f);
}

double ggx_masking(double alpha2, double cosine) {
    return 2 * cosine / (cosine + std::sqrt(alpha2 + (1 - alpha2) * cosine * cosine));
}

Vec3 visible_normal(const RoughSurface& surface, const Vec2& place) {
    const auto [u, v] = tangent_basis(surface.normal);
    const double alpha = surface.alpha;
    // Stretched along the normal the microfacets are those of a hemisphere, of which the viewer sees a disk
    // that is cut off by the horizon.
    const Vec3 view = normalize_or_zero(Vec3(alpha * dot(surface.view, u), alpha * dot(surface.view, v),
                                             std::max(dot(surface.view, surface.normal), 0.0)));
    const double across = std::hypot(view.x, view.y);
    const Vec3 first = across > 0 ? Vec3(-view.y, view.x, 0) / across : Vec3(1, 0, 0);
    const Vec3 second = cross(view, first);
    const Vec2 disk = disk_place(place);
    const double half = std::sqrt(std::max(1 - disk.x * disk.x, 0.0)), lit = (1 + view.z) / 2;
    const double along = (1 - lit) * half + lit * disk.y;
    const double up = std::sqrt(std::max(1 - disk.x * disk.x - along * along, 0.0));
    const Vec3 bent = disk.x * first + along * second + up * view;
    return normalize_or_zero(alpha * bent.x * u + alpha * bent.y * v +
                             std::max(bent.z, 0.0) * surface.normal);
}

double visible_density(const RoughSurface& surface, const Vec3& microfacet) {
    const double alpha2 = surface.alpha * surface.alpha;
    const double cos_view = std::max(dot(surface.view, surface.normal), kLeastViewCosine);
    return ggx_masking(alpha2, cos_view) * ggx_distribution(alpha2, dot(surface.normal, microfacet)) *
           std::max(dot(surface.view, microfacet), 0.0) / cos_view;
}

Vec2 RoughWay::place(std::size_t meeting) const {
    const Vec2 inside = recurrent_place(shift);
    if (meeting == 0) {
        const Vec2 middle = stratified_place(sample, count);
        const auto columns = static_cast<double>(count),
                   rows = static_cast<double>(std::size_t{1} << std::bit_width(count - 1));
        return middle + Vec2((inside.x - 0.5) / columns, (inside.y - 0.5) / rows);
    }
    const std::size_t at = 2 * ((meeting - 1) % (kPrimes.size() / 2));
    const auto step = static_cast<double>(sample);
    return {fraction(inside.x + step * std::sqrt(kPrimes[at])),
            fraction(inside.y + step * std::sqrt(kPrimes[at + 1]))};
}

}  // namespace trilens
