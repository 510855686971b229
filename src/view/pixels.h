// Pictures as bytes for a screen: tone mapping, differences, heat maps with their scale, tints and outlines.
#pragma once

#include <trilens/compare.h>
#include <trilens/image.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace trilens {

/// Rows from the top, four bytes a pixel: red, green, blue (sRGB) and alpha (0..255, not premultiplied).
struct Pixels {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgba;

    bool empty() const { return rgba.empty(); }
};

/// A layer's colours as a screen shows them; black where the image has no such layer. `layer`: empty for the
/// beauty.
Pixels tone_pixels(const Image& image, const std::string& layer, const ToneMapping& tone);

/// |test - reference| of a layer times `scale`, as sRGB. Throws InputError where the two cannot be compared.
Pixels difference_pixels(const Image& reference, const Image& test, const std::string& layer, double scale);

/// Values 0..`most` as colours from black over red and yellow to white; not-a-number as mid-grey: nothing was
/// measured there. `values`: one for each pixel.
Pixels heat_pixels(std::span<const float> values, int width, int height, double most);

/// The same colour, of a share 0..1, as bytes.
std::array<std::uint8_t, 3> heat_colour(double share);

/// Displacements of all layers in pixels: of each pixel the largest that was measured; NaN where none was.
std::vector<float> displacement_lengths(const std::vector<LayerComparison>& layers, std::size_t pixels);

/// A rounded number at least as large as nearly all (99 %) of the values that are numbers: the end of a heat
/// map's scale. 1 where there are none above 0.
double scale_end(std::span<const float> values);

/// What is drawn over a picture: white where two neighbours show different facets of an optic (`facets`), and
/// a tint of how the pixel was drawn (`method`): green projected, yellow part of a divided facet, red traced.
/// Of channels optic.facet, optic.object and stat.method; transparent where the image lacks them.
Pixels overlay_pixels(const Image& image, bool facets, bool method);

/// The picture as an image for write_image: R, G and B, linear, whose bytes as PNG are these.
Image image_of(const Pixels& pixels);

}  // namespace trilens
