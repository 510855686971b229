#include "suite/layer_rules.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/util/format.h"

namespace trilens {
namespace {

constexpr double kEnvironment = 1e29;  // depths beyond stand for no surface

/// "X" of "reflectP.X".
std::string part_of(const std::string& channel) {
    const std::size_t dot = channel.rfind('.');
    return dot == std::string::npos ? channel : channel.substr(dot + 1);
}

bool is_one_of(const std::string& part, const std::vector<std::string>& parts) {
    return std::find(parts.begin(), parts.end(), part) != parts.end();
}

double largest(const std::vector<float>& values) {
    double most = 0;
    for (const float value : values)
        if (std::fabs(value) < kEnvironment) most = std::max<double>(most, std::fabs(value));
    return most;
}

/// Whether two values of a kind of channel differ by more than they may.
struct ChannelRule {
    double absolute = 0, relative = 0;

    bool is_off(double reference, double test) const {
        if (std::isnan(reference) || std::isnan(test)) return std::isnan(reference) != std::isnan(test);
        if (reference == test) return false;
        return !(std::fabs(reference - test) <=
                 absolute + relative * std::max(std::fabs(reference), std::fabs(test)));
    }
};

ChannelRule rule_of(const Channel& channel) {
    const std::string part = part_of(channel.name);
    const bool has_layer = part != channel.name;
    if (is_one_of(part, {"R", "G", "B", "A"})) return {kColourOff, 0};
    if (has_layer && is_one_of(part, {"X", "Y", "Z"})) return {kPositionOff * largest(channel.floats()), 0};
    if (is_one_of(part, {"U", "V"})) return {kParameterOff, 0};
    return {0, kOtherOff};
}

void mark_off(const Channel& reference, const Channel& test, std::vector<char>& off) {
    if (reference.is_id()) {
        for (std::size_t p = 0; p < off.size(); ++p) off[p] |= reference.ids()[p] != test.ids()[p];
        return;
    }
    const ChannelRule rule = rule_of(reference);
    for (std::size_t p = 0; p < off.size(); ++p)
        off[p] |= rule.is_off(reference.floats()[p], test.floats()[p]);
}

}  // namespace

std::string layer_of(const std::string& channel) {
    return channel.substr(0, channel.rfind('.'));
}

std::vector<std::string> layers_of(const std::vector<std::string>& channels) {
    std::map<std::string, std::string> lists;
    for (const std::string& channel : channels) {
        std::string& list = lists[layer_of(channel)];
        list += (list.empty() ? "" : ", ") + channel;
    }
    std::vector<std::string> texts;
    for (const auto& [layer, list] : lists) texts.push_back(layer + " (" + list + ")");
    return texts;
}

std::vector<std::string> broken_layers(const CommonChannels& images) {
    const std::size_t pixels =
        static_cast<std::size_t>(images.test.data_width) * static_cast<std::size_t>(images.test.data_height);
    std::map<std::string, std::vector<char>> off;
    for (const Channel& channel : images.reference.channels) {
        const Channel* test = images.test.find(channel.name);
        if (!test) continue;
        std::vector<char>& of_layer = off[layer_of(channel.name)];
        of_layer.resize(pixels, 0);
        mark_off(channel, *test, of_layer);
    }
    std::vector<std::string> reasons;
    for (const auto& [layer, pixel_off] : off) {
        const auto count = static_cast<std::size_t>(std::count(pixel_off.begin(), pixel_off.end(), 1));
        if (static_cast<double>(count) > kLayerPixelsOff * static_cast<double>(pixels))
            reasons.push_back(fmt::format("the layer {} differs at {} of {} pixels", layer, count, pixels));
    }
    return reasons;
}

std::vector<std::string> missing_layers(const CommonChannels& images) {
    std::vector<std::string> reasons;
    for (const std::string& layer : layers_of(images.only_reference))
        reasons.push_back("the picture lacks the layer " + layer + ", which the reference has");
    for (const std::string& layer : layers_of(images.only_test))
        reasons.push_back("the reference lacks the layer " + layer + ", which the picture has");
    return reasons;
}

}  // namespace trilens
