#include "suite/judge.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/util/error.h"
#include "base/util/format.h"
#include "measure/common/statistics.h"
#include "measure/compare_layers.h"
#include "suite/layer_rules.h"

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

}  // namespace trilens
