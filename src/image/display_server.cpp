#include "image/display_server.h"

#include <netdb.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <system_error>
#include <type_traits>
#include <utility>

#include "base/util/error.h"

namespace trilens {
namespace {

enum Operation : std::uint8_t { kCreateImage = 4, kUpdateImage = 6, kVectorGraphics = 8 };

/// Of VectorGraphics, each followed by its floats.
enum VectorCommand : std::uint8_t {
    kStrokeColour = 4,
    kStroke = 5,
    kBeginPath = 6,
    kMoveTo = 10,
    kLineTo = 11
};

constexpr int kPatience = 10;  // seconds that a viewer may take no bytes

/// Puts a message together; its length is filled in at the end.
class Writer {
  public:
    explicit Writer(Operation operation) {
        put(std::uint32_t{0});
        bytes_.push_back(operation);
    }

    template <typename Number>
    void put(Number number) {
        std::uint64_t bits = 0;
        if constexpr (std::is_same_v<Number, float>)
            bits = std::bit_cast<std::uint32_t>(number);
        else
            bits = static_cast<std::uint64_t>(number);
        for (std::size_t i = 0; i < sizeof(Number); ++i)
            bytes_.push_back(static_cast<std::uint8_t>(bits >> 8 * i));
    }
    void put_flag(bool flag) { bytes_.push_back(flag ? 1 : 0); }
    void put_text(const std::string& text) {
        for (const char c : text) bytes_.push_back(static_cast<std::uint8_t>(c));
        bytes_.push_back(0);
    }
    void reserve(std::size_t more) { bytes_.reserve(bytes_.size() + more); }

    DisplayMessage finish() {
        if (bytes_.size() > 0xffffffffu) throw OutputError("", "a tile has more bytes than a message may");
        for (std::size_t i = 0; i < 4; ++i) bytes_[i] = static_cast<std::uint8_t>(bytes_.size() >> 8 * i);
        return std::move(bytes_);
    }

  private:
    DisplayMessage bytes_;
};

std::vector<const Channel*> float_channels(const std::vector<Channel>& channels) {
    std::vector<const Channel*> floats;
    for (const Channel& channel : channels)
        if (!channel.is_id()) floats.push_back(&channel);
    return floats;
}

struct HostAndPort {
    std::string host, port;
};

HostAndPort split_address(const std::string& address) {
    const std::size_t colon = address.rfind(':');
    const auto refuse = [&]() -> UsageError {
        return UsageError("a display server is HOST:PORT, as 127.0.0.1:14158, not \"" + address + "\"");
    };
    if (colon == std::string::npos || colon == 0) throw refuse();
    HostAndPort parts{address.substr(0, colon), address.substr(colon + 1)};
    const bool is_number = !parts.port.empty() && parts.port.size() <= 5 &&
                           parts.port.find_first_not_of("0123456789") == std::string::npos;
    if (!is_number || std::stoi(parts.port) < 1 || std::stoi(parts.port) > 65535) throw refuse();
    if (parts.host.size() > 2 && parts.host.front() == '[' && parts.host.back() == ']')
        parts.host = parts.host.substr(1, parts.host.size() - 2);
    return parts;
}

std::string reason(int error) {
    return std::generic_category().message(error);
}

/// A connected socket, whose sends give up after kPatience. Throws OutputError.
int connect_to(const std::string& address) {
    const HostAndPort to = split_address(address);
    addrinfo hints{}, *found = nullptr;
    hints.ai_socktype = SOCK_STREAM;
    if (const int failed = getaddrinfo(to.host.c_str(), to.port.c_str(), &hints, &found))
        throw OutputError(address, std::string("there is no such display server: ") + gai_strerror(failed));
    int error = 0;
    for (const addrinfo* one = found; one; one = one->ai_next) {
        const int made = socket(one->ai_family, one->ai_socktype | SOCK_CLOEXEC, one->ai_protocol);
        if (made < 0) {
            error = errno;
            continue;
        }
        const timeval patience{kPatience, 0};
        setsockopt(made, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
        if (connect(made, one->ai_addr, one->ai_addrlen) == 0) {
            freeaddrinfo(found);
            return made;
        }
        error = errno == EINPROGRESS ? ETIMEDOUT : errno;
        close(made);
    }
    freeaddrinfo(found);
    throw OutputError(address, "no display server answers: " + reason(error));
}

}  // namespace

DisplayMessage create_image_message(const std::string& name, const Image& layout) {
    const std::vector<const Channel*> channels = float_channels(layout.channels);
    Writer message(kCreateImage);
    message.put_flag(true);
    message.put_text(name);
    message.put(static_cast<std::int32_t>(layout.data_width));
    message.put(static_cast<std::int32_t>(layout.data_height));
    message.put(static_cast<std::int32_t>(channels.size()));
    for (const Channel* channel : channels) message.put_text(channel->name);
    return message.finish();
}

DisplayMessage update_image_message(const std::string& name, const std::vector<Channel>& all,
                                    const DisplayRows& where) {
    const std::vector<const Channel*> channels = float_channels(all);
    const std::size_t pixels = static_cast<std::size_t>(where.width) * static_cast<std::size_t>(where.rows);
    for (const Channel* channel : channels)
        if (where.width < 0 || where.rows < 0 || channel->floats().size() < pixels)
            throw InputError("", channel->name, "has fewer values than the strip has pixels");
    Writer message(kUpdateImage);
    message.reserve(channels.size() * (64 + pixels * sizeof(float)));
    message.put_flag(false);
    message.put_text(name);
    message.put(static_cast<std::int32_t>(channels.size()));
    for (const Channel* channel : channels) message.put_text(channel->name);
    for (const int number : {0, where.y, where.width, where.rows})
        message.put(static_cast<std::int32_t>(number));
    // One channel after the other, without gaps: where each begins, and the step from pixel to pixel.
    for (std::size_t i = 0; i < channels.size(); ++i) message.put(static_cast<std::int64_t>(i * pixels));
    for (std::size_t i = 0; i < channels.size(); ++i) message.put(std::int64_t{1});
    for (const Channel* channel : channels)
        for (std::size_t i = 0; i < pixels; ++i) message.put(channel->floats()[i]);
    return message.finish();
}

DisplayMessage vector_graphics_message(const std::string& name, const std::vector<DisplayLine>& lines) {
    std::int32_t commands = 0;
    for (const DisplayLine& line : lines)
        if (line.points.size() > 1) commands += static_cast<std::int32_t>(line.points.size()) + 3;
    Writer message(kVectorGraphics);
    message.put_flag(false);
    message.put_text(name);
    message.put_flag(false);  // instead of those before
    message.put(commands);
    const auto put = [&](VectorCommand command, std::initializer_list<double> numbers) {
        message.put(static_cast<std::uint8_t>(command));
        for (const double number : numbers) message.put(static_cast<float>(number));
    };
    for (const DisplayLine& line : lines) {
        if (line.points.size() < 2) continue;
        put(kStrokeColour, {line.colour.x, line.colour.y, line.colour.z, 1});
        put(kBeginPath, {});
        for (const Vec2& point : line.points)
            put(&point == &line.points.front() ? kMoveTo : kLineTo, {point.x, point.y});
        put(kStroke, {});
    }
    return message.finish();
}

DisplayServer::DisplayServer(const std::string& address, Warn warn)
    : address_(address), warn_(std::move(warn)), socket_(connect_to(address)) {}

DisplayServer::~DisplayServer() {
    if (socket_ >= 0) close(socket_);
}

/// Once it fails nothing is sent any more.
bool DisplayServer::send(std::span<const std::uint8_t> bytes) {
    while (socket_ >= 0 && !bytes.empty()) {
        const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent >= 0) {
            bytes = bytes.subspan(static_cast<std::size_t>(sent));
            continue;
        }
        if (errno == EINTR) continue;
        const bool is_stuck = errno == EAGAIN || errno == EWOULDBLOCK;
        const std::string why =
            is_stuck ? "it takes no more for " + std::to_string(kPatience) + " s" : reason(errno);
        close(std::exchange(socket_, -1));
        if (warn_)
            warn_("the display server " + address_ + " went away (" + why + "); work goes on without it");
    }
    return socket_ >= 0;
}

bool DisplayServer::show(const std::string& name, const Image& image) {
    return send(create_image_message(name, image)) &&
           send(update_image_message(name, image.channels, {0, image.data_height, image.data_width}));
}

bool DisplayServer::update(const std::string& name, const Image& image) {
    constexpr int kRows = 64;
    const auto width = static_cast<std::size_t>(image.data_width);
    for (int y = 0; y < image.data_height && socket_ >= 0; y += kRows) {
        const int rows = std::min(kRows, image.data_height - y);
        const std::size_t first = static_cast<std::size_t>(y) * width,
                          count = static_cast<std::size_t>(rows) * width;
        std::vector<Channel> strip;
        for (const Channel* channel : float_channels(image.channels)) {
            const auto& values = channel->floats();
            strip.push_back(
                {channel->name,
                 std::vector<float>(values.begin() + static_cast<std::ptrdiff_t>(first),
                                    values.begin() + static_cast<std::ptrdiff_t>(first + count))});
        }
        send(update_image_message(name, strip, {y, rows, image.data_width}));
    }
    return socket_ >= 0;
}

bool DisplayServer::show_lines(const std::string& name, const std::vector<DisplayLine>& lines) {
    return send(vector_graphics_message(name, lines));
}

StripSink DisplayServer::sink(const std::string& name) {
    // Where the next strip begins, and how wide it is.
    auto next = std::make_shared<DisplayRows>();
    return {[this, name, next](const Image& layout) {
                *next = {0, 0, layout.data_width};
                send(create_image_message(name, layout));
            },
            [this, name, next](const std::vector<Channel>& channels, int rows) {
                next->rows = rows;
                if (socket_ >= 0) send(update_image_message(name, channels, *next));
                next->y += rows;
            }};
}

}  // namespace trilens
