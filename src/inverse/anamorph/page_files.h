// Pages at true scale: PDF (ISO 32000-1, the picture deflated without loss), SVG in millimetres, PNG with its
// dots per metre.
#pragma once

#include <string>
#include <vector>

#include "inverse/anamorph/anamorph.h"

namespace trilens {

/// One page whose MediaBox is the paper's size to 0.01 point, with the mirrors' outlines and a line of 100 mm
/// (of 50 where the page is smaller) to check the print by. No printer driver may scale it.
std::vector<unsigned char> pdf_of(const AnamorphPage& page);

/// The same as SVG, the picture as PNG inside.
std::string svg_of(const AnamorphPage& page);

/// The picture alone, 8 bits sRGB, with pHYs.
std::vector<unsigned char> png_of(const AnamorphPage& page);

}  // namespace trilens
