// A client of tev's network protocol: shows pictures in the viewer tev, tile by tile, while they are drawn.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/math/vec.h"
#include "base/util/error.h"

namespace trilens {

/// The bytes of one message. Each is its own length (uint32, itself included), an operation, and what goes
/// with it; numbers are little-endian, texts end with a zero byte. After src/Ipc.cpp of tev
/// (https://github.com/Tom94/tev), operations CreateImage (4), UpdateImageV3 (6) and VectorGraphics (8).
using DisplayMessage = std::vector<std::uint8_t>;

/// Makes an empty picture of that name with the size of the layout's data window and its channels of floats,
/// and brings it to the front; replaces one of the same name.
DisplayMessage create_image_message(const std::string& name, const Image& layout);

struct DisplayRows {
    int y = 0, rows = 0, width = 0;
};

/// Rows `y` .. `y + rows - 1` of the picture: the channels of floats, of which each holds at least
/// `rows * width` values, rows from the top. Throws InputError where one has fewer.
DisplayMessage update_image_message(const std::string& name, const std::vector<Channel>& channels,
                                    const DisplayRows& where);

/// A polyline over a picture: pixels from its top left, colour in 0..1.
struct DisplayLine {
    std::vector<Vec2> points;
    Vec3 colour{1};
};

/// Lines over the picture, instead of those that it has: operation VectorGraphics (8), for each line a
/// colour, a path and its stroke (commands 4, 6, 10, 11 and 5 of tev's include/tev/VectorGraphics.h).
/// Lines of fewer than two points are left out.
DisplayMessage vector_graphics_message(const std::string& name, const std::vector<DisplayLine>& lines);

/// A connection to a viewer. Channels of ids are not sent: the viewer knows floats alone.
class DisplayServer {
  public:
    /// `address`: "HOST:PORT" (tev listens at 127.0.0.1:14158), HOST a name, an IPv4 address or an IPv6 one
    /// in brackets. `warn`: told once where the viewer goes away later; drawing goes on without it. Throws
    /// UsageError for what is no address, OutputError where nobody answers there within some seconds.
    explicit DisplayServer(const std::string& address, Warn warn = {});
    ~DisplayServer();
    DisplayServer(const DisplayServer&) = delete;
    DisplayServer& operator=(const DisplayServer&) = delete;

    /// Shows a picture that is there. Returns whether the viewer has taken it.
    bool show(const std::string& name, const Image& image);

    /// Puts a picture in the place of the one of that name, which has its size and channels, in strips: the
    /// viewer goes on showing what it shows. Returns whether the viewer has taken all of it.
    bool update(const std::string& name, const Image& image);

    /// Draws lines over the picture of that name, instead of those that it has. Returns as show does.
    bool show_lines(const std::string& name, const std::vector<DisplayLine>& lines);

    /// Whether the viewer is still there, as far as is known.
    bool is_connected() const { return socket_ >= 0; }

    /// Shows a picture while it is drawn: for PictureRequest::watch. Must not outlive the server.
    StripSink sink(const std::string& name);

  private:
    bool send(std::span<const std::uint8_t> bytes);

    std::string address_;
    Warn warn_;
    int socket_ = -1;
};

}  // namespace trilens
