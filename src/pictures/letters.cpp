#include "pictures/letters.h"

#include <OpenImageIO/imagebufalgo.h>

#include <cmath>
#include <filesystem>

#include "base/util/error.h"
#include "image/image_io.h"

namespace trilens {
namespace {

// Debian's fonts-dejavu-core.
constexpr const char* kUsualFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr int kLongestText = 16384;  // pixels

}  // namespace

TextMask letters_of(const TextStyle& style) {
    const std::string font = style.font.empty() ? kUsualFont : style.font;
    std::error_code none;
    if (!std::filesystem::is_regular_file(font, none))
        throw InputError(style.font, "",
                         style.font.empty() ? "labels need the font " + font +
                                                  " (Debian's fonts-dejavu-core), or one of their own"
                                            : "there is no such font");
    const int size = std::max(1, static_cast<int>(std::lround(style.size)));
    const OIIO::ROI room = OIIO::ImageBufAlgo::text_size(style.text, size, font);
    if (!room.defined()) {
        const std::string why = library_reason(OIIO::geterror());
        throw InputError(style.font, "", "cannot draw \"" + style.text + "\": " + why);
    }
    if (room.width() <= 0 || room.height() <= 0 || room.width() > kLongestText ||
        room.height() > kLongestText)
        throw InputError(style.font, "", "\"" + style.text + "\" has no letters, or too large ones");
    OIIO::ImageBuf drawn(OIIO::ImageSpec(room.width(), room.height(), 1, OIIO::TypeFloat));
    OIIO::ImageBufAlgo::zero(drawn);
    const float white[] = {1};
    if (!OIIO::ImageBufAlgo::render_text(drawn, -room.xbegin, -room.ybegin, style.text, size, font, white))
        throw InputError(style.font, "",
                         "cannot draw \"" + style.text + "\": " + library_reason(drawn.geterror()));
    TextMask mask{room.width(), room.height(), {}};
    mask.coverage.resize(static_cast<std::size_t>(mask.width) * static_cast<std::size_t>(mask.height));
    drawn.get_pixels(OIIO::ROI(0, mask.width, 0, mask.height, 0, 1, 0, 1), OIIO::TypeFloat,
                     mask.coverage.data());
    return mask;
}

}  // namespace trilens
