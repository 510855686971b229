#include "study/compare_inputs.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/util/error.h"
#include "image/image_parts.h"
#include "measure/common/comparable.h"

namespace trilens {
namespace {

/// A set of channels PREFIX.R, PREFIX.G, PREFIX.B of one part.
struct FoundLayer {
    std::size_t part = 0;
    std::string prefix;  // empty: the root
    std::string name;    // as people call it: the part's name before the prefix, where there are several
};

bool has_colours(const Image& image, const std::string& prefix) {
    for (const char* colour : {"R", "G", "B"}) {
        const Channel* channel = image.find(channel_of(prefix, colour));
        if (!channel || channel->is_id()) return false;
    }
    return true;
}

std::string layer_name(const std::string& part, const std::string& prefix) {
    if (part.empty() || prefix == part || prefix.rfind(part + ".", 0) == 0) return prefix;
    return prefix.empty() ? part : part + "." + prefix;
}

std::vector<FoundLayer> layers_of(const std::vector<ImagePart>& parts) {
    std::vector<FoundLayer> found;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const std::string part = parts.size() > 1 ? parts[p].name : "";
        for (const Channel& channel : parts[p].image.channels) {
            const bool is_root = channel.name == "R";
            const std::size_t dot = channel.name.rfind('.');
            if (!is_root && (dot == std::string::npos || channel.name.substr(dot) != ".R")) continue;
            const std::string prefix = is_root ? "" : channel.name.substr(0, dot);
            if (has_colours(parts[p].image, prefix)) found.push_back({p, prefix, layer_name(part, prefix)});
        }
    }
    return found;
}

std::string list_names(const std::vector<FoundLayer>& layers) {
    std::string names;
    for (const FoundLayer& layer : layers)
        names += (names.empty() ? "" : ", ") + (layer.name.empty() ? "R G B without a name" : layer.name);
    return names;
}

std::vector<FoundLayer> matching(const std::vector<FoundLayer>& layers, const std::vector<ImagePart>& parts,
                                 const std::string& asked) {
    const auto those = [&](const auto& is_meant) {
        std::vector<FoundLayer> kept;
        std::copy_if(layers.begin(), layers.end(), std::back_inserter(kept), is_meant);
        return kept;
    };
    if (asked.empty()) {
        const std::vector<FoundLayer> roots = those([](const FoundLayer& l) { return l.prefix.empty(); });
        return roots.empty() ? layers : roots;
    }
    const std::vector<FoundLayer> named = those([&](const FoundLayer& l) { return l.name == asked; });
    if (!named.empty()) return named;
    const std::vector<FoundLayer> prefixed = those([&](const FoundLayer& l) { return l.prefix == asked; });
    return prefixed.empty() ? those([&](const FoundLayer& l) { return parts[l.part].name == asked; })
                            : prefixed;
}

/// PREFIX.R becomes R; what had that name goes.
void move_to_root(Image& image, const std::string& prefix) {
    if (prefix.empty()) return;
    for (const char* colour : {"R", "G", "B", "A"}) {
        std::erase_if(image.channels, [&](const Channel& channel) { return channel.name == colour; });
        if (Channel* channel = image.find(channel_of(prefix, colour))) channel->name = colour;
    }
}

}  // namespace

Image read_compared_image(const std::string& file, const std::string& layer) {
    std::vector<ImagePart> parts = read_image_parts(file);
    const std::vector<FoundLayer> layers = layers_of(parts);
    if (layers.empty()) throw InputError(file, "", "has no layer with channels R, G and B");
    const std::vector<FoundLayer> meant = matching(layers, parts, layer);
    if (meant.empty())
        throw InputError(file, "", "has no layer \"" + layer + "\"; it has " + list_names(layers));
    if (meant.size() > 1)
        throw InputError(file, "", "has several layers, name one of them: " + list_names(meant));
    Image image = std::move(parts[meant[0].part].image);
    move_to_root(image, meant[0].prefix);
    return image;
}

}  // namespace trilens
