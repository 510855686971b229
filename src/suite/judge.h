// A picture held against a reference by the rules of a test.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "measure/common/comparable.h"
#include "suite/render_test.h"

namespace trilens {

/// The picture at one resolution.
struct TestPicture {
    int resolution = 0;  // 0: as the scene says
    Image image;
};

struct Judgement {
    std::vector<std::string> reasons, notes;
    std::vector<NamedMetric> metrics;  // none where the images cannot be compared
    std::optional<CommonChannels> images;
};

/// Judges the last of the pictures; the others count for the order of the displacement alone. Broken are:
/// another size; channels of the reference that the picture lacks, where trilens wrote the reference (another
/// program's are left out, with a note); values that are not finite; the rules of test.compare; test.max.
/// `by_layer`: every layer that either image has is there in both and agrees (layer_rules.h).
Judgement judge(const RenderTest& test, const Image& reference, std::vector<TestPicture> pictures,
                bool by_layer = false);

/// "rmse 0.01, rgb_flip 0.02, displacement_p95 0.3, lost_percent 0.1": the numbers that say most.
std::string metrics_text(const std::vector<NamedMetric>& metrics);

}  // namespace trilens
