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

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <new>

#include "base/files/file_bytes.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "image/exr_channels.h"
#include "image/exr_unzip.h"
#include "image/picture_library.h"

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
        throw InputError(name, "",
                         std::string("is no OpenEXR image, or is damaged: ") + library_reason(error.what()));
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
        if (text && std::string(it.name()).rfind(kPrefix, 0) == 0) image.metadata[it.name()] = text->value();
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

}  // namespace trilens
