#include "measure/common/comparable.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "base/util/error.h"

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

/// A channel that is shorter than the image would be read beyond its end.
void require_whole(const Image& image, const std::string& which) {
    if (image.data_width < 0 || image.data_height < 0)
        refuse("data window", "the " + which + "'s has no size");
    for (const Channel& channel : image.channels) {
        const std::size_t size = channel.is_id() ? channel.ids().size() : channel.floats().size();
        if (size != image.pixels())
            refuse(channel.name, "the " + which + "'s channel has not one value per pixel");
    }
}

/// "reflectID.object" of "reflect.object", "reflectP.X" of "reflect.X"; other names as they are.
std::string newer_name(const std::string& name) {
    const std::size_t dot = name.find('.');
    const std::string layer = name.substr(0, dot);
    if (dot == std::string::npos || (layer != "reflect" && layer != "refract" && layer != "direct"))
        return name;
    const std::string channel = name.substr(dot + 1);
    for (const char* id : {"object", "primitive"})
        if (channel == id) return layer + "ID." + channel;
    for (const char* place : {"X", "Y", "Z", "length"})
        if (channel == place) return layer + "P." + channel;
    return name;
}

/// The channel that `image` calls by that name or by the older or newer one.
const Channel* find_by_any_name(const Image& image, const std::string& name) {
    if (const Channel* channel = image.find(name)) return channel;
    for (const Channel& channel : image.channels)
        if (newer_name(channel.name) == newer_name(name)) return &channel;
    return nullptr;
}

void require_same_channels(const Image& one, const Image& other, const std::string& only_where) {
    for (const Channel& channel : one.channels) {
        if (channel.name == kBoundChannel) continue;  // it speaks of its own picture
        const Channel* match = find_by_any_name(other, channel.name);
        if (!match) refuse(channel.name, "only " + only_where + " has this channel");
        if (match->is_id() != channel.is_id())
            refuse(channel.name, "one has the channel as float, the other as uint");
    }
}

}  // namespace

void require_comparable(const Image& reference, const Image& test) {
    require_whole(reference, "reference");
    require_whole(test, "test");
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

std::string seen_channel(const Image& image, const std::string& layer, const std::string& name) {
    const std::string older = channel_of(layer, name), newer = newer_name(older);
    return image.find(newer) ? newer : older;
}

namespace {

/// What `other` calls the channel that `image` calls `name`: the same, or the older or newer name of what is
/// seen.
const Channel* counterpart(const Image& image, const std::string& name, const Image& other) {
    if (const Channel* channel = other.find(name)) return channel;
    for (const char* layer : {"reflect", "refract"})
        for (const char* seen : {"object", "primitive", "X", "Y", "Z", "length"})
            if (seen_channel(image, layer, seen) == name) return other.find(seen_channel(other, layer, seen));
    return nullptr;
}

std::vector<std::string> names_only_in(const Image& image, const Image& other) {
    std::vector<std::string> names;
    for (const Channel& channel : image.channels) {
        if (channel.name == kBoundChannel) continue;
        const Channel* match = counterpart(image, channel.name, other);
        if (!match || match->is_id() != channel.is_id()) names.push_back(channel.name);
    }
    return names;
}

void drop(Image& image, const std::vector<std::string>& names) {
    std::erase_if(image.channels, [&](const Channel& channel) {
        return std::find(names.begin(), names.end(), channel.name) != names.end();
    });
}

}  // namespace

CommonChannels keep_common_channels(Image reference, Image test) {
    CommonChannels common;
    common.only_reference = names_only_in(reference, test);
    common.only_test = names_only_in(test, reference);
    drop(reference, common.only_reference);
    drop(test, common.only_test);
    common.reference = std::move(reference);
    common.test = std::move(test);
    return common;
}

}  // namespace trilens
