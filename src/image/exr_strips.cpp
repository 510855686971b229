#include "image/exr_file.h"

#include <OpenEXR/openexr.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <numeric>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "base/files/files.h"
#include "base/util/check.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "image/image_io.h"

namespace trilens {
namespace {

constexpr const char* kOwnPrefix = "trilens:";

/// Blocks on their way: enough for many threads, small beside a picture.
constexpr std::size_t kMostBlocksTogether = 64;

/// Of a file's bytes that its taker is handed at once, or a little more.
constexpr std::size_t kHandedOn = std::size_t{1} << 20;

/// Of a file's bytes before they are known, as many as its values have.
constexpr std::size_t kMostRoom = std::size_t{1} << 30;

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

void check_layout(const Image& image) {
    TRILENS_CHECK(image.width > 0 && image.height > 0 && image.data_width > 0 && image.data_height > 0,
                  "an image has pixels");
    TRILENS_CHECK(!image.channels.empty(), "an image has channels");
    std::set<std::string> names;
    for (const Channel& channel : image.channels)
        TRILENS_CHECK(!channel.name.empty() && names.insert(channel.name).second, "channel names are unique");
    for (const auto& [name, text] : image.metadata)
        TRILENS_CHECK(name.rfind(kOwnPrefix, 0) == 0, "metadata names start with trilens:");
}

constexpr std::size_t kShortName = 31;  // bytes; files with longer names (to 255) are marked for old readers

/// Where the library writes.
struct Sink {
    std::vector<unsigned char> file;  // where there is no writer
    ExrStrips::Writer writer;
    std::vector<unsigned char> pending;  // for the writer, from byte `from` of the file on
    std::uint64_t from = 0;
    std::exception_ptr failed;  // what the writer threw

    void put(std::uint64_t at, std::span<const unsigned char> bytes) {
        if (!writer) return keep(at, bytes);
        if (at != from + pending.size()) {
            flush();
            from = at;
        }
        pending.insert(pending.end(), bytes.begin(), bytes.end());
        if (pending.size() >= kHandedOn) flush();
    }
    void keep(std::uint64_t at, std::span<const unsigned char> bytes) {
        // What comes behind the others is not cleared before.
        const std::size_t known = std::min(bytes.size(), file.size() - std::min(file.size(), at));
        if (file.size() < at) file.resize(at);
        std::copy_n(bytes.begin(), known, file.begin() + static_cast<std::ptrdiff_t>(at));
        file.insert(file.end(), bytes.begin() + static_cast<std::ptrdiff_t>(known), bytes.end());
    }
    void flush() {
        if (pending.empty()) return;
        writer(from, pending);
        from += pending.size();
        pending.clear();
    }
};

const unsigned char* bytes_of(const Channel& channel, std::size_t pixel) {
    const void* values = channel.is_id() ? static_cast<const void*>(channel.ids().data())
                                         : static_cast<const void*>(channel.floats().data());
    return static_cast<const unsigned char*>(values) + 4 * pixel;
}

std::size_t size_of(const Channel& channel) {
    return channel.is_id() ? channel.ids().size() : channel.floats().size();
}

}  // namespace

struct ExrStrips::State {
    std::string name;
    Sink sink;
    exr_context_t exr = nullptr;
    int y = 0, next_row = 0, height = 0, width = 0;  // of the data window
    std::vector<std::size_t> order;                  // the layout's channels by name
    std::vector<Channel> waiting;                    // rows that do not fill a block, in the layout's order
    int waiting_rows = 0;
    std::vector<BlockScratch> scratch;  // one per block that is made at the same time

    ~State();
    void require(exr_result_t result);
    void open(const Image& layout);
    void describe(const Image& layout);
    void write_blocks(const std::vector<Channel>& channels, int first, int rows);
    void keep(const std::vector<Channel>& channels, int first, int rows);
    void write_waiting();
};

namespace {

int64_t write_to_sink(exr_const_context_t, void* user, const void* bytes, std::uint64_t size,
                      std::uint64_t offset, exr_stream_error_func_ptr_t) {
    Sink& sink = *static_cast<Sink*>(user);
    try {
        sink.put(offset, {static_cast<const unsigned char*>(bytes), size});
    } catch (...) {  // not through the library, which is C
        sink.failed = std::current_exception();
        return -1;
    }
    return static_cast<int64_t>(size);
}

/// Why the last call of this thread failed: the library tells it while it holds the file's lock, which asking
/// it for the user's data would wait for.
std::string& last_reason() {
    thread_local std::string reason;
    return reason;
}

void keep_reason(exr_const_context_t, exr_result_t, const char* message) {
    if (message) last_reason() = message;
}

}  // namespace

ExrStrips::State::~State() {
    if (exr) exr_finish(&exr);
}

void ExrStrips::State::require(exr_result_t result) {
    const std::string told = std::exchange(last_reason(), {});
    if (sink.failed) std::rethrow_exception(sink.failed);
    if (result == EXR_ERR_SUCCESS) return;
    const std::string why = told.empty() ? exr_get_default_error_message(result) : told;
    throw OutputError(name, "cannot be encoded: " + library_reason(why));
}

void ExrStrips::State::open(const Image& layout) {
    exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
    how.error_handler_fn = keep_reason;
    how.user_data = &sink;
    how.write_fn = write_to_sink;
    require(exr_start_write(&exr, name.c_str(), EXR_WRITE_FILE_DIRECTLY, &how));
    describe(layout);
    require(exr_write_header(exr));
}

void ExrStrips::State::describe(const Image& layout) {
    const auto is_long = [](const std::string& given) { return given.size() > kShortName; };
    if (std::any_of(layout.channels.begin(), layout.channels.end(),
                    [&](const Channel& channel) { return is_long(channel.name); }) ||
        std::any_of(layout.metadata.begin(), layout.metadata.end(),
                    [&](const auto& entry) { return is_long(entry.first); }))
        require(exr_set_longname_support(exr, 1));
    int part = 0;
    require(exr_add_part(exr, nullptr, EXR_STORAGE_SCANLINE, &part));
    exr_attr_box2i_t display{}, data{};
    display.max.x = layout.width - 1;
    display.max.y = layout.height - 1;
    data.min.x = layout.x0;
    data.min.y = layout.y0;
    data.max.x = layout.x0 + layout.data_width - 1;
    data.max.y = layout.y0 + layout.data_height - 1;
    const exr_attr_v2f_t centre{};
    require(exr_initialize_required_attr(exr, part, &display, &data, 1, &centre, 1,
                                         EXR_LINEORDER_INCREASING_Y, EXR_COMPRESSION_ZIP));
    for (const std::size_t c : order) {
        const Channel& channel = layout.channels[c];
        require(exr_add_channel(exr, part, channel.name.c_str(),
                                channel.is_id() ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT,
                                EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
    }
    require(exr_attr_set_string(exr, part, "capDate", fixed_date_time(name).c_str()));
    for (const auto& [key, text] : layout.metadata)
        if (!text.empty()) require(exr_attr_set_string(exr, part, key.c_str(), text.c_str()));
}

/// Rows of whole blocks, the last of the data window perhaps a smaller one. While one is written others are
/// deflated.
void ExrStrips::State::write_blocks(const std::vector<Channel>& channels, int first, int rows) {
    const std::size_t count = static_cast<std::size_t>((rows + kZipRows - 1) / kZipRows);
    const std::size_t together =
        std::min({count, kMostBlocksTogether, 2 * static_cast<std::size_t>(thread_count())});
    std::vector<std::vector<unsigned char>> packed(together);
    scratch.resize(std::max(scratch.size(), together));
    const auto rows_of = [&](std::size_t block) {
        return std::min(kZipRows, rows - static_cast<int>(block) * kZipRows);
    };
    PipelineStages stages;
    stages.begin = [](std::size_t, std::size_t) {};
    stages.work = [&](std::size_t block, std::size_t slot) {
        std::vector<BlockValues> values(order.size());
        const std::size_t row = static_cast<std::size_t>(first) + block * kZipRows;
        for (std::size_t c = 0; c < order.size(); ++c)
            values[c] = bytes_of(channels[order[c]], row * static_cast<std::size_t>(width));
        packed[slot] = zip_block(values, rows_of(block), width, scratch[slot]);
    };
    stages.end = [&](std::size_t block, std::size_t slot) {
        require(exr_write_scanline_chunk(exr, 0, y + next_row, packed[slot].data(), packed[slot].size()));
        next_row += rows_of(block);
    };
    run_pipeline(count, together, stages);
    sink.flush();
}

void ExrStrips::State::keep(const std::vector<Channel>& channels, int first, int rows) {
    const auto append = [&](auto& to, const auto& from) {
        const auto begin = from.begin() + static_cast<std::ptrdiff_t>(first) * width;
        to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(rows) * width);
    };
    for (std::size_t c = 0; c < channels.size(); ++c) {
        if (channels[c].is_id())
            append(waiting[c].ids(), channels[c].ids());
        else
            append(waiting[c].floats(), channels[c].floats());
    }
    waiting_rows += rows;
}

void ExrStrips::State::write_waiting() {
    if (waiting_rows > 0) write_blocks(waiting, 0, waiting_rows);
    waiting_rows = 0;
    for (Channel& channel : waiting) std::visit([](auto& values) { values.clear(); }, channel.values);
}

ExrStrips::ExrStrips(const std::string& name, const Image& layout) : ExrStrips(name, layout, nullptr) {}

ExrStrips::ExrStrips(const std::string& name, const Image& layout, Writer writer)
    : state_(std::make_unique<State>()) {
    check_layout(layout);
    state_->name = name;
    state_->sink.writer = std::move(writer);
    state_->y = layout.y0;
    state_->width = layout.data_width;
    state_->height = layout.data_height;
    for (const Channel& channel : layout.channels) {
        state_->waiting.push_back({channel.name, {}});
        if (channel.is_id()) state_->waiting.back().values = std::vector<Id>();
    }
    state_->order.resize(layout.channels.size());
    std::iota(state_->order.begin(), state_->order.end(), std::size_t{0});
    std::sort(state_->order.begin(), state_->order.end(), [&](std::size_t a, std::size_t b) {
        return layout.channels[a].name < layout.channels[b].name;
    });
    // Room that is not used costs nothing; a file that moves as it grows is copied, and its pages cleared.
    if (!state_->sink.writer)
        state_->sink.file.reserve(std::min(kMostRoom, 4 * layout.pixels() * layout.channels.size()));
    state_->open(layout);
}

ExrStrips::~ExrStrips() = default;

void ExrStrips::add(const std::vector<Channel>& channels, int first, int rows) {
    State& state = *state_;
    TRILENS_CHECK(channels.size() == state.waiting.size(), "a strip has the layout's channels");
    TRILENS_CHECK(rows >= 0 && state.next_row + state.waiting_rows + rows <= state.height,
                  "strips end where the data window ends");
    for (std::size_t c = 0; c < channels.size(); ++c) {
        TRILENS_CHECK(channels[c].is_id() == state.waiting[c].is_id(), "a channel keeps its type");
        TRILENS_CHECK(size_of(channels[c]) >=
                          static_cast<std::size_t>(first + rows) * static_cast<std::size_t>(state.width),
                      "a channel has one value per pixel");
    }
    if (state.waiting_rows > 0) {
        const int filling = std::min(rows, kZipRows - state.waiting_rows);
        state.keep(channels, first, filling);
        first += filling, rows -= filling;
        if (state.waiting_rows == kZipRows) state.write_waiting();
    }
    const bool last = state.next_row + state.waiting_rows + rows == state.height;
    const int whole = last && state.waiting_rows == 0 ? rows : rows / kZipRows * kZipRows;
    if (whole > 0) state.write_blocks(channels, first, whole);
    if (rows > whole) state.keep(channels, first + whole, rows - whole);
    if (last) state.write_waiting();
}

std::vector<unsigned char> ExrStrips::finish() {
    TRILENS_CHECK(state_->next_row == state_->height, "every row of the data window has come");
    state_->require(exr_finish(&state_->exr));
    state_->sink.flush();
    return std::move(state_->sink.file);
}

// Images as whole OpenEXR files.

namespace {

std::vector<unsigned char> encode(const std::string& name, const Image& image, ExrStrips::Writer writer) {
    for (const Channel& channel : image.channels) {
        const std::size_t size = channel.is_id() ? channel.ids().size() : channel.floats().size();
        TRILENS_CHECK(size == image.pixels(), "a channel has one value per pixel of the data window");
    }
    ExrStrips strips(name, image, std::move(writer));
    strips.add(image.channels, 0, image.data_height);
    return strips.finish();
}

}  // namespace

std::vector<unsigned char> encode_exr(const std::string& name, const Image& image) {
    return encode(name, image, nullptr);
}

void write_exr(const std::string& file, const Image& image) {
    NewFile made(file);
    encode(file, image,
           [&](std::uint64_t at, std::span<const unsigned char> bytes) { made.write(at, bytes); });
    made.commit();
}

}  // namespace trilens
