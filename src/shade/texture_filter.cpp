#include "shade/texture_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kLeastTexels = 1.75;   // of a footprint's shorter side: beyond a level's own blur, sqrt(3)
constexpr double kMostAnisotropy = 32;  // how often a footprint may be as long as wide
constexpr double kPointTexels = 0.5;    // shorter sides are points
constexpr double kMostTexels = 1e9;     // longer sides than this are as good as infinite

/// What part a coarser texel has of each finer one along an axis: at most three, for sides that are odd.
struct Taps {
    int first = 0, count = 0;
    std::array<double, 3> share{};
};

std::vector<Taps> taps_of(int fine, int coarse) {
    std::vector<Taps> taps(static_cast<std::size_t>(coarse));
    const double width = double(fine) / coarse;
    for (int i = 0; i < coarse; ++i) {
        Taps& own = taps[static_cast<std::size_t>(i)];
        const double from = i * width, to = (i + 1) * width;
        own.first = static_cast<int>(from);
        double sum = 0;
        for (int k = own.first; k < fine && k < to && own.count < 3; ++k) {
            const double share = std::min(to, k + 1.0) - std::max(from, double(k));
            own.share[static_cast<std::size_t>(own.count++)] = share;
            sum += share;
        }
        for (double& share : own.share) share /= sum;
    }
    return taps;
}

/// Means over the areas of the coarser texels.
Texture halved(const Texture& fine) {
    Texture coarse;
    coarse.width = std::max(1, fine.width / 2);
    coarse.height = std::max(1, fine.height / 2);
    const std::size_t width = static_cast<std::size_t>(coarse.width),
                      height = static_cast<std::size_t>(coarse.height);
    coarse.rgb.resize(3 * width * height);
    const std::vector<Taps> across = taps_of(fine.width, coarse.width),
                            down = taps_of(fine.height, coarse.height);
    parallel_for(height, 16, [&](std::size_t from, std::size_t to) {
        for (std::size_t y = from; y < to; ++y)
            for (std::size_t x = 0; x < width; ++x) {
                Vec3 sum(0);
                for (int j = 0; j < down[y].count; ++j)
                    for (int i = 0; i < across[x].count; ++i)
                        sum += down[y].share[static_cast<std::size_t>(j)] *
                               across[x].share[static_cast<std::size_t>(i)] *
                               texel_at(fine, across[x].first + i, down[y].first + j);
                for (int c = 0; c < 3; ++c)
                    coarse.rgb[3 * (y * width + x) + static_cast<std::size_t>(c)] =
                        static_cast<float>(sum[c]);
            }
    });
    return coarse;
}

/// A square's image, a parallelogram, as the rectangle that it is when the square is turned by the angle at
/// which its image has right angles: the singular value decomposition of its two sides. Longer side first.
Footprint turned_square(Vec2 a, Vec2 b) {
    if (dot(a, a) < dot(b, b)) std::swap(a, b);
    const double difference = dot(a, a) - dot(b, b), mixed = 2 * dot(a, b);
    const double length = std::sqrt(difference * difference + mixed * mixed);
    if (!(length > 0)) return {a, b};
    // Half of the angle whose cosine and sine are (difference, mixed) / length.
    const double c = std::sqrt((1 + difference / length) / 2), s = mixed / length / (2 * c);
    return {c * a + s * b, c * b - s * a};
}

}  // namespace

std::size_t MipMap::level_count() const {
    std::size_t count = 1;
    for (int side = std::max(texture_->width, texture_->height); side > 1; side /= 2) ++count;
    return count;
}

const Texture& MipMap::level(std::size_t level) const {
    if (level == 0) return *texture_;
    return coarser_.get([&] {
        auto levels = std::make_unique<std::vector<Texture>>();
        levels->reserve(level_count() - 1);  // the next is made of the last, which must not move
        for (std::size_t l = 1; l < level_count(); ++l)
            levels->push_back(halved(l == 1 ? *texture_ : levels->back()));
        return levels;
    })[level - 1];
}

Vec3 lookup(const MipMap& map, const TextureSampler& wrap, const Vec2& place, const Footprint& footprint) {
    const Vec2 texels(map.texture()->width, map.texture()->height);
    const Footprint sides = turned_square(footprint[0] * texels, footprint[1] * texels);
    double longer = length(sides[0]), shorter = length(sides[1]);
    if (longer <= kPointTexels) return lookup(*map.texture(), wrap, place);
    // Also where a side is no number: the mean of the whole picture.
    if (!(longer < kMostTexels && shorter <= longer))
        return lookup(map.level(map.level_count() - 1), wrap, place);

    // The finest level at which the footprint is less than twice as wide as it must be.
    std::size_t level = 0;
    for (double width = std::max(shorter, longer / kMostAnisotropy);
         width >= 2 * kLeastTexels && level + 1 < map.level_count(); width /= 2) {
        ++level;
        longer /= 2;
        shorter /= 2;
    }
    // A level's texels are means, and are interpolated: both blur, by this much of a side's square more than
    // the picture's own do. The places looked up have the second moments of what is left of the sides.
    const double blur = 3 * (1 - std::ldexp(1.0, -2 * static_cast<int>(level)));
    const auto places = [blur](double side) {
        const double rest = std::sqrt(std::max(0.0, side * side - blur));
        if (rest <= kPointTexels) return std::pair(1, 0.0);
        const int count = static_cast<int>(std::ceil(rest)) + 1;
        return std::pair(count, rest / side / std::sqrt(double(count) * count - 1));
    };
    const auto [along, apart_along] = places(longer);
    const auto [across, apart_across] = places(shorter);
    const Texture& seen = map.level(level);
    const Vec2 step_along = apart_along * sides[0] / texels, step_across = apart_across * sides[1] / texels;
    Vec3 sum(0);
    for (int j = 0; j < across; ++j)
        for (int i = 0; i < along; ++i)
            sum +=
                lookup(seen, wrap,
                       place + (i + 0.5 - 0.5 * along) * step_along + (j + 0.5 - 0.5 * across) * step_across);
    return sum / double(along * across);
}

namespace {

constexpr TextureSampler kAroundSphere{Wrap::kRepeat, Wrap::kClampToEdge};

Vec2 place_of_direction(const Vec3& unit) {
    return {0.5 + std::atan2(unit.x, -unit.z) / (2 * kPi),
            1 - std::acos(std::clamp(unit.y, -1.0, 1.0)) / kPi};
}

}  // namespace

Vec3 lookup_latitude_longitude(const Texture& texture, const Vec3& direction) {
    return lookup(texture, kAroundSphere, place_of_direction(normalize_or_zero(direction)));
}

Vec3 lookup_latitude_longitude(const MipMap& map, const Vec3& direction, const std::array<Vec3, 2>& sides) {
    const Vec3 unit = normalize_or_zero(direction);
    std::array<Vec3, 2> turn;
    for (std::size_t k = 0; k < 2; ++k) {
        turn[k] = sides[k] / length(direction);
        turn[k] -= dot(turn[k], unit) * unit;
    }
    // Near a pole the footprint holds all longitudes, not more.
    const double reach2 = (dot(turn[0], turn[0]) + dot(turn[1], turn[1])) / 4;
    const double across2 = std::max({unit.x * unit.x + unit.z * unit.z, reach2, 1e-30});
    Footprint footprint;
    for (std::size_t k = 0; k < 2; ++k)
        footprint[k] = {(unit.x * turn[k].z - unit.z * turn[k].x) / across2 / (2 * kPi),
                        turn[k].y / std::sqrt(across2) / kPi};
    return lookup(map, kAroundSphere, place_of_direction(unit), footprint);
}

}  // namespace trilens
