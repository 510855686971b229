#include "render/layers.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "render/channels.h"

namespace trilens {
namespace {

/// Samples that are held at once; bounds the memory of a frame.
constexpr std::size_t kBandSamples = 1u << 18;

/// Whether a path that the scene asks for has no ray at this sample, and not because all light is reflected.
bool lacks_ray(const World& world, const SampleViews& views, const SampleView& view) {
    if (view.optic == kNone) return false;
    const Optic& optic = world.optics[view.optic];
    const RenderSettings& settings = world.scene.render;
    if (optic.mirror) return settings.reflect && !views.find(view, Path::kReflect);
    return settings.refract && !views.find(view, Path::kRefract) && !view.traced &&
           !reflects_totally(world.scene.materials[optic.material], view.incidence);
}

SampleColour mean_colour(const World& world, const SampleViews& views, std::size_t first, std::size_t count) {
    SampleColour sum;
    for (std::size_t s = first; s < first + count; ++s) {
        const SampleColour one = sample_colour(world, views, views.samples[s]);
        sum.direct += one.direct;
        sum.reflect += one.reflect;
        sum.refract += one.refract;
        sum.coverage += one.coverage;
    }
    const double share = 1.0 / static_cast<double>(count);
    return {share * sum.direct, share * sum.reflect, share * sum.refract, share * sum.coverage};
}

/// How many rows of pixels are drawn together: whole blocks of sixteen, as files keep them, where they are
/// many.
int band_rows(std::size_t samples_per_row) {
    const int rows = static_cast<int>(std::max<std::size_t>(1, kBandSamples / samples_per_row));
    return rows > 16 ? rows / 16 * 16 : rows;
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
    SampleViews views, centres;
    for (int y = request.y0; y < request.y1; y += rows) {
        if (progress.cancelled()) throw Interrupted();
        const SampleGrid grid{request.x0, y, request.x1, std::min(y + rows, request.y1), side};
        viewer(grid, views);

        // With one sample a pixel its centre is that sample; otherwise the centres are looked at once more.
        if (side > 1) viewer({grid.x0, grid.y0, grid.x1, grid.y1, 1}, centres);
        const SampleViews& middle = side > 1 ? centres : views;
        const std::size_t first =
            sink ? 0 : static_cast<std::size_t>(y - request.y0) * static_cast<std::size_t>(grid.width());
        parallel_for(grid.pixels(), 256, [&](std::size_t from, std::size_t to) {
            for (std::size_t p = from; p < to; ++p) {
                canvas.put_colour(mean_colour(world, views, p * per_pixel, per_pixel), first + p);
                canvas.put_centre(world, middle, middle.samples[p], first + p);
            }
        });
        for (const SampleView& view : middle.samples) {
            counts.optic_pixels += view.optic != kNone;
            counts.pixels_without_ray += lacks_ray(world, middle, view);
            counts.traced_pixels += view.traced;
            counts.subdivided_pixels += !view.traced && view.level > 0;
            counts.faint_light = std::max(counts.faint_light, view.cut.faint);
            counts.predicted_error = std::max(counts.predicted_error, view.predicted);
            counts.deep_light = std::max(counts.deep_light, view.cut.too_deep);
        }
        if (sink) sink->add(canvas.image().channels, grid.height());
        counts.projected_facets = std::max(counts.projected_facets, middle.projected_facets);
        progress(static_cast<double>(grid.y1 - request.y0) / height);
    }
    if (statistics) *statistics = counts;
    return sink ? empty_image(world, request) : canvas.take();
}

}  // namespace trilens
