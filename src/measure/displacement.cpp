#include "measure/displacement.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "measure/comparable.h"
#include "measure/folds.h"
#include "measure/image_finder.h"
#include "measure/other_image.h"

namespace trilens {
namespace {

std::size_t count(const std::vector<Shift>& states, Shift wanted) {
    return static_cast<std::size_t>(std::count(states.begin(), states.end(), wanted));
}

/// The shifts of all pixels of the finder's test; of the statistics only the losses.
Displacement find_shifts(const ImageFinder& finder, const std::vector<std::uint8_t>& mask, double radius) {
    const SeenField& field = finder.test();
    Displacement result;
    result.state.assign(mask.size(), Shift::kNothing);
    result.shift_x.assign(mask.size(), 0);
    result.shift_y.assign(mask.size(), 0);
    std::vector<std::uint8_t> is_beyond(mask.size(), 0);
    parallel_for(mask.size(), 512, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (!mask[i] || !field.shows_layer(i)) continue;
            result.state[i] = Shift::kLost;
            if (!field.sees(i)) continue;
            const std::optional<Vec2> shift = finder.find(field.seen_point(i));
            if (!shift) continue;
            is_beyond[i] = glm::length(*shift) > radius;
            if (is_beyond[i]) continue;
            result.state[i] = Shift::kFound;
            result.shift_x[i] = static_cast<float>(shift->x);
            result.shift_y[i] = static_cast<float>(shift->y);
        }
    });
    drop_other_images(result, field.width);
    result.lost = count(result.state, Shift::kLost);
    result.beyond_radius = static_cast<std::size_t>(std::count(is_beyond.begin(), is_beyond.end(), 1));
    return result;
}

void collect_statistics(const std::vector<std::uint8_t>& near_fold, Displacement& result) {
    std::vector<double> sizes, regular;
    for (std::size_t i = 0; i < result.state.size(); ++i) {
        if (result.state[i] != Shift::kFound) continue;
        sizes.push_back(glm::length(Vec2(result.shift_x[i], result.shift_y[i])));
        if (!near_fold[i]) regular.push_back(sizes.back());
    }
    result.pixels = sizes.size();
    result.near_folds = sizes.size() - regular.size();
    if (!regular.empty()) result.mean_off_folds = summarize(std::move(regular)).mean;
    if (!sizes.empty()) result.summary = summarize(std::move(sizes));
}

/// Pixels that show the layer in one of the images or in both.
std::size_t count_shown(const SeenField& one, const SeenField& other, const std::vector<std::uint8_t>& mask) {
    std::size_t shown = 0;
    for (std::size_t i = 0; i < mask.size(); ++i)
        shown += mask[i] && (one.shows_layer(i) || other.shows_layer(i));
    return shown;
}

}  // namespace

std::optional<Displacement> measure_displacement(const Image& reference, const Image& test,
                                                 const std::string& layer,
                                                 const DisplacementOptions& options) {
    require_comparable(reference, test);
    const std::vector<std::uint8_t> mask = compared_pixels(reference, test, options.mask_object);
    const std::optional<SeenField> reference_field = make_seen_field(reference, layer);
    const std::optional<SeenField> test_field = make_seen_field(test, layer);
    if (!reference_field || !test_field) return std::nullopt;

    const ImageFinder finder(*reference_field, *test_field);
    Displacement result = find_shifts(finder, mask, options.radius);
    collect_statistics(near_folds(finder.reference()), result);
    result.missing = find_shifts({*test_field, *reference_field}, mask, options.radius).lost;
    const std::size_t shown = count_shown(*reference_field, *test_field, mask);
    if (shown > 0) result.coverage = static_cast<double>(result.pixels) / static_cast<double>(shown);
    return result;
}

}  // namespace trilens
