// Straight ways between two points, several side by side: what asks for shadows.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "base/raymesh/ray_mesh.h"

namespace trilens {

/// Up to kMost open segments from + t * step, 0 < t < 1, in the world; those 0 .. count - 1 are set.
struct Segments {
    static constexpr std::size_t kMost = 32;
    using Bits = std::uint32_t;  // bit i: segment i
    static Bits bit(std::size_t i) { return Bits{1} << i; }

    alignas(64) double from[3][kMost] = {}, step[3][kMost] = {};  // x, y, z
    std::size_t count = 0;

    void add(const Vec3& start, const Vec3& way) {
        for (int k = 0; k < 3; ++k) from[k][count] = start[k], step[k][count] = way[k];
        ++count;
    }
    Bits all() const { return count < kMost ? (Bits{1} << count) - 1 : ~Bits{0}; }
    Ray ray(std::size_t i) const {
        return {{from[0][i], from[1][i], from[2][i]}, {step[0][i], step[1][i], step[2][i]}};
    }
};

/// Calls use(i) for every bit i that is set, in order.
template <typename Use>
void for_each_of(Segments::Bits bits, Use&& use) {
    for (; bits; bits &= bits - 1) use(static_cast<std::size_t>(std::countr_zero(bits)));
}

}  // namespace trilens
