#include "measure/common/common_channels.h"

#include <algorithm>
#include <utility>

#include "measure/common/comparable.h"

namespace trilens {
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
