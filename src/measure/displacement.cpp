#include "measure/displacement.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "base/parallel.h"
#include "measure/comparable.h"
#include "measure/image_finder.h"
#include "measure/other_image.h"
#include "measure/reference_layers.h"

namespace trilens {
namespace {

std::size_t count(const std::vector<Shift>& states, Shift wanted) {
    return static_cast<std::size_t>(std::count(states.begin(), states.end(), wanted));
}

constexpr double kAnywhere = std::numeric_limits<double>::infinity();

Displacement nothing_shown(std::size_t pixels) {
    Displacement result;
    result.state.assign(pixels, Shift::kNothing);
    result.shift_x.assign(pixels, 0);
    result.shift_y.assign(pixels, 0);
    return result;
}

/// Column by column within bands of so many rows: pixels next to each other follow each other.
constexpr std::size_t kBand = 8;

template <typename Visit>
void for_each_in_bands(std::size_t columns, std::size_t first, std::size_t last, Visit&& visit) {
    for (std::size_t band = first; band < last; band += kBand)
        for (std::size_t column = 0; column < columns; ++column)
            for (std::size_t row = band; row < std::min(band + kBand, last); ++row)
                visit(row * columns + column);
}

/// The shifts of all pixels of the finder's test; of the statistics only the losses. Places are looked for up
/// to `reach` pixels away, at least the radius.
Displacement find_shifts(const ImageFinder& finder, const std::vector<std::uint8_t>& mask, double radius,
                         double reach) {
    const SeenField& field = finder.test().field;
    Displacement result = nothing_shown(mask.size());
    std::vector<std::uint8_t> is_beyond(mask.size(), 0);
    const std::size_t columns = static_cast<std::size_t>(field.width), rows = mask.size() / columns;
    parallel_for(
        (rows + kBand - 1) / kBand, 1 + 8192 / (kBand * columns), [&](std::size_t first, std::size_t last) {
            std::vector<SeenPoint> wanted;
            std::vector<std::size_t> pixels;
            for_each_in_bands(columns, kBand * first, std::min(kBand * last, rows), [&](std::size_t i) {
                if (!mask[i] || !field.shows_layer(i)) return;
                result.state[i] = Shift::kLost;
                if (!field.sees(i)) return;
                wanted.push_back(field.seen_point(i));
                pixels.push_back(i);
            });
            const std::vector<std::optional<Vec2>> found = finder.find(wanted, reach);
            for (std::size_t k = 0; k < found.size(); ++k) {
                if (!found[k]) continue;
                const std::size_t i = pixels[k];
                is_beyond[i] = glm::length(*found[k]) > radius;
                if (is_beyond[i]) continue;
                result.state[i] = Shift::kFound;
                result.shift_x[i] = static_cast<float>(found[k]->x);
                result.shift_y[i] = static_cast<float>(found[k]->y);
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
    return measure_displacement(ReferenceLayers(reference), test, layer, options);
}

std::optional<Displacement> measure_displacement(const ReferenceLayers& reference, const Image& test,
                                                 const std::string& layer,
                                                 const DisplacementOptions& options) {
    require_comparable(reference.image(), test);
    const std::vector<std::uint8_t> mask = compared_pixels(reference.image(), test, options.mask_object);
    const std::optional<SeenField> reference_field = make_seen_field(reference.image(), layer);
    std::optional<SeenField> test_field = make_seen_field(test, layer);
    if (!reference_field || !test_field) return std::nullopt;
    const std::size_t shown = count_shown(*reference_field, *test_field, mask);
    if (shown == 0) return nothing_shown(mask.size());

    std::shared_ptr<const ReferenceLayers::Layer> there;
    std::optional<FieldIndex> here;
    run_side_by_side({[&] { there = reference.get(layer); }, [&] { here.emplace(*test_field); }});
    Displacement result;
    std::size_t missing = 0;
    run_side_by_side({[&] {
                          const ImageFinder finder(there->index, *here);
                          result = find_shifts(finder, mask, options.radius, kAnywhere);
                          collect_statistics(there->near_folds, result);
                      },
                      [&] {
                          const ImageFinder finder(*here, there->index);
                          missing = find_shifts(finder, mask, options.radius, options.radius).lost;
                      }});
    result.missing = missing;
    result.coverage = static_cast<double>(result.pixels) / static_cast<double>(shown);
    return result;
}

}  // namespace trilens
