#include "render/picture/picture.h"

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "render/frame/camera_rays.h"
#include "render/marks/marks.h"
#include "render/picture/channels.h"
#include "render/picture/fragments.h"
#include "render/picture/picture_counts.h"
#include "render/picture/picture_progress.h"
#include "render/picture/rough_light.h"
#include "render/picture/sample_colour.h"

namespace trilens {
namespace {

// Samples that are held at once: what stays in cache (measured), and what bounds the memory of a frame.
constexpr std::size_t kBandSamples = 1u << 15, kMostBandSamples = 1u << 17;
constexpr std::size_t kMostKeys = 1u << 20;  // the same where samples have no record but a key
/// Facets of many optics take a while: pictures of them have so many bands at least, of which progress tells.
constexpr std::size_t kManyOptics = 32;
constexpr int kBandsOfMany = 24;
constexpr std::size_t kBandsAtOnce = 3;  // on their way: seen, shaded, taken
constexpr std::size_t kPixelsPerTask = 256, kColoursPerTask = 1024;
constexpr std::size_t kBlockRows = 16;  // of a block of the file, one thread's work
// Of a drawing, until its pixels are shaded; then the last of them are taken.
constexpr double kShadingShare = 0.999;

/// Whether light is gathered over what a sample stands for, however many a pixel has.
bool gathers_light(const World& world) {
    return has_caustics(world) || has_rough_optics(world);
}

SampleColour mean_colour(const PixelFilter& filter, std::span<const SampleColour> samples) {
    SampleColour sum, mean;
    for (const SampleColour& sample : samples) add(sum, 1, filter.averaged(sample));
    add(mean, 1.0 / static_cast<double>(samples.size()), sum);
    return mean;
}

/// The samples of a window and of the pixels around it that a filter reaches, with their colours.
class FilteredSamples {
  public:
    FilteredSamples(const PixelSource& source, const SampleGrid& window)
        : filter_(source.filter), grid_(window) {
        const auto& [world, viewer, filter, progress, shaded] = source;
        const Film& film = world.scene.film;
        grid_.x0 = std::max(0, window.x0 - filter.reach);
        grid_.y0 = std::max(0, window.y0 - filter.reach);
        grid_.x1 = std::min(film.width, window.x1 + filter.reach);
        grid_.y1 = std::min(film.height, window.y1 + filter.reach);
        SampleViews views;
        viewer.view(grid_, views);
        colours_.resize(grid_.size());
        const double pixels_per_sample =
            static_cast<double>(window.pixels()) / static_cast<double>(grid_.size());
        const RayDifferentials differentials(world, viewer, grid_, progress.cancel);
        parallel_for(colours_.size(), kColoursPerTask, [&](std::size_t from, std::size_t to) {
            source.progress.stop_if_cancelled();
            sample_colours(source.world, views, from, std::span(colours_).subspan(from, to - from),
                           grid_.side == 1 || gathers_light(source.world) ? &differentials : nullptr);
            for (std::size_t s = from; s < to; ++s) colours_[s] = filter_.averaged(colours_[s]);
            source.shaded.add(pixels_per_sample * static_cast<double>(to - from));
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

/// Volumes and blended surfaces are not the same over a fragment's samples.
bool makes_fragments(const World& world, const Viewer& viewer, const LayerRequest& request, int side) {
    return side > 1 && world.volumes.empty() && !world.blended && request.shading == Shading::kFragment &&
           viewer.has_keys();
}

/// How many rows of pixels are drawn together: whole blocks where they are many, one for every two threads at
/// least, since several bands are on their way.
int band_rows(std::size_t samples_per_row, std::size_t most_samples) {
    const std::size_t wanted = std::max(kBandSamples / samples_per_row,
                                        kBlockRows * ((static_cast<std::size_t>(thread_count()) + 1) / 2));
    const std::size_t rows = std::max<std::size_t>(1, std::min(wanted, most_samples / samples_per_row));
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

/// A band of rows on its way from what its samples see to the pixels of the image.
struct Band {
    SampleGrid grid{};
    SampleViews views,
        centres;  // centres: only where a pixel has several samples, and no fragments have them
    bool filter_reaches = false;  // beyond the pixel
    std::unique_ptr<FilteredSamples> filtered;
    std::unique_ptr<FragmentColours> fragments;
    LayerStatistics counts;
    std::vector<Id> shown;  // by the pixels' centres; empty: coverage is not asked for
    std::vector<CoverageBounds> coverage;

    /// What the pixels' centres see: with one sample a pixel that sample, otherwise looked at once more.
    const SampleViews& middle() const {
        if (fragments && !filter_reaches) return fragments->centres();
        return grid.side > 1 ? centres : views;
    }
    /// How often the samples of a pixel of the grid are shaded.
    std::size_t fragment_count(std::size_t pixel) const {
        if (!fragments) return static_cast<std::size_t>(grid.side * grid.side);
        const std::size_t width = static_cast<std::size_t>(grid.width());
        return fragments->count_at(grid.x0 + static_cast<int>(pixel % width),
                                   grid.y0 + static_cast<int>(pixel / width));
    }
};

/// What all bands are drawn of.
struct BandSource {
    PixelSource pixels;
    bool by_fragments = false;  // see makes_fragments()
    bool bounds_coverage = false;
    const MarkPainter* marks = nullptr;

    /// The same for a band that is that share of the picture's work.
    BandSource of_share(double share, const SampleGrid& grid) const {
        BandSource own = *this;
        own.pixels.shaded.of_pixel = share / static_cast<double>(grid.pixels());
        return own;
    }
};

void view_band(const BandSource& source, Band& band) {
    const auto& [world, viewer, filter, progress, shaded] = source.pixels;
    const SampleGrid& grid = band.grid;
    band.filtered.reset();
    band.fragments.reset();
    if (source.by_fragments)
        band.fragments = std::make_unique<FragmentColours>(source.pixels, grid);
    else if (filter.reach > 0)
        band.filtered = std::make_unique<FilteredSamples>(source.pixels, grid);
    if (grid.side == 1 || (!band.filtered && !band.fragments)) viewer.view(grid, band.views);
    band.filter_reaches = filter.reach > 0;
    if (grid.side > 1 && (!band.fragments || band.filter_reaches))
        viewer.view({grid.x0, grid.y0, grid.x1, grid.y1, 1}, band.centres);
    if (!source.bounds_coverage) return;
    band.shown.clear();
    for (const SampleView& view : band.middle().samples) band.shown.push_back(shown_mesh(world, view));
    band.coverage.resize(band.shown.size());
    viewer.bound_coverage({grid.x0, grid.y0, grid.x1, grid.y1, 1}, band.shown, band.coverage);
}

/// Colours of the pixels of a band from `first` on, as many as there is room for.
void find_colours(const BandSource& source, const Band& band, std::size_t first,
                  std::span<SampleColour> colours) {
    const auto& [world, viewer, filter, progress, shaded] = source.pixels;
    const SampleGrid& grid = band.grid;
    if (band.filtered || band.fragments) {
        const std::size_t width = static_cast<std::size_t>(grid.width());
        for (std::size_t i = 0; i < colours.size(); ++i) {
            const int x = grid.x0 + static_cast<int>((first + i) % width),
                      y = grid.y0 + static_cast<int>((first + i) / width);
            colours[i] = band.filtered ? band.filtered->colour(x, y) : band.fragments->colour(x, y);
        }
        return;
    }
    const std::size_t per_pixel = static_cast<std::size_t>(grid.side * grid.side);
    if (per_pixel == 1) {
        const RayDifferentials differentials(world, viewer, grid, progress.cancel);
        sample_colours(world, band.views, first, colours, &differentials);
        for (SampleColour& colour : colours) colour = filter.averaged(colour);
        return;
    }
    std::vector<SampleColour> samples(colours.size() * per_pixel);
    const RayDifferentials differentials(world, viewer, grid, progress.cancel);
    sample_colours(world, band.views, first * per_pixel, samples,
                   gathers_light(world) ? &differentials : nullptr);
    for (std::size_t i = 0; i < colours.size(); ++i)
        colours[i] = mean_colour(filter, std::span(samples).subspan(i * per_pixel, per_pixel));
}

void paint_marks(const BandSource& source, const Band& band, std::size_t first,
                 std::span<SampleColour> colours) {
    const std::size_t width = static_cast<std::size_t>(band.grid.width());
    for (std::size_t i = 0; i < colours.size(); ++i) {
        const SampleView& view = band.middle().samples[first + i];
        source.marks->paint(band.grid.x0 + static_cast<int>((first + i) % width),
                            band.grid.y0 + static_cast<int>((first + i) / width),
                            view.optic == kNone ? kNone : source.pixels.world.optics[view.optic].mesh,
                            colours[i]);
    }
}

/// Its pixels, from that `first` of the canvas on.
LayerStatistics put_band(const BandSource& source, const Band& band, std::size_t first, Canvas& canvas) {
    const World& world = source.pixels.world;
    const SampleViews& middle = band.middle();
    LayerStatistics counts;
    counts.projected_facets = middle.projected_facets;
    counts.crowded_out = middle.crowded_out;
    counts.outline_pixels = middle.outline_pixels;
    counts.predicted_error = middle.outline_error;
    if (band.fragments) {
        counts.fragment_pixels = band.fragments->counts().pixels;
        counts.fragments = band.fragments->counts().fragments;
        counts.rays_by_sample = band.fragments->counts().by_sample;
        counts.pixels_shaded_by_sample = band.fragments->counts().pixels_by_sample;
    }
    if (source.bounds_coverage) {
        canvas.put_coverage(band.shown, band.coverage, first);
        counts.unbounded_pixels = static_cast<std::size_t>(
            std::count_if(band.coverage.begin(), band.coverage.end(),
                          [](const CoverageBounds& one) { return one.low <= 0 && one.high >= 1; }));
    }
    std::mutex mutex;
    parallel_for(band.grid.pixels(), kPixelsPerTask, [&](std::size_t from, std::size_t to) {
        LayerStatistics own;
        std::array<SampleColour, kPixelsPerTask> colours;
        for (std::size_t start = from; start < to; start += kPixelsPerTask) {
            source.pixels.progress.stop_if_cancelled();
            const std::size_t end = std::min(to, start + kPixelsPerTask);
            const std::span<SampleColour> here = std::span(colours).first(end - start);
            find_colours(source, band, start, here);
            if (!band.filtered && !band.fragments) source.pixels.shaded.add(static_cast<double>(end - start));
            if (source.marks) paint_marks(source, band, start, here);
            canvas.put_colours(here, first + start);
            for (std::size_t p = start; p < end; ++p) {
                canvas.put_centre(world, middle, middle.samples[p], first + p);
                canvas.put_fragment_count(band.fragment_count(p), first + p);
                count_pixel(world, middle, middle.samples[p], own);
            }
        }
        const std::lock_guard lock(mutex);
        merge_counts(own, counts);
    });
    return counts;
}

/// Leaves that the viewer has worked out.
std::size_t count_leaves(const World& world, const Viewer& viewer) {
    std::size_t leaves = 0;
    for (std::size_t i = 0; viewer.has_facets() && i < world.optics.size(); ++i)
        leaves += viewer.paths(i).leaves.size();
    return leaves;
}

/// Seconds that a strip of rows takes to view and to shade, but for what is worked out with it once and for
/// all.
double time_strip(const BandSource& source, const SampleGrid& strip) {
    const auto& [world, viewer, filter, progress, shaded] = source.pixels;
    Band band;
    band.grid = strip;
    const std::size_t known = count_leaves(world, viewer);
    Stopwatch watch;
    view_band(source, band);
    if (count_leaves(world, viewer) > 2 * known) {
        watch = {};
        view_band(source, band);
    }
    std::vector<SampleColour> colours(strip.pixels());
    parallel_for(colours.size(), kPixelsPerTask, [&](std::size_t from, std::size_t to) {
        source.pixels.progress.stop_if_cancelled();
        find_colours(source, band, from, std::span(colours).subspan(from, to - from));
    });
    return watch.seconds();
}

/// What share of the work rows are: measured where somebody is told how much is done, and by facets, which
/// take up to a hundred times as long in some rows as in others.
RowShares row_shares(const BandSource& source, const LayerRequest& request, int side) {
    const Progress& told = source.pixels.progress;
    if (!told.report || !source.pixels.viewer.has_facets()) return {request.y0, request.y1};
    Progress silent;
    silent.cancel = told.cancel;
    const BandSource quiet{{source.pixels.world, source.pixels.viewer, source.pixels.filter, silent, {}},
                           source.by_fragments};
    return RowShares::measured(request.y0, request.y1, [&](int from, int to) {
        told.stop_if_cancelled();
        return time_strip(quiet, {request.x0, from, request.x1, to, side});
    });
}

}  // namespace

Image draw_layers(const World& world, Viewer& viewer, const LayerRequest& request, const Progress& progress,
                  const LayerOutput& output) {
    const auto& sink = output.sink;  // no structured binding: Clang 14 does not capture one
    const int side = world.scene.film.spp, width = request.x1 - request.x0, height = request.y1 - request.y0;
    const bool by_fragments = makes_fragments(world, viewer, request, side);
    int rows =
        band_rows(static_cast<std::size_t>(width * side * side), by_fragments ? kMostKeys : kMostBandSamples);
    if (world.optics.size() >= kManyOptics) rows = std::min(rows, std::max(1, height / kBandsOfMany));
    const std::size_t bands = static_cast<std::size_t>((height + rows - 1) / rows);
    const std::size_t slots = std::min({bands, kBandsAtOnce, static_cast<std::size_t>(thread_count())});

    // Where pixels go to a sink each band on its way has a canvas of its own, otherwise all share the
    // image's.
    Image image = empty_image(world, request);
    if (sink) image.data_height = std::min(height, rows);
    std::vector<Canvas> canvases;
    for (std::size_t i = 0; i < (sink ? slots : 1); ++i) canvases.emplace_back(image, request.layers);
    if (sink) {
        Image layout = canvases[0].layout();
        layout.data_height = height;
        sink->begin(layout);
    }

    LayerStatistics counts;
    PixelFilter filter = make_pixel_filter(world.scene.film.filter, side);
    filter.shown = request.shown;
    const Progress shading = progress.part(0, kShadingShare);
    LoopProgress shaded(shading, 1);
    const BandSource source{{world, viewer, filter, progress, {&shaded}},
                            by_fragments,
                            canvases[0].wants_coverage(),
                            output.marks};
    const RowShares shares = row_shares(source, request, side);
    const auto source_of = [&](const SampleGrid& grid) {
        return source.of_share(shares.of(grid.y0, grid.y1), grid);
    };
    std::vector<Band> band(slots);
    PipelineStages stages;
    stages.begin = [&](std::size_t item, std::size_t slot) {
        progress.stop_if_cancelled();
        const int y = request.y0 + static_cast<int>(item) * rows;
        band[slot].grid = {request.x0, y, request.x1, std::min(y + rows, request.y1), side};
        view_band(source_of(band[slot].grid), band[slot]);
        if (output.crowded_out) output.crowded_out(band[slot].middle().crowded_out);
    };
    stages.work = [&](std::size_t item, std::size_t slot) {
        const std::size_t above = sink ? 0 : item * static_cast<std::size_t>(rows);
        band[slot].counts = put_band(source_of(band[slot].grid), band[slot],
                                     above * static_cast<std::size_t>(width), canvases[sink ? slot : 0]);
    };
    stages.end = [&](std::size_t, std::size_t slot) {
        merge_counts(band[slot].counts, counts);
        if (sink) sink->add(canvases[slot].image().channels, band[slot].grid.height());
    };
    run_pipeline(bands, slots, stages);
    progress(1);
    if (output.statistics) *output.statistics = counts;
    return sink ? empty_image(world, request) : canvases[0].take();
}

}  // namespace trilens
