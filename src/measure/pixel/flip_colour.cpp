#include "measure/pixel/flip_colour.h"

#include <cstddef>

namespace trilens {
namespace {

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

}  // namespace

// The same form makes L*a*b* of cube roots.
Colour ycxcz_of_relative(const Colour& v) {
    return {116 * v[1] - 16, 500 * (v[0] - v[1]), 200 * (v[1] - v[2])};
}

Colour relative_to_white(const Colour& rgb) {
    Colour v = times(kXyzOfRgb, rgb);
    for (std::size_t i = 0; i < 3; ++i) v[i] /= kWhite[i];
    return v;
}

Colour rgb_of_ycxcz(const Colour& c) {
    const double y = (c[0] + 16) / 116;
    return times(kRgbOfXyz, {(y + c[1] / 500) * kWhite[0], y * kWhite[1], (y - c[2] / 200) * kWhite[2]});
}

Colour hunt_lab(const Colour& rgb) {
    constexpr double kDelta = 6.0 / 29;
    Colour v = relative_to_white(rgb);
    for (double& x : v)
        x = x > kDelta * kDelta * kDelta ? std::cbrt(x) : x / (3 * kDelta * kDelta) + 4.0 / 29;
    const Colour lab = ycxcz_of_relative(v);
    return {lab[0], 0.01 * lab[0] * lab[1], 0.01 * lab[0] * lab[2]};
}

}  // namespace trilens
