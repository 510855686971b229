#include "measure/displacement/displacement.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>

#include "base/util/parallel.h"
#include "measure/common/comparable.h"
#include "measure/displacement/image_finder.h"

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
constexpr int kBand = 8;

template <typename Visit>
void for_each_in_band(const PositionField& field, const FieldWindow& window, int band, Visit&& visit) {
    const int top = window.y0 + band * kBand, bottom = std::min(top + kBand, window.y1);
    for (int column = window.x0; column < window.x1; ++column)
        for (int row = top; row < bottom; ++row) visit(field.index(column, row));
}

/// Whether both fields show the same triangle through the same optic at the pixel, or both the environment,
/// at finite places. Where a field does not tell triangles, the same object counts.
bool shows_same(const PositionField& one, const PositionField& other, std::size_t pixel) {
    return one.sees(pixel) && other.sees(pixel) && (*one.object)[pixel] == (*other.object)[pixel] &&
           one.optic_of(pixel) == other.optic_of(pixel) &&
           (!one.primitive || !other.primitive || one.primitive_of(pixel) == other.primitive_of(pixel));
}

/// What shows the same in both pictures is not lost, even where nothing tells how far apart it lies.
void tell_unmeasured(const ImageFinder& finder, std::vector<Shift>& states) {
    const PositionField &reference = finder.reference().field, &test = finder.test().field;
    for (std::size_t i = 0; i < states.size(); ++i)
        if (states[i] == Shift::kLost && shows_same(reference, test, i)) states[i] = Shift::kUnmeasured;
}

/// The shifts of all pixels of the finder's test; of the statistics only the losses. Places are looked for up
/// to `reach` pixels away, at least the radius.
Displacement find_shifts(const ImageFinder& finder, const std::vector<std::uint8_t>& mask, double radius,
                         double reach) {
    const PositionField& field = finder.test().field;
    Displacement result = nothing_shown(mask.size());
    std::vector<std::uint8_t> is_beyond(mask.size(), 0);
    const FieldWindow& shown = finder.test().shown;
    const std::size_t bands = static_cast<std::size_t>(shown.y1 - shown.y0 + kBand - 1) / kBand;
    const std::size_t grain = 1 + 8192 / static_cast<std::size_t>(kBand * std::max(1, shown.x1 - shown.x0));
    parallel_for(bands, grain, [&](std::size_t first, std::size_t last) {
        std::vector<FieldSample> wanted;
        std::vector<std::size_t> pixels;
        const auto look_for = [&](std::size_t i) {
            if (!mask[i] || !field.shows_layer(i)) return;
            result.state[i] = Shift::kLost;
            if (!field.sees(i)) return;
            wanted.push_back(field.seen_point(i));
            pixels.push_back(i);
        };
        for (std::size_t band = first; band < last; ++band)
            for_each_in_band(field, shown, static_cast<int>(band), look_for);
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
    tell_unmeasured(finder, result.state);
    result.lost = count(result.state, Shift::kLost);
    result.unmeasured = count(result.state, Shift::kUnmeasured);
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
std::size_t count_shown(const PositionField& one, const PositionField& other,
                        const std::vector<std::uint8_t>& mask) {
    std::atomic<std::size_t> shown = 0;
    parallel_for(mask.size(), 16384, [&](std::size_t first, std::size_t last) {
        std::size_t here = 0;
        for (std::size_t i = first; i < last; ++i)
            here += mask[i] && (one.shows_layer(i) || other.shows_layer(i));
        shown += here;
    });
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
    const std::optional<PositionField> reference_field = make_seen_field(reference.image(), layer);
    std::optional<PositionField> test_field = make_seen_field(test, layer);
    if (!reference_field || !test_field) return std::nullopt;
    const std::size_t shown = count_shown(*reference_field, *test_field, mask);
    if (shown == 0) return nothing_shown(mask.size());

    std::shared_ptr<const ReferenceLayers::Layer> there;
    std::optional<FieldPyramid> here;
    run_side_by_side({[&] { there = reference.get(layer); }, [&] { here.emplace(*test_field); }});
    Displacement result;
    std::size_t missing = 0;
    run_side_by_side({[&] {
                          const ImageFinder finder(there->index, *here, there->reaches.get());
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

// --- Outlier rejection ---

namespace {

constexpr int kWindowReach = 3;  // of the 7 x 7 window

/// Shifts below this are never another image: the bound of the test at a median of zero.
constexpr double kLeast = kOtherImage * 0.5;

/// Whether the shift exceeds the bound by the window's median: by more than half of the window's shifts.
bool is_jump(const Displacement& displacement, std::span<const double> size, int width, std::size_t pixel) {
    const int height = static_cast<int>(size.size()) / width;
    const int column = static_cast<int>(pixel) % width, row = static_cast<int>(pixel) / width;
    std::size_t around = 0, small = 0;
    for (int y = std::max(0, row - kWindowReach); y <= std::min(height - 1, row + kWindowReach); ++y) {
        for (int x = std::max(0, column - kWindowReach); x <= std::min(width - 1, column + kWindowReach);
             ++x) {
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
            const bool is_found = i != pixel && displacement.state[i] == Shift::kFound;
            around += is_found;
            small += is_found && size[pixel] > kOtherImage * (size[i] + 0.5);
        }
    }
    return around >= kFewestNeighbours && small > around / 2;
}

}  // namespace

void drop_other_images(Displacement& displacement, int width) {
    std::vector<double> size(displacement.state.size());
    parallel_for(size.size(), 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            if (displacement.state[i] == Shift::kFound)
                size[i] = std::hypot(displacement.shift_x[i], displacement.shift_y[i]);
    });

    // All are judged by the field as it was found, so the outcome does not depend on an order.
    std::vector<std::uint8_t> jump(size.size(), 0);
    parallel_for(size.size(), 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            jump[i] = displacement.state[i] == Shift::kFound && size[i] > kLeast &&
                      is_jump(displacement, size, width, i);
    });
    for (std::size_t i = 0; i < size.size(); ++i) {
        if (!jump[i]) continue;
        displacement.state[i] = Shift::kLost;
        displacement.shift_x[i] = displacement.shift_y[i] = 0;
    }
}

}  // namespace trilens
