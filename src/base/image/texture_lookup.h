// Bilinear look-ups in pictures, beyond their edges as glTF's samplers have it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/description/material.h"
#include "base/math/vec.h"

namespace trilens {

/// As std::floor; a call costs more than all the rest of a look-up.
inline double floor_of(double x) {
    if (!(std::fabs(x) < 0x1p52)) return std::floor(x);
    const double whole = static_cast<double>(static_cast<long long>(x));
    return whole > x ? whole - 1 : whole;
}

/// The texel that stands for one beyond the picture's edge.
inline int wrapped_texel(long long index, int size, Wrap wrap) {
    if (index >= 0 && index < size) return static_cast<int>(index);  // mostly, and a division is slow
    if (wrap == Wrap::kClampToEdge) return index < 0 ? 0 : size - 1;
    const long long period = wrap == Wrap::kMirroredRepeat ? 2LL * size : size;
    const long long rest = (index % period + period) % period;
    return static_cast<int>(rest < size ? rest : period - 1 - rest);
}

/// A coordinate moved by whole periods, so that texels far away stay within integers.
inline double reduced_place(double x, Wrap wrap) {
    switch (wrap) {
        case Wrap::kRepeat:
            return x - floor_of(x);
        case Wrap::kMirroredRepeat:
            return x - 2 * floor_of(x / 2);
        case Wrap::kClampToEdge:
            return std::clamp(x, -1.0, 2.0);
    }
    return x;
}

inline Vec3 texel_at(const Texture& texture, int x, int y) {
    const float* rgb =
        &texture.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(texture.width) +
                          static_cast<std::size_t>(x))];
    return {rgb[0], rgb[1], rgb[2]};
}

/// Between the four texels around a place; at(texture, x, y): what of a texel is asked for.
template <typename At>
auto bilinear_lookup(const Texture& texture, const TextureSampler& wrap, const Vec2& place, const At& at) {
    const double x = reduced_place(place.x, wrap.wrap_s) * texture.width - 0.5,
                 y = (1 - reduced_place(place.y, wrap.wrap_t)) * texture.height - 0.5;
    const double left = floor_of(x), top = floor_of(y);
    const double fx = x - left, fy = y - top;
    const auto column = [&](long long i) { return wrapped_texel(i, texture.width, wrap.wrap_s); };
    const auto row = [&](long long j) { return wrapped_texel(j, texture.height, wrap.wrap_t); };
    const int x0 = column(static_cast<long long>(left)), x1 = column(static_cast<long long>(left) + 1);
    const int y0 = row(static_cast<long long>(top)), y1 = row(static_cast<long long>(top) + 1);
    return (1 - fy) * ((1 - fx) * at(texture, x0, y0) + fx * at(texture, x1, y0)) +
           fy * ((1 - fx) * at(texture, x0, y1) + fx * at(texture, x1, y1));
}

/// Bilinear look-up at a place of the picture: x to the right, y upward, both 0 to 1 from its bottom left.
inline Vec3 lookup(const Texture& texture, const TextureSampler& wrap, const Vec2& place) {
    return bilinear_lookup(texture, wrap, place, texel_at);
}

/// The same of its alpha; the picture has some.
inline double lookup_alpha(const Texture& texture, const TextureSampler& wrap, const Vec2& place) {
    return bilinear_lookup(texture, wrap, place, [](const Texture& of, int x, int y) {
        return static_cast<double>(of.alpha[static_cast<std::size_t>(y) * static_cast<std::size_t>(of.width) +
                                            static_cast<std::size_t>(x)]);
    });
}

}  // namespace trilens
