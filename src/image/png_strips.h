// A PNG of a picture's beauty made strip by strip, so that the light of the scene need not be held whole.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/util/overwritten.h"
#include "image/tone.h"

namespace trilens {

/// R, G and B after exposure and tone curve, as they are stored in 8-bit sRGB.
class PngStrips {
  public:
    /// `layout`: the windows, and the channels by name and type. `name`: for messages. Throws UsageError as
    /// check_tone_mapping does, InputError where R, G or B is not there or holds ids.
    PngStrips(const std::string& name, const Image& layout, const ToneMapping& tone);

    /// The next `rows` rows of the layout's channels, in its order; the vectors may be longer.
    void add(const std::vector<Channel>& channels, int rows);

    /// The file's bytes, once every row of the data window has come: those of encode_png of the whole
    /// picture. Throws OutputError.
    std::vector<unsigned char> finish() const;

  private:
    std::string name_;
    ToneMapping tone_;
    int width_ = 0, height_ = 0, next_row_ = 0;
    std::size_t channel_[3] = {};        // R, G, B of the layout
    Overwritten<unsigned char> stored_;  // three values per pixel
};

/// Linear values as an 8-bit sRGB file stores them: clamped to 0..1 before encoding, NaN as 0. `stored` is as
/// long as `linear`.
void store_srgb(std::span<const float> linear, std::span<unsigned char> stored);

}  // namespace trilens
