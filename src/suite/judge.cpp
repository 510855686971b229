#include "suite/run_test.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/util/error.h"
#include "base/util/format.h"
#include "measure/common/statistics.h"
#include "measure/compare.h"

namespace trilens {
namespace {

std::string size_text(const Image& image) {
    std::string text = fmt::format("{} x {}", image.width, image.height);
    if (image.data_width != image.width || image.data_height != image.height)
        text += fmt::format(" with the window {},{} to {},{}", image.x0, image.y0,
                            image.x0 + image.data_width, image.y0 + image.data_height);
    return text;
}

bool is_one_size(const Image& a, const Image& b) {
    return a.width == b.width && a.height == b.height && a.x0 == b.x0 && a.y0 == b.y0 &&
           a.data_width == b.data_width && a.data_height == b.data_height;
}

void note_missing(const Image& reference, const std::vector<std::string>& channels, Judgement& judgement) {
    std::map<std::string, std::string> by_layer;
    for (const std::string& channel : channels) {
        std::string& list = by_layer[layer_of(channel)];
        list += (list.empty() ? "" : ", ") + channel;
    }
    const bool is_ours = reference.metadata.count("trilens:version") > 0;
    for (const auto& [layer, list] : by_layer) {
        if (is_ours)
            judgement.reasons.push_back("the picture lacks the layer " + layer +
                                        ", which the reference has (" + list + ")");
        else
            judgement.notes.push_back("left out, only in the reference: " + list);
    }
}

std::optional<double> mean_of(const std::vector<LayerComparison>& layers, const std::string& layer) {
    std::optional<double> worst;
    for (const LayerComparison& one : layers) {
        if (!layer.empty() && one.layer != layer) continue;
        if (one.displacement && one.displacement->summary)
            worst = std::max(worst.value_or(0), one.displacement->summary->mean);
    }
    return worst;
}

bool asks_for_order(const RenderTest& test) {
    return std::any_of(test.max.begin(), test.max.end(), [](const MetricLimit& limit) {
        return limit.metric.find("displacement_order") != std::string::npos;
    });
}

/// The order at which the mean displacement falls with the resolution; none where it was not measured twice.
void add_orders(const RenderTest& test, const Image& reference, const std::vector<TestPicture>& pictures,
                std::vector<NamedMetric>& metrics) {
    std::map<std::string, std::vector<FitPoint>> points = {{"", {}}, {"reflect", {}}, {"refract", {}}};
    for (const TestPicture& picture : pictures) {
        const CommonChannels common = keep_common_channels(reference, picture.image);
        const std::vector<LayerComparison> layers =
            compare_layers(common.reference, common.test, {test.radius, test.compare.mask_object});
        for (auto& [layer, list] : points)
            if (const std::optional<double> mean = mean_of(layers, layer))
                list.push_back({static_cast<double>(picture.resolution), *mean});
    }
    for (const auto& [layer, list] : points) {
        const std::optional<Fit> fit = fit_power_law(list);
        metrics.push_back({(layer.empty() ? "" : layer + ".") + "displacement_order",
                           fit ? std::optional(fit->order) : std::nullopt, true});
    }
}

}  // namespace

Judgement judge(const RenderTest& test, const Image& reference, std::vector<TestPicture> pictures,
                bool by_layer) {
    Judgement judgement;
    const Image& picture = pictures.back().image;
    if (!is_one_size(reference, picture)) {
        judgement.reasons.push_back("the size is " + size_text(picture) + ", and the reference's is " +
                                    size_text(reference));
        return judgement;
    }
    CommonChannels common = keep_common_channels(reference, picture);
    if (by_layer) {
        judgement.reasons = missing_layers(common);
        for (std::string& reason : broken_layers(common)) judgement.reasons.push_back(std::move(reason));
    } else {
        note_missing(reference, common.only_reference, judgement);
        for (const std::string& layer : layers_of(common.only_test))
            judgement.notes.push_back("left out, only in the picture: " + layer);
    }
    try {
        const Comparison comparison = compare(common.reference, common.test, test.compare);
        const std::vector<LayerComparison> layers =
            compare_layers(common.reference, common.test, {test.radius, test.compare.mask_object});
        judgement.metrics = named_metrics(comparison, layers);
        if (asks_for_order(test)) add_orders(test, reference, pictures, judgement.metrics);
        if (comparison.verdict == Verdict::kFailure)
            judgement.reasons.insert(judgement.reasons.end(), comparison.reasons.begin(),
                                     comparison.reasons.end());
        for (std::string& reason : broken_limits(test.max, judgement.metrics))
            judgement.reasons.push_back(std::move(reason));
    } catch (const InputError& error) {
        const std::string place = test.compare.layer.empty() ? "" : test.folder + "/test.json: /layer: ";
        judgement.reasons.push_back(place + error.what());
    }
    judgement.images = std::move(common);
    return judgement;
}

std::string metrics_text(const std::vector<NamedMetric>& metrics) {
    std::string text;
    for (const char* name : {"rmse", "rgb_flip", "displacement_p95", "displacement_order", "lost_percent",
                             "object_mismatch_percent"})
        for (const NamedMetric& metric : metrics)
            if (metric.name == name && metric.value)
                text += fmt::format("{}{} {:.4g}", text.empty() ? "" : ", ", name, *metric.value);
    return text;
}

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
