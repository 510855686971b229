#include "image/exr_file.h"

#include <Iex.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <strings.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <new>
#include <set>
#include <span>
#include <string_view>
#include <tuple>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "image/image_io.h"

namespace trilens {
namespace {

constexpr const char* kPrefix = "trilens:";

/// Rows that are asked of the library at a time: whole blocks and tiles for many threads.
constexpr int kBandRows = 256;

/// Zip, the densest of OpenEXR's usual codecs, cannot shrink below 1 : 1032. A header that claims more is
/// damaged.
constexpr double kLargestCompression = 4096;

/// More pixels along a side than any file of use has; headers beyond it are damaged.
constexpr double kMostPixels = 1 << 20;

/// A file in memory, as the library reads.
class Memory : public Imf::IStream {
  public:
    Memory(std::span<const unsigned char> bytes, const std::string& name)
        : Imf::IStream(name.c_str()), bytes_(bytes) {}

    bool read(char to[], int count) override {
        if (count < 0 || static_cast<std::uint64_t>(count) > bytes_.size() - at_)
            throw Iex::InputExc("Unexpected end of file.");
        std::memcpy(to, bytes_.data() + at_, static_cast<std::size_t>(count));
        at_ += static_cast<std::uint64_t>(count);
        return at_ < bytes_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t to) override { at_ = std::min<std::uint64_t>(to, bytes_.size()); }

  private:
    std::span<const unsigned char> bytes_;
    std::uint64_t at_ = 0;
};

/// The library's own threads, as many as ours; set anew where that has changed.
int library_threads() {
    const int threads = thread_count() > 1 ? thread_count() : 0;  // 0: the calling thread itself
    if (Imf::globalThreadCount() != threads) Imf::setGlobalThreadCount(threads);
    return threads;
}

}  // namespace

struct ExrFile::State {
    std::string name;
    std::size_t size = 0;  // of the file
    bool on_disk = false;
    std::ifstream in;
    std::unique_ptr<Imf::IStream> stream;
    std::unique_ptr<Imf::MultiPartInputFile> file;

    void open();
    const Imf::Header& header(int part) const { return file->header(part); }
    [[noreturn]] void damaged(const char* why) const {
        throw InputError(name, "", std::string("is truncated or damaged: ") + library_reason(why));
    }
    void check_readable(int part, const ExrWindows& windows, bool deep) const;
};

void ExrFile::State::open() {
    try {
        file = std::make_unique<Imf::MultiPartInputFile>(*stream, library_threads());
    } catch (const std::exception& error) {
        const std::string why = library_reason(error.what());
        if (why.find("empty channel list") != std::string::npos)
            throw InputError(name, "", "has no channels");
        throw InputError(name, "", "is no OpenEXR image, or is damaged: " + why);
    }
}

ExrFile::ExrFile(const std::string& file) : state_(std::make_unique<State>()) {
    state_->name = file;
    state_->size = readable_size(file);
    state_->on_disk = true;
    state_->in.open(file, std::ios::binary);
    state_->stream = std::make_unique<Imf::StdIFStream>(state_->in, file.c_str());
    state_->open();
}

ExrFile::ExrFile(std::span<const unsigned char> encoded, const std::string& name)
    : state_(std::make_unique<State>()) {
    state_->name = name;
    state_->size = encoded.size();
    state_->stream = std::make_unique<Memory>(encoded, name);
    state_->open();
}

ExrFile::~ExrFile() = default;

int ExrFile::parts() const {
    return state_->file->parts();
}

std::string ExrFile::part_name(int part) const {
    const Imf::Header& header = state_->header(part);
    return header.hasName() ? header.name() : "";
}

ExrWindows ExrFile::windows(int part) const {
    const auto& display = state_->header(part).displayWindow();
    const auto& data = state_->header(part).dataWindow();
    return {
        display.min.x, display.min.y, display.max.x - display.min.x + 1, display.max.y - display.min.y + 1,
        data.min.x,    data.min.y,    data.max.x - data.min.x + 1,       data.max.y - data.min.y + 1};
}

bool ExrFile::is_deep(int part) const {
    const Imf::Header& header = state_->header(part);
    return header.hasType() && Imf::isDeepData(header.type());
}

bool ExrFile::is_sampled_everywhere(int part) const {
    const Imf::ChannelList& channels = state_->header(part).channels();
    for (auto it = channels.begin(); it != channels.end(); ++it)
        if (it.channel().xSampling != 1 || it.channel().ySampling != 1) return false;
    return true;
}

void ExrFile::State::check_readable(int part, const ExrWindows& windows, bool deep) const {
    if (deep) throw InputError(name, "", "has deep pixels, which are not supported");
    const Imf::ChannelList& channels = header(part).channels();
    double pixel_bytes = 0;
    for (auto it = channels.begin(); it != channels.end(); ++it) {
        if (it.channel().xSampling != 1 || it.channel().ySampling != 1)
            throw InputError(name, it.name(), "is not sampled at every pixel, which is not supported");
        pixel_bytes += it.channel().type == Imf::HALF ? 2 : 4;
    }
    if (channels.begin() == channels.end()) throw InputError(name, "", "has no channels");
    const double width = windows.data_width, height = windows.data_height;
    if (!(width > 0 && height > 0 && width <= kMostPixels && height <= kMostPixels) ||
        width * height * pixel_bytes > kLargestCompression * static_cast<double>(size))
        throw InputError(name, "", "is damaged: its header claims more pixels than the file can hold");
}

namespace {

Image empty_image(const Imf::Header& header, const ExrWindows& windows) {
    Image image;
    image.width = windows.display_x + windows.display_width;
    image.height = windows.display_y + windows.display_height;
    image.x0 = windows.data_x;
    image.y0 = windows.data_y;
    image.data_width = windows.data_width;
    image.data_height = windows.data_height;
    std::vector<std::string> names;
    for (auto it = header.channels().begin(); it != header.channels().end(); ++it) names.push_back(it.name());
    for (const std::string& name : in_layers(names)) {
        Channel channel{name, {}};
        if (header.channels()[name].type == Imf::UINT)
            channel.values = std::vector<Id>(image.pixels());
        else
            channel.values = std::vector<float>(image.pixels());
        image.channels.push_back(std::move(channel));
    }
    for (auto it = header.begin(); it != header.end(); ++it) {
        const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute());
        // A text ends at its first zero, as it does where it is written.
        if (text && std::string(it.name()).rfind(kPrefix, 0) == 0)
            image.metadata[it.name()] = text->value().c_str();
    }
    return image;
}

/// Where the library puts each pixel: it counts from (0, 0), wherever the data window lies.
Imf::FrameBuffer frame_buffer(Image& image) {
    Imf::FrameBuffer buffer;
    const auto row = static_cast<std::ptrdiff_t>(image.data_width);
    const std::ptrdiff_t corner = image.y0 * row + image.x0;
    for (Channel& channel : image.channels) {
        void* values = channel.is_id() ? static_cast<void*>(channel.ids().data())
                                       : static_cast<void*>(channel.floats().data());
        char* base = static_cast<char*>(values) - 4 * corner;
        buffer.insert(channel.name, Imf::Slice(channel.is_id() ? Imf::UINT : Imf::FLOAT, base, 4,
                                               4 * static_cast<std::size_t>(row)));
    }
    return buffer;
}

}  // namespace

Image ExrFile::read(int part) {
    const ExrWindows shape = windows(part);
    state_->check_readable(part, shape, is_deep(part));
    try {
        Image image = empty_image(state_->header(part), shape);
        if (state_->on_disk && read_zipped(state_->name, image)) return image;
        Imf::InputPart input(*state_->file, part);
        input.setFrameBuffer(frame_buffer(image));
        for (int row = 0; row < image.data_height; row += kBandRows)
            input.readPixels(image.y0 + row, image.y0 + std::min(row + kBandRows, image.data_height) - 1);
        return image;
    } catch (const std::bad_alloc&) {
        throw InputError(state_->name, "", "needs more memory than there is");
    } catch (const std::exception& error) {
        state_->damaged(error.what());
    }
}

namespace {

constexpr const char* kColourFirst[] = {"R",    "Red",  "G",  "Green", "B",     "Blue", "Y",
                                        "real", "imag", "A",  "Alpha", "AR",    "RA",   "AG",
                                        "GA",   "AB",   "BA", "Z",     "Depth", "Zback"};
constexpr const char* kWithPlace[] = {"R",  "Red", "G",    "Green", "B",  "Blue",  "X",
                                      "Y",  "Z",   "real", "imag",  "A",  "Alpha", "AR",
                                      "RA", "AG",  "GA",   "AB",    "BA", "Depth", "Zback"};

struct Name {
    std::string layer, last;
};

Name split(const std::string& name) {
    const std::size_t dot = name.rfind('.');
    return dot == std::string::npos ? Name{"", name} : Name{name.substr(0, dot + 1), name.substr(dot + 1)};
}

bool same(const std::string& a, const char* b) {
    return strcasecmp(a.c_str(), b) == 0;
}

std::size_t rank(const std::string& last, std::span<const char* const> usual) {
    for (std::size_t i = 0; i < usual.size(); ++i)
        if (same(last, usual[i])) return i;
    return usual.size();
}

}  // namespace

std::vector<std::string> in_layers(std::vector<std::string> names) {
    const std::vector<std::string> all = names;
    const auto has = [&](const std::string& layer, const char* last) {
        return std::any_of(all.begin(), all.end(), [&](const std::string& name) {
            const Name one = split(name);
            return one.layer == layer && same(one.last, last);
        });
    };
    const auto key = [&](const std::string& name) {
        const Name one = split(name);
        const bool place = has(one.layer, "X") && (has(one.layer, "Y") || has(one.layer, "Z"));
        return std::tuple(one.layer, place ? rank(one.last, kWithPlace) : rank(one.last, kColourFirst),
                          one.last);
    };
    std::sort(names.begin(), names.end(),
              [&](const std::string& a, const std::string& b) { return key(a) < key(b); });
    return names;
}

// OpenEXR files as Images, strictly.

namespace {

Image read_part(ExrFile& in, int part, const std::string& file) {
    const ExrWindows shape = in.windows(part);
    if (shape.display_x != 0 || shape.display_y != 0)
        throw InputError(file, "", "its display window does not start at (0, 0)");
    return in.read(part);
}

}  // namespace

Image read_exr(const std::string& file) {
    ExrFile in(file);
    if (in.parts() > 1) throw InputError(file, "", "has more than one part");
    return read_part(in, 0, file);
}

std::vector<std::pair<std::string, Image>> read_exr_parts(const std::string& file) {
    ExrFile in(file);
    std::vector<std::pair<std::string, Image>> parts;
    std::set<std::string> names;
    for (int part = 0; part < in.parts(); ++part) {
        const std::string name = in.part_name(part);
        if (!names.insert(name).second) throw InputError(file, "", "has two parts called \"" + name + "\"");
        parts.emplace_back(name, read_part(in, part, file));
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

}  // namespace trilens
