#include "measure/comparable.h"

#include <algorithm>
#include <sstream>

#include "base/error.h"

namespace trilens {
namespace {

[[noreturn]] void refuse(const std::string& place, const std::string& message) {
    throw InputError("", place, "images cannot be compared: " + message);
}

std::string size_of(const Image& image) {
    std::ostringstream text;
    text << image.width << "x" << image.height;
    return text.str();
}

std::string window_of(const Image& image) {
    std::ostringstream text;
    text << image.data_width << "x" << image.data_height << " at (" << image.x0 << ", " << image.y0 << ")";
    return text.str();
}

void require_same_channels(const Image& one, const Image& other, const std::string& only_where) {
    for (const Channel& channel : one.channels) {
        const Channel* match = other.find(channel.name);
        if (!match) refuse(channel.name, "only " + only_where + " has this channel");
        if (match->is_id() != channel.is_id())
            refuse(channel.name, "one has the channel as float, the other as uint");
    }
}

}  // namespace

void require_comparable(const Image& reference, const Image& test) {
    if (reference.width != test.width || reference.height != test.height)
        refuse("size", "the reference is " + size_of(reference) + ", the test " + size_of(test));
    if (window_of(reference) != window_of(test))
        refuse("data window",
               "the reference's is " + window_of(reference) + ", the test's " + window_of(test));
    require_same_channels(reference, test, "the reference");
    require_same_channels(test, reference, "the test");
}

std::vector<std::uint8_t> compared_pixels(const Image& reference, const Image& test,
                                          std::optional<Id> mask_object) {
    if (!mask_object) return std::vector<std::uint8_t>(reference.pixels(), 1);
    const std::vector<Id>&a = id_channel(reference, "optic.object"), &b = id_channel(test, "optic.object");
    std::vector<std::uint8_t> mask(reference.pixels());
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = a[i] == *mask_object || b[i] == *mask_object;
    if (std::find(mask.begin(), mask.end(), 1) == mask.end())
        throw InputError("", "optic.object", "no pixel shows object " + std::to_string(*mask_object));
    return mask;
}

const std::vector<float>& float_channel(const Image& image, std::string_view name) {
    const std::string text(name);
    const Channel* channel = image.find(text);
    if (!channel) throw InputError("", text, "there is no such channel");
    if (channel->is_id()) throw InputError("", text, "this channel holds ids, not floats");
    return channel->floats();
}

const std::vector<Id>& id_channel(const Image& image, std::string_view name) {
    const std::string text(name);
    const Channel* channel = image.find(text);
    if (!channel) throw InputError("", text, "there is no such channel");
    if (!channel->is_id()) throw InputError("", text, "this channel holds floats, not ids");
    return channel->ids();
}

std::string channel_of(const std::string& layer, const std::string& name) {
    return layer.empty() ? name : layer + "." + name;
}

}  // namespace trilens
