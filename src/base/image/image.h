// Pictures with named channels, as values, and strip by strip while they are drawn.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "base/util/ids.h"

namespace trilens {

/// One channel: float or 32-bit id, one value per pixel of the data window, rows from the top.
struct Channel {
    std::string name;  // as in the file: "R", "reflectID.object"
    std::variant<std::vector<float>, std::vector<Id>> values;

    bool is_id() const { return values.index() == 1; }
    const std::vector<float>& floats() const { return std::get<0>(values); }
    std::vector<float>& floats() { return std::get<0>(values); }
    const std::vector<Id>& ids() const { return std::get<1>(values); }
    std::vector<Id>& ids() { return std::get<1>(values); }
};

/// A film of `width` x `height` pixels of which the data window [x0, x0 + data_width) x [y0, y0 +
/// data_height) holds values.
struct Image {
    int width = 0, height = 0;
    int x0 = 0, y0 = 0, data_width = 0, data_height = 0;
    std::vector<Channel> channels;
    std::map<std::string, std::string> metadata;  // "trilens:scene" and its like

    std::size_t pixels() const {
        return static_cast<std::size_t>(data_width) * static_cast<std::size_t>(data_height);
    }
    const Channel* find(const std::string& name) const {
        for (const Channel& channel : channels)
            if (channel.name == name) return &channel;
        return nullptr;
    }
    Channel* find(const std::string& name) {
        return const_cast<Channel*>(static_cast<const Image*>(this)->find(name));
    }
};

// Who takes a picture strip by strip, while it is drawn.

/// Both are called in order, from one thread.
struct StripSink {
    /// First: the picture's windows, its header, and its channels by name and type, without values.
    std::function<void(const Image& layout)> begin;
    /// Then the next `rows` rows of every channel, from the top; the vectors may be longer.
    std::function<void(const std::vector<Channel>& channels, int rows)> add;
};

}  // namespace trilens
