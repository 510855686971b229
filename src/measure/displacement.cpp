#include "measure/displacement.h"

#include <utility>

#include "base/parallel.h"
#include "measure/comparable.h"
#include "measure/folds.h"
#include "measure/image_finder.h"
#include "measure/other_image.h"
#include "measure/statistics.h"

namespace trilens {
namespace {

SeenPoint seen_point(const SeenField& field, std::size_t i) {
    SeenPoint seen;
    seen.point = field.point(i);
    seen.object = (*field.object)[i];
    seen.optic = field.optic_of(i);
    seen.primitive = field.primitive_of(i);
    seen.column = static_cast<int>(i % static_cast<std::size_t>(field.width));
    seen.row = static_cast<int>(i / static_cast<std::size_t>(field.width));
    return seen;
}

void collect_statistics(const std::vector<std::uint8_t>& near_fold, Displacement& result) {
    std::vector<double> sizes, regular;
    for (std::size_t i = 0; i < result.state.size(); ++i) {
        if (result.state[i] == Shift::kLost) ++result.lost;
        if (result.state[i] != Shift::kFound) continue;
        sizes.push_back(glm::length(Vec2(result.shift_x[i], result.shift_y[i])));
        if (!near_fold[i]) regular.push_back(sizes.back());
    }
    result.pixels = sizes.size();
    result.near_folds = sizes.size() - regular.size();
    result.mean_off_folds = summarize(std::move(regular)).mean;
    const Summary summary = summarize(std::move(sizes));
    result.mean = summary.mean;
    result.p50 = summary.p50;
    result.p95 = summary.p95;
    result.p99 = summary.p99;
    result.max = summary.max;
}

}  // namespace

std::optional<Displacement> measure_displacement(const Image& reference, const Image& test,
                                                 const std::string& layer,
                                                 const DisplacementOptions& options) {
    require_comparable(reference, test);
    const std::vector<std::uint8_t> mask = compared_pixels(reference, test, options.mask_object);
    std::optional<SeenField> reference_field = make_seen_field(reference, layer);
    std::optional<SeenField> test_field = make_seen_field(test, layer);
    if (!reference_field || !test_field) return std::nullopt;
    const ImageFinder finder(std::move(*reference_field), std::move(*test_field));
    const SeenField& field = finder.test();

    Displacement result;
    result.state.assign(test.pixels(), Shift::kNothing);
    result.shift_x.assign(test.pixels(), 0);
    result.shift_y.assign(test.pixels(), 0);
    parallel_for(test.pixels(), 512, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (!mask[i] || (*field.object)[i] == kNone) continue;
            result.state[i] = Shift::kLost;
            if (!field.sees(i)) continue;
            const std::optional<Vec2> shift = finder.find(seen_point(field, i), options.radius);
            if (!shift) continue;
            result.state[i] = Shift::kFound;
            result.shift_x[i] = static_cast<float>(shift->x);
            result.shift_y[i] = static_cast<float>(shift->y);
        }
    });
    drop_other_images(result, test.data_width);
    collect_statistics(near_folds(finder.reference()), result);
    return result;
}

}  // namespace trilens
