// Structural similarity of two grey pictures (Wang, Bovik, Sheikh, Simoncelli, Image Quality Assessment,
// 2004).
#pragma once

#include <cstdint>
#include <span>

namespace trilens {

/// One grey value per pixel, rows from the top.
struct GreyPicture {
    int width = 0, height = 0;
    std::span<const double> values;
};

/// The mean over the pixels with counted != 0 of
///   (2 mx my + C1)(2 sxy + C2) / ((mx^2 + my^2 + C1)(sx^2 + sy^2 + C2)),  C1 = 0.01^2, C2 = 0.03^2 (peak 1),
/// with moments under an 11 x 11 Gaussian window of sigma 1.5 round the pixel. Windows are clipped at the
/// picture's border and their weights made to sum to one, so every pixel has a value (the paper drops a
/// border of 5 pixels). A pixel that is not finite in either picture belongs to no window and has no value.
/// Values beyond 0..1 are taken as they are. 1 for equal pictures, and where no pixel counts.
double structural_similarity(const GreyPicture& a, const GreyPicture& b,
                             std::span<const std::uint8_t> counted);

}  // namespace trilens
