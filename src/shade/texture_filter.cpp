#include "shade/texture_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kLeastTexels = 4;   // of a footprint's shorter side: beyond a level's own blur, sqrt(3)
constexpr double kMostAnisotropy = 32;  // how often a footprint may be as long as wide
constexpr double kPointTexels = 0.05;   // shorter sides are points
constexpr double kPlacesPerTexel = 4;   // along a side, while it is short; then one
constexpr double kMorePlaces = 6;       // than one per texel, at most
constexpr int kMostWindow = 256;        // texels that are weighed
constexpr int kMostSlanted = 2;  // how many times as many places its parallelogram may take as its rectangle

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

/// Places in rows, evenly about a middle.
struct Lattice {
    Footprint steps{};
    std::array<int, 2> counts{1, 1};

    int size() const { return counts[0] * counts[1]; }
    Vec2 offset(int i, int j) const {
        return (i + 0.5 - 0.5 * counts[0]) * steps[0] + (j + 0.5 - 0.5 * counts[1]) * steps[1];
    }
};

/// Over a parallelogram whose sides are in texels, with its second moments.
Lattice lattice_over(const Footprint& sides) {
    Lattice lattice;
    for (std::size_t k = 0; k < 2; ++k) {
        const double texels = length(sides[k]);
        if (texels <= kPointTexels) continue;
        const int count =
            static_cast<int>(std::ceil(texels + std::min((kPlacesPerTexel - 1) * texels, kMorePlaces))) + 1;
        lattice.counts[k] = count;
        lattice.steps[k] = sides[k] / std::sqrt(double(count) * count - 1);
    }
    return lattice;
}

template <typename At>
Vec3 mean_of_lookups(const Vec2& middle, const Lattice& lattice, const At& at) {
    Vec3 sum(0);
    for (int j = 0; j < lattice.counts[1]; ++j)
        for (int i = 0; i < lattice.counts[0]; ++i) sum += at(middle + lattice.offset(i, j));
    return sum / double(lattice.size());
}

/// The mean of look-ups at a lattice's places. Neighbouring places share their texels: first it is found how
/// much each texel of a window weighs.
Vec3 mean_at(const Texture& texture, const TextureSampler& wrap, const Vec2& middle, const Lattice& lattice) {
    const Vec2 size(texture.width, -texture.height);  // rows go downward
    const Footprint steps{lattice.steps[0] * size, lattice.steps[1] * size};
    const Vec2 reach = 0.5 * (double(lattice.counts[0] - 1) * glm::abs(steps[0]) +
                              double(lattice.counts[1] - 1) * glm::abs(steps[1]));
    const Vec2 at(reduced_place(middle.x, wrap.wrap_s) * size.x - 0.5,
                  (reduced_place(middle.y, wrap.wrap_t) - 1) * size.y - 0.5);
    const double left = floor_of(at.x - reach.x), top = floor_of(at.y - reach.y);
    const double columns = floor_of(at.x + reach.x) - left + 2, rows = floor_of(at.y + reach.y) - top + 2;
    // Far from a picture whose edges go on forever, its place is reduced to one picture away.
    if (!(columns * rows <= kMostWindow && reach.x <= texture.width && reach.y <= texture.height))
        return mean_of_lookups(middle, lattice,
                               [&](const Vec2& place) { return lookup(texture, wrap, place); });

    std::array<double, kMostWindow> weights;
    const int width = static_cast<int>(columns), height = static_cast<int>(rows);
    std::fill_n(weights.begin(), width * height, 0.0);
    const Vec2 first =
        at - Vec2(left, top) -
        0.5 * (double(lattice.counts[0] - 1) * steps[0] + double(lattice.counts[1] - 1) * steps[1]);
    for (int j = 0; j < lattice.counts[1]; ++j)
        for (int i = 0; i < lattice.counts[0]; ++i) {
            const Vec2 place = glm::max(first + double(i) * steps[0] + double(j) * steps[1], Vec2(0));
            const int x = std::min(static_cast<int>(place.x), width - 2),
                      y = std::min(static_cast<int>(place.y), height - 2);
            const double fx = place.x - x, fy = place.y - y;
            double* const weight = &weights[static_cast<std::size_t>(y * width + x)];
            weight[0] += (1 - fx) * (1 - fy);
            weight[1] += fx * (1 - fy);
            weight[width] += (1 - fx) * fy;
            weight[width + 1] += fx * fy;
        }
    Vec3 sum(0);
    for (int y = 0; y < height; ++y) {
        const int row = wrapped_texel(static_cast<long long>(top) + y, texture.height, wrap.wrap_t);
        for (int x = 0; x < width; ++x) {
            const double weight = weights[static_cast<std::size_t>(y * width + x)];
            if (weight == 0) continue;
            sum += weight *
                   texel_at(texture,
                            wrapped_texel(static_cast<long long>(left) + x, texture.width, wrap.wrap_s), row);
        }
    }
    return sum / double(lattice.size());
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

namespace {

/// Where a footprint is looked at.
struct Look {
    std::size_t level = 0;  // of a mip map
    Lattice lattice{};      // about its place
};

Look look_at(const MipMap& map, const Footprint& footprint) {
    const Vec2 texels(map.texture()->width, map.texture()->height);
    Footprint sides{footprint[0] * texels, footprint[1] * texels};
    Footprint turned = turned_square(sides[0], sides[1]);
    const double longer = length(turned[0]), shorter = length(turned[1]);
    if (longer <= kPointTexels) return {};
    // Also where a side is no number: the mean of the whole picture.
    if (!(std::isfinite(longer) && shorter <= longer)) return {map.level_count() - 1};

    // The finest level at which the footprint is less than twice as wide as it must be.
    std::size_t level = 0;
    double shrunk = 1;
    for (double width = std::max(shorter, longer / kMostAnisotropy);
         width >= 2 * kLeastTexels && level + 1 < map.level_count(); width /= 2) {
        ++level;
        shrunk /= 2;
    }
    if (level + 1 == map.level_count()) return {level};  // of one texel
    // A level's texels are means, and are interpolated: both blur, by this much of a side's square more than
    // the picture's own do. What is left of the rectangle's sides is left of the parallelogram along them.
    const double blur = 3 * (1 - shrunk * shrunk);
    const auto left_of = [&](double side) {
        return std::sqrt(std::max(0.0, side * side * shrunk * shrunk - blur)) / side;
    };
    const double left_along = left_of(longer), left_across = shorter > 0 ? left_of(shorter) : 0;
    for (Vec2& side : sides) {
        const Vec2 along = dot(side, turned[0]) / (longer * longer) * turned[0];
        side = left_along * along + left_across * (side - along);
    }
    turned = {left_along * turned[0], left_across * turned[1]};
    const Lattice of_sides = lattice_over(sides), of_turned = lattice_over(turned);
    const Lattice& lattice = of_sides.size() <= kMostSlanted * of_turned.size() ? of_sides : of_turned;
    const Vec2 to_place = 1.0 / (shrunk * texels);
    return {level, {{lattice.steps[0] * to_place, lattice.steps[1] * to_place}, lattice.counts}};
}

Vec3 mean_of(const MipMap& map, const TextureSampler& wrap, const Vec2& place, const Look& look) {
    const Texture& texture = map.level(look.level);
    return look.lattice.size() == 1 ? lookup(texture, wrap, place)
                                    : mean_at(texture, wrap, place, look.lattice);
}

}  // namespace

Vec3 lookup(const MipMap& map, const TextureSampler& wrap, const Vec2& place, const Footprint& footprint) {
    return mean_of(map, wrap, place, look_at(map, footprint));
}

Vec3 lookup(const MipMap& means, const TextureSampler& wrap, const FootprintAt& footprint,
            const std::function<Vec3(const Vec2& place)>& at) {
    const Look look = look_at(means, footprint.sides);
    return look.level > 0 ? mean_of(means, wrap, footprint.place, look)
                          : mean_of_lookups(footprint.place, look.lattice, at);
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
