#include "image/exr_file.h"

#include <OpenEXR/openexr.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string_view>
#include <vector>

#include "base/util/parallel.h"
#include "image/zlib_stream.h"

namespace trilens {
namespace {

/// What a difference of nothing is written as.
constexpr unsigned kDifferenceBias = 128;

/// One half of the sorted bytes under work: every second byte, each as its difference from the one before.
struct Half {
    unsigned char* to = nullptr;
    unsigned char before = 0;

    /// Takes bytes[0], bytes[2], ... of `count` pairs.
    void take(const unsigned char* bytes, std::size_t count) {
        to[0] = static_cast<unsigned char>(bytes[0] - before + kDifferenceBias);
        for (std::size_t i = 1; i < count; ++i)
            to[i] = static_cast<unsigned char>(bytes[2 * i] - bytes[2 * i - 2] + kDifferenceBias);
        to += count;
        before = bytes[2 * count - 2];
    }
};

/// The byte that differences lead to, from the byte `before` them.
unsigned char last_of(std::span<const unsigned char> differences, unsigned before) {
    unsigned sum = before;
    for (const unsigned char difference : differences) sum += difference - kDifferenceBias;
    return static_cast<unsigned char>(sum);
}

/// Calls take(first byte, number of bytes) for each row of each channel, in the order of the file.
template <typename Channels, typename Take>
void for_each_piece(const Channels& channels, int rows, std::size_t row_bytes, const Take& take) {
    for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row)
        for (const auto values : channels) take(values + row * row_bytes, row_bytes);
}

}  // namespace

std::vector<unsigned char> zip_block(std::span<const BlockValues> channels, int rows, int columns,
                                     BlockScratch& scratch) {
    const std::size_t row_bytes = 4 * static_cast<std::size_t>(columns);
    const std::size_t size = row_bytes * static_cast<std::size_t>(rows) * channels.size();
    auto& [sorted, smaller] = scratch;
    sorted.resize(size);
    smaller.resize(size - 1);
    // The second half goes on where the first one ends.
    const unsigned char last_even = channels.back()[row_bytes * static_cast<std::size_t>(rows) - 2];
    Half even{sorted.data()}, odd{sorted.data() + size / 2, last_even};
    for_each_piece(channels, rows, row_bytes, [&](const unsigned char* bytes, std::size_t count) {
        even.take(bytes, count / 2);
        odd.take(bytes + 1, count / 2);
    });
    // The very first byte stands as it is.
    sorted[0] = channels[0][0];

    const std::size_t deflated = deflate({sorted.data(), size}, {smaller.data(), size - 1});
    std::vector<unsigned char> packed(smaller.data(), smaller.data() + deflated);
    if (!packed.empty()) return packed;
    for_each_piece(channels, rows, row_bytes, [&](const unsigned char* bytes, std::size_t count) {
        packed.insert(packed.end(), bytes, bytes + count);
    });
    return packed;
}

bool unzip_block(std::span<unsigned char> packed, std::span<unsigned char* const> channels, int rows,
                 int columns) {
    const std::size_t row_bytes = 4 * static_cast<std::size_t>(columns);
    const std::size_t size = row_bytes * static_cast<std::size_t>(rows) * channels.size();
    if (packed.size() == size) {
        const unsigned char* from = packed.data();
        for_each_piece(channels, rows, row_bytes, [&](unsigned char* bytes, std::size_t count) {
            std::memcpy(bytes, from, count);
            from += count;
        });
        return true;
    }
    std::vector<unsigned char> sorted(size);
    if (packed.size() > size || !inflate(packed, sorted)) return false;

    // Every second byte comes from the second half, which goes on where the first one ends.
    const unsigned char *even = sorted.data(), *odd = sorted.data() + size / 2;
    unsigned even_byte = kDifferenceBias, odd_byte = last_of({even, size / 2}, kDifferenceBias);
    for_each_piece(channels, rows, row_bytes, [&](unsigned char* bytes, std::size_t count) {
        for (std::size_t i = 0; i < count; i += 2) {
            even_byte += *even++ - kDifferenceBias;
            odd_byte += *odd++ - kDifferenceBias;
            bytes[i] = static_cast<unsigned char>(even_byte);
            bytes[i + 1] = static_cast<unsigned char>(odd_byte);
        }
    });
    return true;
}

namespace {

void say_nothing(exr_const_context_t, exr_result_t, const char*) {}

/// An open file; empty where it cannot be opened.
class OpenExr {
  public:
    explicit OpenExr(const std::string& file) {
        exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
        how.error_handler_fn = say_nothing;
        if (exr_start_read(&exr_, file.c_str(), &how) != EXR_ERR_SUCCESS) exr_ = nullptr;
    }
    ~OpenExr() {
        if (exr_) exr_finish(&exr_);
    }
    OpenExr(const OpenExr&) = delete;
    OpenExr& operator=(const OpenExr&) = delete;

    exr_const_context_t get() const { return exr_; }

  private:
    exr_context_t exr_ = nullptr;
};

/// Scan lines of a block; 0 where the part is no scan lines under zip.
int block_rows(exr_const_context_t exr) {
    exr_storage_t storage{};
    exr_compression_t compression{};
    std::int32_t parts = 0, rows = 0;
    const bool known = exr_get_count(exr, &parts) == EXR_ERR_SUCCESS && parts == 1 &&
                       exr_get_storage(exr, 0, &storage) == EXR_ERR_SUCCESS &&
                       exr_get_compression(exr, 0, &compression) == EXR_ERR_SUCCESS &&
                       exr_get_scanlines_per_chunk(exr, 0, &rows) == EXR_ERR_SUCCESS;
    const bool zipped = compression == EXR_COMPRESSION_ZIP || compression == EXR_COMPRESSION_ZIPS;
    return known && storage == EXR_STORAGE_SCANLINE && zipped ? rows : 0;
}

/// The image's channels in the order of the file; empty where they are not those of the file.
std::vector<Channel*> in_file_order(exr_const_context_t exr, Image& image) {
    const exr_attr_chlist_t* list = nullptr;
    if (exr_get_channels(exr, 0, &list) != EXR_ERR_SUCCESS) return {};
    if (static_cast<std::size_t>(list->num_channels) != image.channels.size()) return {};
    std::vector<Channel*> channels;
    for (int c = 0; c < list->num_channels; ++c) {
        const exr_attr_chlist_entry_t& entry = list->entries[c];
        Channel* channel = image.find(std::string(entry.name.str));
        const bool fits = channel && entry.x_sampling == 1 && entry.y_sampling == 1 &&
                          entry.pixel_type == (channel->is_id() ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT);
        if (!fits) return {};
        channels.push_back(channel);
    }
    return channels;
}

unsigned char* bytes_of(Channel& channel, std::size_t pixel) {
    void* values = channel.is_id() ? static_cast<void*>(channel.ids().data())
                                   : static_cast<void*>(channel.floats().data());
    return static_cast<unsigned char*>(values) + 4 * pixel;
}

}  // namespace

bool read_zipped(const std::string& file, Image& image) {
    const OpenExr exr(file);
    if (!exr.get()) return false;
    const int rows = block_rows(exr.get());
    const std::vector<Channel*> channels =
        rows > 0 ? in_file_order(exr.get(), image) : std::vector<Channel*>();
    exr_attr_box2i_t window{};
    if (channels.empty() || exr_get_data_window(exr.get(), 0, &window) != EXR_ERR_SUCCESS) return false;
    if (window.min.y != image.y0 || window.max.y - window.min.y + 1 != image.data_height ||
        window.max.x - window.min.x + 1 != image.data_width)
        return false;

    const std::size_t blocks = static_cast<std::size_t>((image.data_height + rows - 1) / rows);
    std::atomic<bool> good = true;
    parallel_for(blocks, 1, [&](std::size_t first, std::size_t last) {
        std::vector<unsigned char*> values(channels.size());
        std::vector<unsigned char> packed;
        for (std::size_t b = first; b < last && good; ++b) {
            const int row = static_cast<int>(b) * rows, here = std::min(rows, image.data_height - row);
            exr_chunk_info_t chunk{};
            if (exr_read_scanline_chunk_info(exr.get(), 0, image.y0 + row, &chunk) != EXR_ERR_SUCCESS ||
                chunk.start_y != image.y0 + row || chunk.height != here ||
                chunk.packed_size > chunk.unpacked_size) {
                good = false;
                break;
            }
            packed.resize(chunk.packed_size);
            for (std::size_t c = 0; c < channels.size(); ++c)
                values[c] = bytes_of(
                    *channels[c], static_cast<std::size_t>(row) * static_cast<std::size_t>(image.data_width));
            if (exr_read_chunk(exr.get(), 0, &chunk, packed.data()) != EXR_ERR_SUCCESS ||
                !unzip_block(packed, values, here, image.data_width))
                good = false;
        }
    });
    return good;
}

}  // namespace trilens
