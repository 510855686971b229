// OpenEXR files to and from Images: mixed float and id channels, strictly.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <new>
#include <set>
#include <string_view>

#include "base/check.h"
#include "base/error.h"
#include "base/file_bytes.h"
#include "image/image_io.h"
#include "image/library_reason.h"

namespace trilens {
namespace {

constexpr const char* kPrefix = "trilens:";

/// Rows handed to the library at a time: a multiple of zip's 16, enough for many threads, small beside the
/// image.
constexpr int kBandRows = 256;

/// Zip, the densest of OpenEXR's usual codecs, cannot shrink below 1 : 1032. A header that claims more is
/// damaged.
constexpr double kLargestCompression = 4096;

const OIIO::TypeDesc kIdType(OIIO::TypeDesc::UINT32);

// --- Writing
// ---------------------------------------------------------------------------------------------------

/// SOURCE_DATE_EPOCH (reproducible-builds.org), or 1970, as EXIF writes dates.
std::string fixed_date_time(const std::string& name) {
    const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
    if (!epoch) return "1970:01:01 00:00:00";
    char* end = nullptr;
    const std::time_t seconds = static_cast<std::time_t>(std::strtoll(epoch, &end, 10));
    std::tm utc{};
    char text[32] = "";
    if (end == epoch || *end != '\0' || !gmtime_r(&seconds, &utc) ||
        std::strftime(text, sizeof text, "%Y:%m:%d %H:%M:%S", &utc) == 0) {
        throw OutputError(name, std::string("SOURCE_DATE_EPOCH is not a time in seconds: ") + epoch);
    }
    return text;
}

void check_image(const Image& image) {
    TRILENS_CHECK(image.width > 0 && image.height > 0 && image.data_width > 0 && image.data_height > 0,
                  "an image has pixels");
    TRILENS_CHECK(!image.channels.empty(), "an image has channels");
    std::set<std::string> names;
    for (const Channel& channel : image.channels) {
        TRILENS_CHECK(!channel.name.empty() && names.insert(channel.name).second, "channel names are unique");
        const std::size_t size = channel.is_id() ? channel.ids().size() : channel.floats().size();
        TRILENS_CHECK(size == image.pixels(), "a channel has one value per pixel of the data window");
    }
    for (const auto& [name, text] : image.metadata)
        TRILENS_CHECK(name.rfind(kPrefix, 0) == 0, "metadata names start with trilens:");
}

OIIO::ImageSpec spec_of(const std::string& name, const Image& image) {
    OIIO::ImageSpec spec(image.data_width, image.data_height, static_cast<int>(image.channels.size()),
                         OIIO::TypeFloat);
    spec.x = image.x0;
    spec.y = image.y0;
    spec.full_width = image.width;
    spec.full_height = image.height;
    spec.channelnames.clear();
    for (const Channel& channel : image.channels) {
        spec.channelnames.push_back(channel.name);
        spec.channelformats.push_back(channel.is_id() ? kIdType : OIIO::TypeFloat);
    }
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", fixed_date_time(name));
    for (const auto& [key, text] : image.metadata) spec.attribute(key, text);
    return spec;
}

/// Rows [first, last) of all channels as packed pixels: four bytes per channel, channel after channel.
std::vector<std::uint32_t> pack_rows(const Image& image, int first, int last) {
    const std::size_t columns = static_cast<std::size_t>(image.data_width), count = image.channels.size();
    const std::size_t begin = static_cast<std::size_t>(first) * columns;
    const std::size_t pixels = static_cast<std::size_t>(last - first) * columns;
    std::vector<std::uint32_t> packed(pixels * count);
    for (std::size_t c = 0; c < count; ++c) {
        const Channel& channel = image.channels[c];
        const void* values = channel.is_id() ? static_cast<const void*>(channel.ids().data() + begin)
                                             : static_cast<const void*>(channel.floats().data() + begin);
        for (std::size_t i = 0; i < pixels; ++i)
            std::memcpy(&packed[i * count + c], static_cast<const char*>(values) + 4 * i, 4);
    }
    return packed;
}

// --- Reading
// ---------------------------------------------------------------------------------------------------

void check_readable(const OIIO::ImageSpec& spec, const std::string& file, std::size_t file_size) {
    if (spec.deep) throw InputError(file, "", "has deep pixels, which are not supported");
    if (spec.full_x != 0 || spec.full_y != 0)
        throw InputError(file, "", "its display window does not start at (0, 0)");
    for (int c = 0; c < spec.nchannels; ++c) {
        const OIIO::TypeDesc type = spec.channelformat(c);
        if (type != OIIO::TypeFloat && type != OIIO::TypeHalf && type != kIdType)
            throw InputError(file, spec.channelnames[c], "is neither float nor uint");
    }
    if (static_cast<double>(spec.image_bytes(true)) > kLargestCompression * static_cast<double>(file_size))
        throw InputError(file, "", "is damaged: its header claims more pixels than the file can hold");
}

Image empty_image_of(const OIIO::ImageSpec& spec) {
    Image image;
    image.width = spec.full_width;
    image.height = spec.full_height;
    image.x0 = spec.x;
    image.y0 = spec.y;
    image.data_width = spec.width;
    image.data_height = spec.height;
    for (int c = 0; c < spec.nchannels; ++c) {
        Channel channel;
        channel.name = spec.channelnames[static_cast<std::size_t>(c)];
        if (spec.channelformat(c) == kIdType)
            channel.values = std::vector<Id>(image.pixels());
        else
            channel.values = std::vector<float>(image.pixels());
        image.channels.push_back(std::move(channel));
    }
    for (const OIIO::ParamValue& entry : spec.extra_attribs) {
        if (entry.name().string().rfind(kPrefix, 0) == 0 && entry.type() == OIIO::TypeString)
            image.metadata[entry.name().string()] = entry.get_string();
    }
    return image;
}

/// The channels' values of packed native pixels that start at value `begin` of each channel.
void unpack(const OIIO::ImageSpec& spec, const std::vector<char>& packed, std::size_t begin, Image& image) {
    const std::size_t stride = spec.pixel_bytes(true), pixels = packed.size() / stride;
    std::size_t offset = 0;
    for (int c = 0; c < spec.nchannels; ++c) {
        Channel& channel = image.channels[static_cast<std::size_t>(c)];
        const OIIO::TypeDesc type = spec.channelformat(c);
        for (std::size_t i = 0; i < pixels; ++i) {
            const char* value = packed.data() + i * stride + offset;
            if (type == kIdType)
                std::memcpy(&channel.ids()[begin + i], value, 4);
            else if (type == OIIO::TypeFloat)
                std::memcpy(&channel.floats()[begin + i], value, 4);
            else
                OIIO::convert_pixel_values(type, value, OIIO::TypeFloat, &channel.floats()[begin + i]);
        }
        offset += type.size();
    }
}

/// Rows of pixels of one part.
struct Rows {
    int part = 0, first = 0, last = 0;
};

bool read_rows(OIIO::ImageInput& in, const OIIO::ImageSpec& spec, const Rows& rows,
               std::vector<char>& packed) {
    const auto [part, first, last] = rows;
    if (spec.tile_width == 0)
        return in.read_scanlines(part, 0, first, last, 0, 0, spec.nchannels, OIIO::TypeUnknown,
                                 packed.data());
    return in.read_tiles(part, 0, spec.x, spec.x + spec.width, first, last, 0, 1, 0, spec.nchannels,
                         OIIO::TypeUnknown, packed.data());
}

Image read_part(OIIO::ImageInput& in, int part, const std::string& file, std::size_t file_size) {
    const OIIO::ImageSpec spec = in.spec(part);
    check_readable(spec, file, file_size);
    Image image = empty_image_of(spec);

    // Bands of tiles must hold whole rows of tiles.
    const int band = spec.tile_height > 0 ? spec.tile_height : kBandRows;
    for (int row = 0; row < spec.height; row += band) {
        const int rows = std::min(band, spec.height - row);
        const std::size_t columns = static_cast<std::size_t>(spec.width);
        std::vector<char> packed(static_cast<std::size_t>(rows) * columns * spec.pixel_bytes(true));
        if (!read_rows(in, spec, {part, spec.y + row, spec.y + row + rows}, packed) || in.has_error())
            throw InputError(file, "", "is truncated or damaged: " + library_reason(in.geterror()));
        unpack(spec, packed, static_cast<std::size_t>(row) * columns, image);
    }
    return image;
}

Image read_part_in_memory(OIIO::ImageInput& in, int part, const std::string& file, std::size_t file_size) {
    try {
        return read_part(in, part, file, file_size);
    } catch (const std::bad_alloc&) {
        throw InputError(file, "", "needs more memory than there is");
    }
}

std::unique_ptr<OIIO::ImageInput> open_exr(const std::string& file) {
    auto in = OIIO::ImageInput::create("openexr");
    if (!in)
        throw InputError(file, "", "OpenImageIO cannot read OpenEXR: " + library_reason(OIIO::geterror()));
    OIIO::ImageSpec spec;
    if (!in->open(file, spec))
        throw InputError(file, "", "is no OpenEXR image, or is damaged: " + library_reason(in->geterror()));
    return in;
}

int count_parts(OIIO::ImageInput& in) {
    return in.spec().get_int_attribute("oiio:subimages", 1);
}

}  // namespace

std::vector<unsigned char> encode_exr(const std::string& name, const Image& image) {
    check_image(image);
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput proxy(bytes);
    const OIIO::ImageSpec spec = spec_of(name, image);
    const auto out = OIIO::ImageOutput::create("openexr", &proxy);
    if (!out)
        throw OutputError(name, "OpenImageIO cannot write OpenEXR: " + library_reason(OIIO::geterror()));

    bool good = out->open("image.exr", spec);
    for (int row = 0; good && row < image.data_height; row += kBandRows) {
        const int end = std::min(row + kBandRows, image.data_height);
        const std::vector<std::uint32_t> packed = pack_rows(image, row, end);
        good = out->write_scanlines(spec.y + row, spec.y + end, 0, OIIO::TypeUnknown, packed.data());
    }
    if (!(good && out->close()))
        throw OutputError(name, "cannot be encoded: " + library_reason(out->geterror()));
    return bytes;
}

void write_exr(const std::string& file, const Image& image) {
    replace_file(file, encode_exr(file, image));
}

Image read_exr(const std::string& file) {
    const std::size_t size = readable_size(file);
    const auto in = open_exr(file);
    if (count_parts(*in) > 1) throw InputError(file, "", "has more than one part");
    return read_part_in_memory(*in, 0, file, size);
}

std::vector<std::pair<std::string, Image>> read_exr_parts(const std::string& file) {
    const std::size_t size = readable_size(file);
    const auto in = open_exr(file);
    std::vector<std::pair<std::string, Image>> parts;
    std::set<std::string> names;
    for (int part = 0; part < count_parts(*in); ++part) {
        const std::string name = in->spec(part).get_string_attribute("oiio:subimagename");
        if (!names.insert(name).second) throw InputError(file, "", "has two parts called \"" + name + "\"");
        parts.emplace_back(name, read_part_in_memory(*in, part, file, size));
    }
    return parts;
}

bool is_exr_file(const std::string& file) {
    if (readable_size(file) < 4) return false;
    std::ifstream in(file, std::ios::binary);
    char start[4] = "";
    in.read(start, sizeof start);
    return in && std::string_view(start, sizeof start) == "\x76\x2f\x31\x01";
}

void set_image_threads(int threads) {
    OIIO::attribute("threads", threads);
    OIIO::attribute("exr_threads", threads);
}

std::string image_library_version() {
    return std::string("OpenImageIO ") + OIIO_VERSION_STRING;
}

}  // namespace trilens
