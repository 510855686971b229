// Random inputs of tests: fixed seeds, the same numbers with every standard library.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/math/vec.h"

namespace trilens_test {

/// A stream of numbers (splitmix64).
class Draw {
  public:
    explicit Draw(std::uint64_t seed) : state_(seed) {}

    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(next() >> 11) * 0x1p-53);
    }
    double log_uniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }

    trilens::Vec3 in_cube(double half_side) {
        const double x = uniform(-half_side, half_side), y = uniform(-half_side, half_side);
        return {x, y, uniform(-half_side, half_side)};
    }
    trilens::Vec3 unit() {
        for (;;) {
            const trilens::Vec3 v = in_cube(1);
            const double size = length(v);
            if (size > 0.1 && size < 1) return v / size;
        }
    }
    /// Any direction, length in [low, high). One call per draw: a product of two draws has no fixed order.
    trilens::Vec3 away(double low, double high) {
        const trilens::Vec3 direction = unit();
        return uniform(low, high) * direction;
    }
    /// x and y in [-half_side, half_side), z log-uniform in [low, high).
    trilens::Vec3 above(double half_side, double low, double high) {
        const trilens::Vec3 across = in_cube(half_side);
        return {across.x, across.y, log_uniform(low, high)};
    }
    /// Weights of a point inside a triangle.
    trilens::Vec3 weights() {
        const double a = uniform(0, 1), b = uniform(0, 1);
        return a + b < 1 ? trilens::Vec3(1 - a - b, a, b) : trilens::Vec3(a + b - 1, 1 - a, 1 - b);
    }

  private:
    std::uint64_t next() {
        std::uint64_t x = state_ += 0x9e3779b97f4a7c15u;
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
        x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
        return x ^ (x >> 31);
    }
    std::uint64_t state_;
};

}  // namespace trilens_test
