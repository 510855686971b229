// Laws of filtered textures: means are kept, footprints agree with sums over them, edges follow the wrap
// modes.
#include "shade/texture_filter.h"

#include <cmath>
#include <functional>

#include "shade/material_maps.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::shared_ptr<const Texture> picture(int width, int height,
                                       const std::function<double(double, double)>& at) {
    auto texture = std::make_shared<Texture>();
    texture->width = width;
    texture->height = height;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double value = at((x + 0.5) / width, 1 - (y + 0.5) / height);
            for (int c = 0; c < 3; ++c) texture->rgb.push_back(static_cast<float>(value));
        }
    return texture;
}

std::shared_ptr<const Texture> checkerboard(int texels, int squares) {
    return picture(texels, texels, [&](double u, double v) {
        return (static_cast<int>(u * squares) + static_cast<int>(v * squares)) % 2;
    });
}

/// Rings ever finer from the middle out: half of the texels' frequency at the middle of the sides.
std::shared_ptr<const Texture> zone_plate(int texels) {
    return picture(texels, texels, [&](double u, double v) {
        const double r2 = (u - 0.5) * (u - 0.5) + (v - 0.5) * (v - 0.5);
        return 0.5 + 0.5 * std::cos(3.14159265358979 * texels * r2);
    });
}

double mean_of(const Texture& texture) {
    double sum = 0;
    for (const float value : texture.rgb) sum += value;
    return sum / static_cast<double>(texture.rgb.size());
}

/// The sum over a footprint, place by place.
double brute_mean(const Texture& texture, const TextureSampler& wrap, const Vec2& place,
                  const Footprint& footprint) {
    constexpr int kSide = 64;
    double sum = 0;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i)
            sum += lookup(texture, wrap,
                          place + ((i + 0.5) / kSide - 0.5) * footprint[0] +
                              ((j + 0.5) / kSide - 0.5) * footprint[1])
                       .x;
    return sum / (kSide * kSide);
}

}  // namespace

TEST_CASE("each level of a mip map has the picture's mean", "[shade][law][textures]") {
    for (const auto& [width, height] : {std::pair(64, 64), {37, 21}, {5, 64}, {1, 9}, {1, 1}, {100, 3}}) {
        Draw random(static_cast<std::uint64_t>(width * 100 + height));
        const auto texture = picture(width, height, [&](double, double) { return random.uniform(0, 4); });
        const MipMap map(texture);
        const double mean = mean_of(*texture);
        for (std::size_t l = 0; l < map.level_count(); ++l)
            CHECK(mean_of(map.level(l)) == Approx(mean).epsilon(1e-5));
        CHECK(map.level(map.level_count() - 1).width == 1);
        CHECK(map.level(map.level_count() - 1).height == 1);
    }
}

TEST_CASE("a filtered look-up is the mean over its footprint", "[shade][law][textures]") {
    // How far look-ups may be off, of a picture whose values deviate by 0.5 (checkerboard) or 0.35.
    struct Case {
        std::shared_ptr<const Texture> texture;
        double rms, bias;
    };
    for (const Case& one : {Case{checkerboard(256, 64), 0.012, 0.003},
                            {zone_plate(256), 0.007, 0.003},
                            {picture(256, 256, [](double u, double) { return u; }), 0.006, 0.003}}) {
        const MipMap map(one.texture);
        Draw random(7);
        double square = 0, sum = 0;
        constexpr int kCount = 3000;
        for (int k = 0; k < kCount; ++k) {
            // From a fifth of a texel to half of the picture, at any angle, sheared, up to 20 times as long
            // as wide.
            const double longer = random.log_uniform(0.2 / 256, 0.5);
            const double angle = random.uniform(0, 6.3), skew = angle + random.uniform(0.3, 2.8);
            const double shorter = longer * random.log_uniform(0.05, 1);
            const Footprint footprint{longer * Vec2(std::cos(angle), std::sin(angle)),
                                      shorter * Vec2(std::cos(skew), std::sin(skew))};
            const Vec2 place(random.uniform(-1, 2), random.uniform(-1, 2));
            const double off =
                lookup(map, {}, place, footprint).x - brute_mean(*one.texture, {}, place, footprint);
            square += off * off / kCount;
            sum += off / kCount;
        }
        INFO("rms " << std::sqrt(square) << ", bias " << sum);
        CHECK(std::sqrt(square) < one.rms);
        CHECK(std::fabs(sum) < one.bias);
    }
}

TEST_CASE("where texels are as large as pixels a filtered look-up is the mean over the parallelogram itself",
          "[shade][law][textures]") {
    const auto texture = checkerboard(256, 64);
    const MipMap map(texture);
    Draw random(23);
    double square = 0, most = 0;
    constexpr int kCount = 2000;
    for (int k = 0; k < kCount; ++k) {
        const double side = random.log_uniform(0.2, 2) / 256, angle = random.uniform(0, 6.3);
        const double other = side * random.uniform(0.5, 2), skew = angle + random.uniform(0.8, 2.3);
        const Footprint footprint{side * Vec2(std::cos(angle), std::sin(angle)),
                                  other * Vec2(std::cos(skew), std::sin(skew))};
        const Vec2 place(random.uniform(-1, 2), random.uniform(-1, 2));
        const double off =
            std::fabs(lookup(map, {}, place, footprint).x - brute_mean(*texture, {}, place, footprint));
        square += off * off / kCount;
        most = std::max(most, off);
    }
    INFO("rms " << std::sqrt(square) << ", most " << most);
    CHECK(std::sqrt(square) < 0.001);
    CHECK(most < 0.01);
}

TEST_CASE("filtered look-ups stay finite and within the picture's values, whatever the footprint",
          "[shade][law][textures]") {
    const auto texture = checkerboard(32, 8);
    const MipMap map(texture);
    Draw random(11);
    std::size_t outside = 0;
    const double extremes[] = {0, 1e-300, 1e-9, 1, 1e9, 1e300, INFINITY, NAN};
    for (int k = 0; k < 2000; ++k) {
        const auto extreme = [&] {
            return extremes[static_cast<std::size_t>(random.uniform(0, 8))] * random.uniform(-1, 1);
        };
        const Footprint footprint{Vec2(extreme(), extreme()), Vec2(extreme(), extreme())};
        const TextureSampler wrap{static_cast<Wrap>(static_cast<int>(random.uniform(0, 3))),
                                  static_cast<Wrap>(static_cast<int>(random.uniform(0, 3)))};
        const double place = random.log_uniform(1e-9, 1e9);
        const double value = lookup(map, wrap, {place, -place}, footprint).x;
        outside += !(value >= 0 && value <= 1 + 1e-15);  // but for rounding
    }
    CHECK(outside == 0);
}

TEST_CASE("a footprint of many repeats is the picture's mean, and asks no more than one of few",
          "[shade][law][textures]") {
    for (const auto& [width, height] : {std::pair(8, 8), {8, 1}, {1, 1}, {5, 3}}) {
        const MipMap map(picture(width, height, [](double u, double v) { return u + 0.3 * v; }));
        const double mean = mean_of(*map.texture());
        // Texel by texel, the longest would take an hour.
        for (const double repeats : {3e2, 1e5, 1e7}) {
            CAPTURE(width, height, repeats);
            const Footprint sides{Vec2(repeats, 0.1 * repeats), Vec2(-0.2 * repeats, repeats)};
            CHECK(lookup(map, {}, Vec2(0.3, 0.7), sides).x == Approx(mean).epsilon(1e-5));
        }
    }
}

TEST_CASE("a normal map's mean is that of the normals between its texels, too, whatever the footprint",
          "[shade][law][textures]") {
    Draw draw(71);
    auto raw = std::make_shared<Texture>();
    raw->width = raw->height = 32;
    for (int i = 0; i < 32 * 32; ++i) {
        Vec3 normal(0, 0, 1);  // one draw after the other: compilers order arguments each in their way
        for (int k = 0; k < 2; ++k) normal[k] = draw.uniform(-1, 1);
        normal = normalize(normal);
        for (int k = 0; k < 3; ++k) raw->rgb.push_back(static_cast<float>(0.5 + 0.5 * normal[k]));
    }
    const TextureSampler wrap{};
    const auto at = [&](const Vec2& place) { return normal_of_texel(lookup(*raw, wrap, place), 1); };
    const MipMap means(normals_of(*raw, 1));
    double shortest = 1, square = 0, longer = 0;
    constexpr int kCount = 200;
    for (int trial = 0; trial < kCount; ++trial) {
        Vec2 place;
        place.x = draw.uniform(0, 1);
        place.y = draw.uniform(0, 1);
        const double texels = trial < 20 ? 0 : draw.log_uniform(0.01, 24), side = texels / 32;
        Vec3 brute(0);
        constexpr int kPlaces = 60;
        for (int j = 0; j < kPlaces; ++j)
            for (int i = 0; i < kPlaces; ++i)
                brute += at(place + side * (Vec2(i + 0.5, j + 0.5) / double(kPlaces) - Vec2(0.5)));
        brute /= double(kPlaces * kPlaces);
        const Vec3 mean = lookup(means, wrap, {place, {Vec2(side, 0), Vec2(0, side)}}, at);
        CAPTURE(texels, length(brute), length(mean));
        if (texels < 0.05) CHECK(length(mean) == Approx(1).margin(1e-3));
        // Wider ones are looked up in the means, as other pictures are.
        if (texels < 8) CHECK(length(mean - brute) < 0.02);
        square += dot(mean - brute, mean - brute) / kCount;
        longer += (length(mean) - length(brute)) / kCount;
        shortest = std::min(shortest, length(mean));
    }
    CHECK(shortest < 0.9);
    // Of all, and in the mean, as near as look-ups of other pictures must be, whose values deviate by 0.5; of
    // normals it is 0.7.
    INFO("rms " << std::sqrt(square) << ", bias " << longer);
    CHECK(std::sqrt(square) < 0.012);
    CHECK(std::fabs(longer) < 0.003);
}

TEST_CASE("pictures repeat, are mirrored, or end in their edges, as the sampler says", "[shade][textures]") {
    const auto texture = picture(8, 8, [](double u, double v) { return u + 10 * v; });
    const auto at = [&](Wrap s, Wrap t, double u, double v) { return lookup(*texture, {s, t}, {u, v}).x; };
    const double inside = at(Wrap::kRepeat, Wrap::kRepeat, 0.3, 0.7);
    CHECK(inside == Approx(7.3));
    CHECK(at(Wrap::kRepeat, Wrap::kRepeat, 3.3, -1.3) == Approx(inside));
    CHECK(at(Wrap::kMirroredRepeat, Wrap::kMirroredRepeat, 1.7, -0.7) == Approx(inside));
    CHECK(at(Wrap::kMirroredRepeat, Wrap::kMirroredRepeat, 2.3, 2.7) == Approx(inside));
    CHECK(at(Wrap::kClampToEdge, Wrap::kRepeat, 7, 0.7) == Approx(15.0 / 16 + 7));
    CHECK(at(Wrap::kClampToEdge, Wrap::kClampToEdge, -5, 1e12) == Approx(1.0 / 16 + 10 * 15.0 / 16));
    // Across an edge: the mean of both sides where it repeats, the edge's own where it is mirrored.
    CHECK(at(Wrap::kRepeat, Wrap::kClampToEdge, 1, 0.7) == Approx(0.5 + 7));
    CHECK(at(Wrap::kMirroredRepeat, Wrap::kClampToEdge, 1, 0.7) == Approx(15.0 / 16 + 7));
}

TEST_CASE("a texture's transform is KHR_texture_transform's", "[shade][textures]") {
    // The extension's own matrices, of uv with v downward.
    Draw random(3);
    for (int k = 0; k < 50; ++k) {
        TextureTransform transform;
        transform.offset = {random.uniform(-2, 2), random.uniform(-2, 2)};
        transform.scale = {random.uniform(-2, 2), random.uniform(-2, 2)};
        transform.rotation = random.uniform(-4, 4);
        TextureSampler sampler;
        set_transform(transform, sampler);
        const Vec2 uv(random.uniform(-1, 1), random.uniform(-1, 1));
        const double c = std::cos(transform.rotation), s = std::sin(transform.rotation);
        const Vec2 scaled = transform.scale * Vec2(uv.x, 1 - uv.y);
        const Vec2 down = transform.offset + Vec2(c * scaled.x + s * scaled.y, -s * scaled.x + c * scaled.y);
        const Vec2 place = sampler.place(uv);
        CHECK(place.x == Approx(down.x).margin(1e-12));
        CHECK(place.y == Approx(1 - down.y).margin(1e-12));
    }
    TextureSampler identity;
    set_transform({}, identity);
    CHECK(identity.place({0.25, 0.75}) == Vec2(0.25, 0.75));
}

TEST_CASE("a filtered background is the mean over its footprint, at the poles too",
          "[shade][law][textures]") {
    const auto sky = picture(256, 128, [](double u, double v) {
        return 0.5 + 0.5 * std::cos(40 * u * 6.2831853) * std::sin(60 * v);
    });
    const MipMap map(sky);
    Draw random(5);
    double square = 0;
    constexpr int kCount = 400;
    for (int k = 0; k < kCount; ++k) {
        const Vec3 direction = random.unit() * random.uniform(0.1, 9);
        const Vec3 side = cross(normalize_or_zero(direction), random.unit()) * length(direction);
        const double reach = random.log_uniform(0.01, 0.3);
        const std::array<Vec3, 2> sides{reach * side, reach * cross(normalize_or_zero(direction), side)};
        double sum = 0;
        for (int j = 0; j < 32; ++j)
            for (int i = 0; i < 32; ++i)
                sum += lookup_latitude_longitude(*sky, direction + ((i + 0.5) / 32 - 0.5) * sides[0] +
                                                           ((j + 0.5) / 32 - 0.5) * sides[1])
                           .x;
        const double off = lookup_latitude_longitude(map, direction, sides).x - sum / 1024;
        square += off * off / kCount;
    }
    INFO("rms " << std::sqrt(square));
    CHECK(std::sqrt(square) < 0.05);
}
