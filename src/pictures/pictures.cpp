// Pictures through OpenImageIO, as a library of its own: THE door to OpenImageIO.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <new>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/version.h"
#include "image/image_io.h"
#include "image/tone.h"
#include "pictures/letters.h"
#include "pictures/webp.h"

namespace trilens {
namespace {

/// No usual codec shrinks a picture that much; a header that claims more is damaged or hostile.
constexpr double kLargestCompression = 4096;
constexpr double kSmallHeader = 65536;
/// But WebP, which shrinks a picture of one colour to some hundred bytes: of that, so many pixels are
/// believed.
constexpr double kBelievedPixels = 8192.0 * 8192.0;

/// 8 and 16 bit values as fractions of one are all multiples of 1/65535, so one table serves both.
float linear_from_stored(float fraction) {
    static const std::vector<float> table = [] {
        std::vector<float> values(65536);
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<float>(linear_from_srgb(static_cast<double>(i) / 65535));
        return values;
    }();
    return table[static_cast<std::size_t>(std::lround(static_cast<double>(fraction) * 65535))];
}

bool is_srgb(const OIIO::ImageSpec& spec) {
    const auto type = spec.format.basetype;
    if (type != OIIO::TypeDesc::UINT8 && type != OIIO::TypeDesc::UINT16) return false;
    const std::string space = spec.get_string_attribute("oiio:ColorSpace");
    for (const char* linear : {"linear", "lin_rec709", "lin_rec709_scene", "lin_srgb", "scene_linear"})
        if (OIIO::Strutil::iequals(space, linear)) return false;
    return true;
}

/// Which channels are red, green and blue: by name, else the first three, else one grey.
std::array<int, 3> colour_channels(const OIIO::ImageSpec& spec) {
    const std::array<int, 3> named = {spec.channelindex("R"), spec.channelindex("G"), spec.channelindex("B")};
    if (named[0] >= 0 && named[1] >= 0 && named[2] >= 0) return named;
    if (spec.nchannels >= 3) return {0, 1, 2};
    return {0, 0, 0};
}

/// Where a stored pixel stands once the picture is turned upright, by Exif's tag Orientation (TIFF 6.0,
/// section 8): the sides that the stored top row and left column belong to.
std::array<int, 2> upright_place(int orientation, std::array<int, 2> at, std::array<int, 2> size) {
    const std::array<int, 2> from_end{size[0] - 1 - at[0], size[1] - 1 - at[1]};
    switch (orientation) {
        case 2:
            return {from_end[0], at[1]};
        case 3:
            return from_end;
        case 4:
            return {at[0], from_end[1]};
        case 5:
            return {at[1], at[0]};
        case 6:
            return {from_end[1], at[0]};
        case 7:
            return {from_end[1], from_end[0]};
        case 8:
            return {at[1], from_end[0]};
        default:
            return at;
    }
}

/// As viewers show it.
void turn_upright(Texture& texture, int orientation) {
    if (orientation < 2 || orientation > 8) return;
    const std::array<int, 2> size{texture.width, texture.height};
    if (orientation >= 5) std::swap(texture.width, texture.height);
    std::vector<float> rgb(texture.rgb.size()), alpha(texture.alpha.size());
    std::size_t from = 0;
    for (int y = 0; y < size[1]; ++y)
        for (int x = 0; x < size[0]; ++x, ++from) {
            const auto [to_x, to_y] = upright_place(orientation, {x, y}, size);
            const auto to = static_cast<std::size_t>(to_y) * static_cast<std::size_t>(texture.width) +
                            static_cast<std::size_t>(to_x);
            std::copy_n(&texture.rgb[3 * from], 3, &rgb[3 * to]);
            if (!alpha.empty()) alpha[to] = texture.alpha[from];
        }
    texture.rgb = std::move(rgb);
    texture.alpha = std::move(alpha);
}

/// `is_tiff`: whose colours may be stored multiplied by alpha, and are divided by it; others' are straight.
std::shared_ptr<const Texture> texture_of(const OIIO::ImageSpec& spec, const std::vector<float>& values,
                                          bool is_tiff) {
    auto texture = std::make_shared<Texture>();
    texture->width = spec.full_width;
    texture->height = spec.full_height;
    texture->rgb.assign(
        static_cast<std::size_t>(spec.full_width) * static_cast<std::size_t>(spec.full_height) * 3, 0);
    const std::array<int, 3> channels = colour_channels(spec);
    const bool srgb = is_srgb(spec);
    // Opacity beside colours; what lies outside the data has none.
    const auto of_pixel = static_cast<std::size_t>(std::max(0, spec.alpha_channel));
    const bool is_multiplied =
        is_tiff && spec.alpha_channel >= 0 && spec.get_int_attribute("oiio:UnassociatedAlpha", 0) == 0;
    if (spec.alpha_channel >= 0)
        texture->alpha.assign(
            static_cast<std::size_t>(spec.full_width) * static_cast<std::size_t>(spec.full_height), 0);

    // The part of the display window that has data.
    const int dx = spec.x - spec.full_x, dy = spec.y - spec.full_y;
    const int first_x = std::max(0, dx), last_x = std::min(spec.full_width, dx + spec.width);
    const int first_y = std::max(0, dy), last_y = std::min(spec.full_height, dy + spec.height);
    for (int y = first_y; y < last_y; ++y) {
        for (int x = first_x; x < last_x; ++x) {
            const std::size_t from = static_cast<std::size_t>(y - dy) * static_cast<std::size_t>(spec.width) +
                                     static_cast<std::size_t>(x - dx);
            const std::size_t to = static_cast<std::size_t>(y) * static_cast<std::size_t>(spec.full_width) +
                                   static_cast<std::size_t>(x);
            const float* const stored = &values[from * static_cast<std::size_t>(spec.nchannels)];
            const float over = is_multiplied && stored[of_pixel] > 0 ? stored[of_pixel] : 1;
            for (std::size_t c = 0; c < 3; ++c) {
                const float value = stored[static_cast<std::size_t>(channels[c])] / over;
                texture->rgb[to * 3 + c] = srgb ? linear_from_stored(std::min(value, 1.0F)) : value;
            }
            if (!texture->alpha.empty()) texture->alpha[to] = stored[of_pixel];
        }
    }
    texture->drop_opaque_alpha();
    turn_upright(*texture, spec.get_int_attribute("Orientation", 1));
    return texture;
}

bool is_read_as_webp(const OIIO::ImageInput& in) {
    return in.format_name() == std::string_view("webp");
}

/// What the header of an open file says of its first picture.
OIIO::ImageSpec checked_header(const OIIO::ImageInput& in, const std::string& name,
                               std::size_t encoded_size) {
    OIIO::ImageSpec spec = in.spec();
    if (spec.deep || spec.depth > 1) throw InputError(name, "", "is no flat picture");
    const bool is_believed =
        is_read_as_webp(in) && static_cast<double>(spec.image_pixels()) <= kBelievedPixels;
    if (!is_believed && static_cast<double>(spec.image_bytes(true)) >
                            kSmallHeader + kLargestCompression * static_cast<double>(encoded_size))
        throw InputError(name, "", "is damaged: its header claims more pixels than the file can hold");
    return spec;
}

/// Reads the first picture of an open file.
std::shared_ptr<const Texture> read_open(OIIO::ImageInput& in, const std::string& name,
                                         std::size_t encoded_size) {
    const OIIO::ImageSpec spec = checked_header(in, name, encoded_size);
    try {
        std::vector<float> values(static_cast<std::size_t>(spec.image_pixels()) *
                                  static_cast<std::size_t>(spec.nchannels));
        if (!in.read_image(0, 0, 0, spec.nchannels, OIIO::TypeFloat, values.data()) || in.has_error())
            throw InputError(name, "", "is truncated or damaged: " + library_reason(in.geterror()));
        for (const float value : values)
            if (!std::isfinite(value)) throw InputError(name, "", "holds a value that is not finite");
        return texture_of(spec, values, in.format_name() == std::string_view("tiff"));
    } catch (const std::bad_alloc&) {
        throw InputError(name, "", "needs more memory than there is");
    }
}

/// Colours as the file has them: not multiplied by alpha.
OIIO::ImageSpec reading_hints() {
    OIIO::ImageSpec hints;
    hints.attribute("oiio:UnassociatedAlpha", 1);
    return hints;
}

/// A file name whose extension tells OpenImageIO the format of encoded bytes; empty where it is none of
/// these.
std::string name_for_format(std::span<const unsigned char> encoded) {
    const std::string_view start(reinterpret_cast<const char*>(encoded.data()),
                                 std::min<std::size_t>(encoded.size(), 16));
    const auto starts_with = [&](std::string_view magic) { return start.substr(0, magic.size()) == magic; };
    if (is_webp(encoded)) return "memory.webp";
    if (starts_with("\x89PNG\r\n\x1a\n")) return "memory.png";
    if (starts_with("\xff\xd8\xff")) return "memory.jpg";
    if (starts_with("\x76\x2f\x31\x01")) return "memory.exr";
    if (starts_with("#?RADIANCE") || starts_with("#?RGBE")) return "memory.hdr";
    return "";
}

/// Containers of textures for graphics cards are known by their first bytes; nobody here reads them.
void refuse_card_textures(std::string_view start, const std::string& name) {
    using namespace std::string_view_literals;
    constexpr std::pair<std::string_view, const char*> kContainers[] = {
        {"\xabKTX 20\xbb\r\n\x1a\n"sv, "KTX2"},
        {"\xabKTX 11\xbb\r\n\x1a\n"sv, "KTX"},
        {"sB\x13\0"sv, "Basis Universal"}};
    for (const auto& [magic, kind] : kContainers)
        if (start.substr(0, magic.size()) == magic)
            throw InputError(name, "",
                             std::string("is ") + kind +
                                 ", a texture for graphics cards, which is not read: give it as PNG, JPEG or "
                                 "OpenEXR");
}

std::unique_ptr<OIIO::ImageInput> open_file(const std::string& file) {
    std::array<char, 16> start{};
    std::ifstream(file, std::ios::binary).read(start.data(), start.size());
    refuse_card_textures({start.data(), start.size()}, file);
    const OIIO::ImageSpec hints = reading_hints();
    auto in = OIIO::ImageInput::open(file, &hints);
    if (!in) throw InputError(file, "", "is no picture, or is damaged: " + library_reason(OIIO::geterror()));
    return in;
}

/// The first channel, converted by the library to `Stored`, of which `type` is its name.
template <typename Stored>
std::vector<float> first_channel(OIIO::ImageInput& in, OIIO::TypeDesc type, const std::string& name) {
    std::vector<Stored> stored(static_cast<std::size_t>(in.spec().image_pixels()));
    if (!in.read_image(0, 0, 0, 1, type, stored.data()) || in.has_error())
        throw InputError(name, "", "is truncated or damaged: " + library_reason(in.geterror()));
    if constexpr (std::is_same_v<Stored, float>)
        return stored;
    else
        return std::vector<float>(stored.begin(), stored.end());
}

/// The first directory of a TIFF, classic or big, of either byte order, as far as one tag of text needs it:
/// the library hands on no tags that it does not know. Source: TIFF Revision 6.0, Adobe, 1992; BigTIFF as
/// libtiff describes it.
class TiffDirectory {
  public:
    explicit TiffDirectory(const std::string& file) : in_(file, std::ios::binary) {}

    /// Empty where the file is no TIFF, lacks the tag, or ends before it.
    std::string text(unsigned wanted) {
        const std::string order = bytes(2);
        if (order != "II" && order != "MM") return "";
        is_big_endian_ = order == "MM";
        const std::uint64_t version = number(2);
        if (version != 42 && version != 43) return "";
        is_big_ = version == 43;
        if (is_big_) number(4);  // the size of offsets, and nothing
        in_.seekg(static_cast<std::streamoff>(number(offset_size())));
        const std::uint64_t entries = std::min<std::uint64_t>(number(is_big_ ? 8 : 2), kMostEntries);
        for (std::uint64_t i = 0; i < entries && in_; ++i) {
            const std::uint64_t tag = number(2), type = number(2), count = number(offset_size());
            if (tag == wanted && type == kAscii && count <= kMostText) {
                if (count > offset_size()) in_.seekg(static_cast<std::streamoff>(number(offset_size())));
                return bytes(count);
            }
            number(offset_size());
        }
        return "";
    }

  private:
    static constexpr std::uint64_t kMostEntries = 65535, kMostText = 64, kAscii = 2;

    std::size_t offset_size() const { return is_big_ ? 8 : 4; }
    std::string bytes(std::size_t count) {
        std::string read(count, '\0');
        if (!in_.read(read.data(), static_cast<std::streamsize>(count))) read.clear();
        return read;
    }
    std::uint64_t number(std::size_t size) {
        std::string read = bytes(size);
        if (!is_big_endian_) std::reverse(read.begin(), read.end());
        std::uint64_t value = 0;
        for (const char byte : read) value = value << 8 | static_cast<unsigned char>(byte);
        return value;
    }

    std::ifstream in_;
    bool is_big_endian_ = false, is_big_ = false;
};

/// What a GeoTIFF says its samples without a value hold (GDAL's tag GDAL_NODATA), as numbers of the file.
std::optional<double> no_data_of(const std::string& file) {
    constexpr unsigned kGdalNoData = 42113;
    const std::string text = TiffDirectory(file).text(kGdalNoData);
    const std::string number(OIIO::Strutil::strip(text.c_str()));
    if (!OIIO::Strutil::string_is_float(number)) return std::nullopt;
    return OIIO::Strutil::stod(number);
}

/// Of integers that the library turns into shares; 0 of other numbers. Grey of fewer bits than a byte or two
/// is spread over these.
double greatest_of(const OIIO::ImageSpec& spec) {
    if (spec.format != OIIO::TypeDesc::UINT8 && spec.format != OIIO::TypeDesc::UINT16) return 0;
    const int all = 8 * static_cast<int>(spec.format.size());
    const int bits = spec.nchannels == 1 ? spec.get_int_attribute("oiio:BitsPerSample", all) : all;
    return std::ldexp(1.0, bits > 0 && bits < all ? bits : all) - 1;
}

/// Samples that hold nothing become NaN.
void mark_no_data(HeightGrid& heights, const std::string& file) {
    heights.no_data = no_data_of(file);
    if (!heights.no_data) return;
    const auto holds_nothing = [&](float value) { return heights.stands_for(value, *heights.no_data); };
    std::replace_if(heights.values.begin(), heights.values.end(), holds_nothing,
                    std::numeric_limits<float>::quiet_NaN());
}

HeightGrid heights_of(const std::string& file) {
    const std::size_t size = readable_size(file);
    const auto in = open_file(file);
    const OIIO::ImageSpec spec = checked_header(*in, file, size);
    HeightGrid heights{.columns = spec.width,
                       .rows = spec.height,
                       .channels = spec.nchannels,
                       .values = {},
                       .greatest = greatest_of(spec),
                       .is_half = spec.format == OIIO::TypeDesc::HALF};
    if (std::max(heights.columns, heights.rows) > kMostHeightsSide)
        throw InputError(file, "",
                         "has " + std::to_string(heights.columns) + " x " + std::to_string(heights.rows) +
                             " samples, more than " + std::to_string(kMostHeightsSide) + " along a side");
    try {
        // Integers that the library would take for shares of the greatest are numbers here.
        switch (spec.format.basetype) {
            case OIIO::TypeDesc::INT16:
                heights.values = first_channel<std::int16_t>(*in, spec.format, file);
                break;
            case OIIO::TypeDesc::INT32:
                heights.values = first_channel<std::int32_t>(*in, spec.format, file);
                break;
            case OIIO::TypeDesc::UINT32:
                heights.values = first_channel<std::uint32_t>(*in, spec.format, file);
                break;
            default:
                heights.values = first_channel<float>(*in, OIIO::TypeFloat, file);
        }
    } catch (const std::bad_alloc&) {
        throw InputError(file, "", "needs more memory than there is");
    }
    mark_no_data(heights, file);
    return heights;
}

std::shared_ptr<const Texture> read_encoded(std::span<const unsigned char> encoded, const std::string& format,
                                            const std::string& name) {
    OIIO::Filesystem::IOMemReader memory(encoded.data(), encoded.size());
    OIIO::Filesystem::IOProxy* proxy = &memory;
    // The proxy goes in as a hint: open() of OpenImageIO 2.4 forgets a proxy argument where there are hints.
    OIIO::ImageSpec hints = reading_hints();
    hints.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    const auto in = OIIO::ImageInput::open(format, &hints);
    if (!in) throw InputError(name, "", "is damaged: " + library_reason(OIIO::geterror()));
    return read_open(*in, name, encoded.size());
}

std::shared_ptr<const Texture> decode(std::span<const unsigned char> encoded, const std::string& name) {
    refuse_card_textures({reinterpret_cast<const char*>(encoded.data()), encoded.size()}, name);
    const std::string format = name_for_format(encoded);
    if (format.empty()) throw InputError(name, "", "is neither PNG, JPEG, WebP, OpenEXR nor Radiance");
    const std::shared_ptr<const Texture> texture = read_encoded(encoded, format, name);
    if (texture->alpha.empty() || !is_webp(encoded)) return texture;
    auto colours = std::make_shared<Texture>(*read_encoded(webp_without_alpha(encoded), format, name));
    colours->alpha = texture->alpha;
    return colours;
}

std::shared_ptr<const Texture> read(const std::string& file) {
    const std::size_t size = readable_size(file);
    const auto in = open_file(file);
    if (!is_read_as_webp(*in)) return read_open(*in, file, size);
    const std::optional<std::string> bytes = read_whole_file(file);
    if (!bytes) throw InputError(file, "", "cannot be read");
    return decode({reinterpret_cast<const unsigned char*>(bytes->data()), bytes->size()}, file);
}

void set_threads(int threads) {
    OIIO::attribute("threads", threads);
    OIIO::attribute("exr_threads", threads);
}

}  // namespace
}  // namespace trilens

const trilens::PictureLibrary* trilens_picture_library() {
    static const trilens::PictureLibrary library{trilens::kVersion,   trilens::read,
                                                 trilens::decode,     trilens::heights_of,
                                                 trilens::letters_of, trilens::set_threads};
    return &library;
}
