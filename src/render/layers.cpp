#include "render/layers.h"

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "base/parallel.h"
#include "render/channels.h"
#include "render/pixel_filter.h"
#include "render/surroundings.h"

namespace trilens {
namespace {

// Samples that are held at once: what stays in cache (measured), and what bounds the memory of a frame.
constexpr std::size_t kBandSamples = 1u << 16, kMostBandSamples = 1u << 18;
constexpr std::size_t kBlockRows = 16;  // of a block of the file, one thread's work

/// Whether a path that the scene asks for has no ray at this sample, and not because all light is reflected.
bool lacks_ray(const World& world, const SampleViews& views, const SampleView& view) {
    if (view.optic == kNone) return false;
    const Optic& optic = world.optics[view.optic];
    const RenderSettings& settings = world.scene.render;
    if (optic.mirror) return settings.reflect && !views.find(view, Path::kReflect);
    return settings.refract && !views.find(view, Path::kRefract) && !view.traced &&
           !reflects_totally(interface_of(world, view.optic, views.around_of(view), view.incidence.front),
                             view.incidence.cosine);
}

void add(SampleColour& sum, double weight, const SampleColour& one) {
    sum.direct += weight * one.direct;
    sum.reflect += weight * one.reflect;
    sum.refract += weight * one.refract;
    sum.coverage += weight * one.coverage;
}

SampleColour mean_colour(const World& world, const SampleViews& views, std::size_t first, std::size_t count) {
    SampleColour sum, mean;
    for (std::size_t s = first; s < first + count; ++s)
        add(sum, 1, sample_colour(world, views, views.samples[s]));
    add(mean, 1.0 / static_cast<double>(count), sum);
    return mean;
}

/// The samples of a window and of the pixels around it that a filter reaches, with their colours.
class FilteredSamples {
  public:
    FilteredSamples(const World& world, const Viewer& viewer, const SampleGrid& window,
                    const PixelFilter& filter)
        : filter_(filter), grid_(window) {
        const Film& film = world.scene.film;
        grid_.x0 = std::max(0, window.x0 - filter.reach);
        grid_.y0 = std::max(0, window.y0 - filter.reach);
        grid_.x1 = std::min(film.width, window.x1 + filter.reach);
        grid_.y1 = std::min(film.height, window.y1 + filter.reach);
        SampleViews views;
        viewer(grid_, views);
        colours_.resize(grid_.size());
        parallel_for(colours_.size(), 1024, [&](std::size_t from, std::size_t to) {
            for (std::size_t s = from; s < to; ++s)
                colours_[s] = sample_colour(world, views, views.samples[s]);
        });
    }

    /// Pixels beyond the film have no samples: the weights of those that there are count as one.
    SampleColour colour(int x, int y) const {
        SampleColour sum, mean;
        double total = 0;
        for (int py = std::max(grid_.y0, y - filter_.reach); py <= std::min(grid_.y1 - 1, y + filter_.reach);
             ++py)
            for (int px = std::max(grid_.x0, x - filter_.reach);
                 px <= std::min(grid_.x1 - 1, x + filter_.reach); ++px) {
                std::size_t sample = grid_.first_sample(px, py);
                for (int j = 0; j < grid_.side; ++j)
                    for (int i = 0; i < grid_.side; ++i) {
                        const double weight = weight_at(px - x, i) * weight_at(py - y, j);
                        add(sum, weight, colours_[sample++]);
                        total += weight;
                    }
            }
        add(mean, 1 / total, sum);
        mean.coverage = std::clamp(mean.coverage, 0.0, 1.0);
        return mean;
    }

  private:
    double weight_at(int pixel, int sample) const {
        return filter_.weights[static_cast<std::size_t>((pixel + filter_.reach) * grid_.side + sample)];
    }

    const PixelFilter& filter_;
    SampleGrid grid_;
    std::vector<SampleColour> colours_;
};

/// How many rows of pixels are drawn together: whole blocks where they are many, one for each thread at
/// least.
int band_rows(std::size_t samples_per_row) {
    const std::size_t wanted =
        std::max(kBandSamples / samples_per_row, kBlockRows * static_cast<std::size_t>(thread_count()));
    const std::size_t rows = std::max<std::size_t>(1, std::min(wanted, kMostBandSamples / samples_per_row));
    return static_cast<int>(rows > kBlockRows ? rows / kBlockRows * kBlockRows : rows);
}

Image empty_image(const World& world, const LayerRequest& request) {
    Image image;
    image.width = world.scene.film.width;
    image.height = world.scene.film.height;
    image.x0 = request.x0;
    image.y0 = request.y0;
    image.data_width = request.x1 - request.x0;
    image.data_height = request.y1 - request.y0;
    return image;
}

}  // namespace

Image draw_layers(const World& world, const Viewer& viewer, const LayerRequest& request,
                  const Progress& progress, LayerStatistics* statistics, const StripSink* sink) {
    const int side = world.scene.film.spp, height = request.y1 - request.y0;
    const std::size_t per_pixel = static_cast<std::size_t>(side * side);
    const std::size_t samples_per_row = static_cast<std::size_t>(request.x1 - request.x0) * per_pixel;
    const int rows = band_rows(samples_per_row);
    Image image = empty_image(world, request);
    if (sink) image.data_height = std::min(height, rows);
    Canvas canvas(std::move(image), request.layers);
    if (sink) {
        Image layout = canvas.layout();
        layout.data_height = height;
        sink->begin(layout);
    }
    LayerStatistics counts;
    const PixelFilter filter = make_pixel_filter(world.scene.film.filter, side);
    SampleViews views, centres;
    for (int y = request.y0; y < request.y1; y += rows) {
        if (progress.cancelled()) throw Interrupted();
        const SampleGrid grid{request.x0, y, request.x1, std::min(y + rows, request.y1), side};
        std::optional<FilteredSamples> filtered;
        if (filter.reach > 0) filtered.emplace(world, viewer, grid, filter);
        if (!filtered || side == 1) viewer(grid, views);

        // With one sample a pixel its centre is that sample; otherwise the centres are looked at once more.
        if (side > 1) viewer({grid.x0, grid.y0, grid.x1, grid.y1, 1}, centres);
        const SampleViews& middle = side > 1 ? centres : views;
        const std::size_t first =
            sink ? 0 : static_cast<std::size_t>(y - request.y0) * static_cast<std::size_t>(grid.width());
        parallel_for(grid.pixels(), 256, [&](std::size_t from, std::size_t to) {
            for (std::size_t p = from; p < to; ++p) {
                const int across = static_cast<int>(p % static_cast<std::size_t>(grid.width())),
                          down = static_cast<int>(p / static_cast<std::size_t>(grid.width()));
                canvas.put_colour(filtered ? filtered->colour(grid.x0 + across, grid.y0 + down)
                                           : mean_colour(world, views, p * per_pixel, per_pixel),
                                  first + p);
                canvas.put_centre(world, middle, middle.samples[p], first + p);
            }
        });
        for (const SampleView& view : middle.samples) {
            counts.optic_pixels += view.optic != kNone;
            counts.pixels_without_ray += lacks_ray(world, middle, view);
            counts.traced_pixels += view.traced;
            counts.layered_pixels += !view.traced && view.layers > 0;
            counts.subdivided_pixels += !view.traced && view.level > 0;
            counts.faint_light = std::max(counts.faint_light, view.cut.faint);
            counts.predicted_error = std::max(counts.predicted_error, view.predicted);
            counts.deep_light = std::max(counts.deep_light, view.cut.too_deep);
        }
        if (sink) sink->add(canvas.image().channels, grid.height());
        counts.projected_facets = std::max(counts.projected_facets, middle.projected_facets);
        counts.crowded_out = std::max(counts.crowded_out, middle.crowded_out);
        progress(static_cast<double>(grid.y1 - request.y0) / height);
    }
    if (statistics) *statistics = counts;
    return sink ? empty_image(world, request) : canvas.take();
}

}  // namespace trilens
