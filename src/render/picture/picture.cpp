#include "render/picture/picture.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/names.h"
#include "base/util/version.h"
#include "paths/trace/follow.h"
#include "render/engines/engine.h"
#include "render/marks/marks.h"
#include "render/picture/picture_progress.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

std::string resolution_text(const World& world, int asked) {
    std::string text;
    for (const Optic& optic : world.optics)
        text += (text.empty() ? "" : ",") + std::to_string(grid_resolution(optic, asked));
    return text;
}

std::string rays_text(const World& world, const FrameParams& frame) {
    std::string text;
    for (std::size_t i = 0; i < world.optics.size(); ++i)
        text += (text.empty() ? "" : ",") + std::string(name_of(optic_rays(world, i, frame)));
    return text;
}

void tell(const World& world, const LayerRequest& window, const LayerStatistics& statistics,
          const Warn& warn) {
    const Film& film = world.scene.film;
    if (window.x1 - window.x0 == film.width && window.y1 - window.y0 == film.height) {
        if (world.optics.empty())
            warn("the scene has no optic: only the direct view is drawn");
        else if (statistics.optic_pixels == 0)
            warn("no pixel sees an optic: they are off screen, behind the camera, or hidden");
        const Scene& scene = world.scene;
        if (world.objects.size() == 0 && !world.blended && scene.volumes.empty() && scene.points.empty() &&
            scene.labels.empty())
            warn("the scene has no objects: rays see only the background");
    }
    if (statistics.pixels_without_ray > 0)
        warn(
            fmt::format("{} pixels see a facet without rays (total internal reflection at a corner, or no "
                        "normal); that path is black there",
                        statistics.pixels_without_ray));
    if (statistics.unbounded_pixels > 0)
        warn(fmt::format(
            "the layer coverage says nothing of {} pixels (0 and 1): it is about facets, so not with "
            "max-error, the classic engine or exact surfaces, nor which of several optics is seen "
            "where the rectangles around them overlap",
            statistics.unbounded_pixels));
}

/// Tells what is drawn by another way than was asked for, as soon as it is decided.
class CrowdedOutTeller {
  public:
    explicit CrowdedOutTeller(const Warn& warn) : warn_(warn) {}
    void operator()(std::size_t facets) {
        if (!warn_ || facets <= told_) return;
        told_ = facets;
        warn_(fmt::format(
            "{} facets are traced, not projected: the paths over all would take more than {} MiB; "
            "fewer facets or a smaller maxDepth need less",
            facets, DivideParams().most_bytes >> 20));
    }

  private:
    const Warn& warn_;
    std::size_t told_ = 0;
};

/// Facets that a picture can hold without a word, and pixels that one should have for projecting to pay.
constexpr std::size_t kManyFacets = 65536, kPixelsPerFacet = 16;

/// What costs more than it gives, before it is done: samples of a pixel that see one facet are shaded once,
/// so with fewer pixels than facets each facet's rays are followed for less than one of them, where tracing
/// follows one for each sample (docs/speed.md has the times).
void advise_on_facets(const World& world, const PictureRequest& request, const LayerRequest& window,
                      const Warn& warn) {
    const std::size_t facets = facet_count(world, request.frame.resolution);
    const std::size_t pixels =
        static_cast<std::size_t>(window.x1 - window.x0) * static_cast<std::size_t>(window.y1 - window.y0);
    if (facets < kManyFacets || facets <= pixels) return;
    const double of_one = static_cast<double>(std::max<std::size_t>(1, facet_count(world, 1))),
                 wanted = static_cast<double>(pixels / kPixelsPerFacet);
    const double resolution = std::floor(std::sqrt(wanted / of_one));
    const std::string fewer = resolution < 1 ? ""
                                             : fmt::format("; with -n {} a facet is shared by {} pixels",
                                                           resolution, kPixelsPerFacet);
    warn(fmt::format("{} facets for {} pixels: trace is exact and takes less time{}", facets, pixels, fewer));
}

/// Of the light on all optics: less is not told of.
constexpr double kToldShare = 0.002;
/// Of the time of a picture with points: what finding their images is taken for.
constexpr double kShareOfMarks = 0.3;

/// What probing the optics' facets was found to cost and to bring; empty where all of them are used.
std::vector<OpticProbes> probes_of(const World& world, const Viewer& viewer) {
    std::vector<OpticProbes> found;
    for (std::size_t i = 0; viewer.has_facets() && i < world.optics.size(); ++i) {
        const ProbeReport& report = viewer.paths(i).probe_report;
        if (!report.plan.decides()) continue;
        const ProbeCosts& costs = report.plan.costs();
        found.push_back(
            {world.optics[i].mesh, report.surveyed, report.plan.least_samples(), costs.inside, costs.saved});
    }
    return found;
}

/// What a picture leaves out of the scene.
void tell_omissions(const World& world, Engine engine, const LayerStatistics& statistics, const Warn& warn) {
    const RenderSettings& settings = world.scene.render;
    const std::string why =
        follows_paths(engine) ? "maxDepth is 0" : "engine " + engine_name(engine) + " knows no others";
    if (settings.max_depth > 0 && follows_paths(engine)) {
        // Light that a whole picture hardly has is nobody's concern; `left_out` has it all the same.
        const auto pixels = static_cast<double>(statistics.optic_pixels);
        if (statistics.deep_sum > kToldShare * pixels)
            warn(fmt::format(
                "paths end after {} optics (maxDepth {}): at {} of {} pixels on optics light that would go "
                "on "
                "to another is drawn straight on, past it, {:.1f} % in the mean, up to {:.1f} %; light that "
                "runs along a hollow mirror, or "
                "inside a wall of glass, meets them many times",
                settings.max_depth + 1, settings.max_depth, statistics.deep_pixels, statistics.optic_pixels,
                100 * statistics.deep_sum /
                    static_cast<double>(std::max<std::size_t>(statistics.deep_pixels, 1)),
                100 * statistics.deep_light));
        return;
    }
    if (world.optics.size() > 1 && (settings.reflect || settings.refract))
        warn("optics do not see each other: a path ends after its first optic (" + why + ")");
    for (const Optic& optic : world.optics)
        if (!optic.mirror && settings.refract)
            warn(world.names[optic.mesh] +
                 ": glass bends light once, at the surface that is seen: maxDepth is 0, so where light "
                 "leaves a "
                 "body is not followed");
}

/// The window as it is drawn: the whole film where none is asked for.
LayerRequest checked_layers(const World& world, LayerRequest asked) {
    const Film& film = world.scene.film;
    if (asked.x0 == 0 && asked.y0 == 0 && asked.x1 == 0 && asked.y1 == 0)
        asked.x1 = film.width, asked.y1 = film.height;
    if (asked.x0 < 0 || asked.y0 < 0 || asked.x1 > film.width || asked.y1 > film.height ||
        asked.x0 >= asked.x1 || asked.y0 >= asked.y1)
        throw UsageError(fmt::format("{},{},{},{} is not a window of the {} x {} film", asked.x0, asked.y0,
                                     asked.x1, asked.y1, film.width, film.height));
    for (const std::string& layer : asked.layers)
        if (std::find(layer_names().begin(), layer_names().end(), layer) == layer_names().end())
            throw UsageError("there is no layer \"" + layer + "\"" + suggestion(layer, layer_names()));
    return asked;
}

/// Layers that are asked for and say nothing.
void warn_of_layers(const LayerRequest& asked, Engine engine, const Warn& warn) {
    const auto has = [&](const char* layer) {
        return std::find(asked.layers.begin(), asked.layers.end(), layer) != asked.layers.end();
    };
    for (const char* layer : {"magnification", "ray"})
        if (has(layer) && !has("reflect") && !has("refract"))
            warn(fmt::format(
                "layer {} stands beside reflect and refract: without either of them it is not written",
                layer));
    if (has("magnification") && engine == Engine::kLimitTruth)
        warn("layer magnification is that of facets: exact surfaces have none, and it is 0 everywhere");
}

/// Refuses a film whose layers alone would fill the machine's memory: the system would end the program
/// without a word.
void check_film_fits(const World& world, const LayerRequest& window, bool in_strips) {
    // Up to 34 channels, once more while they are encoded; in strips only the encoded ones are held.
    const double bytes_per_pixel = (in_strips ? 1 : 2) * 34 * 4;
    const double needed = bytes_per_pixel * (window.x1 - window.x0) * (window.y1 - window.y0);
    const double memory =
        static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    if (needed < memory) return;
    throw InputError(
        scene_title(world.scene), "/film",
        fmt::format("an image of {} x {} pixels needs about {:.0f} GiB; this machine has {:.0f}",
                    window.x1 - window.x0, window.y1 - window.y0, needed / (1 << 30), memory / (1 << 30)));
}

void describe(const World& world, const PictureRequest& request, Image& image) {
    const Engine engine = request.engine.engine;
    auto& header = image.metadata;
    header["trilens:version"] = kVersion;
    header["trilens:command"] = projects(engine) ? "render" : "trace";
    header["trilens:engine"] = engine_name(engine);
    if (engine == Engine::kClassic) header["trilens:classic"] = classic_name(request.engine.classic);
    header["trilens:camera"] = world.scene.cameras[request.frame.camera].name;
    header["trilens:resolution"] = resolution_text(world, request.frame.resolution);
    if (engine != Engine::kLimitTruth) {
        header["trilens:rays"] = rays_text(world, request.frame);
        const double max_error = request.frame.max_error.value_or(world.scene.render.max_error);
        if (max_error > 0) header["trilens:max_error"] = fmt::format("{}", max_error);
    }
    header["trilens:facets"] = std::to_string(facet_count(world, request.frame.resolution));
    header["trilens:scene"] = world.scene.resolved;
    header["trilens:folder"] = world.scene.folder;
    header["trilens:files"] = named_files_text(world.scene);
}

Image with_room_for_values(Image layout) {
    for (Channel& channel : layout.channels)
        std::visit([&](auto& values) { values.resize(layout.pixels()); }, channel.values);
    return layout;
}

/// Copies `rows` rows of every channel to row `first` of the image on.
void collect_strip(const std::vector<Channel>& channels, int first, int rows, Image& image) {
    const std::size_t width = static_cast<std::size_t>(image.data_width),
                      from = static_cast<std::size_t>(first) * width,
                      count = static_cast<std::size_t>(rows) * width;
    for (std::size_t i = 0; i < channels.size(); ++i)
        std::visit(
            [&](auto& values) {
                const auto& strip = std::get<std::decay_t<decltype(values)>>(channels[i].values);
                std::copy_n(strip.begin(), count, values.begin() + static_cast<std::ptrdiff_t>(from));
            },
            image.channels[i].values);
}

}  // namespace

Picture draw_picture(const World& world, const PictureRequest& request, const Progress& progress,
                     const Warn& warn, const StripSink* sink) {
    const LayerRequest layers = checked_layers(world, request.layers);
    check_film_fits(world, layers, sink != nullptr);
    warn_of_roughness(world, request.frame, request.engine, warn);
    if (warn) warn_of_layers(layers, request.engine.engine, warn);
    if (warn && projects(request.engine.engine)) advise_on_facets(world, request, layers, warn);
    Picture picture;
    const Stopwatch preparing;
    const bool exact = request.engine.engine == Engine::kLimitTruth;
    const Progress after_beams =
        prepare_caustics(world, exact, prepare_many_optics(world, request, progress));
    const std::unique_ptr<Viewer> viewer =
        make_viewer(world, request.frame, request.engine, ViewerCallbacks{warn, progress.cancel});
    const Progress after_gathering = gather_seen(world, *viewer, layers, after_beams);
    const double share_of_marks = world.scene.points.empty() ? 0 : kShareOfMarks;
    if (share_of_marks > 0) after_gathering.begin_stage("images of points", share_of_marks);
    const PlacedMarks marks = place_marks(world, request.frame, after_gathering.part(0, share_of_marks));
    if (share_of_marks > 0) after_gathering.begin_stage("");
    const MarkPainter painter(world, marks, layers.shown);
    picture.prepare_seconds = preparing.seconds();

    // Strips pass by the one who watches to the one who takes the picture; without one they are collected.
    Image collected;
    StripSink described;
    described.begin = [&](Image layout) {
        describe(world, request, layout);
        if (request.watch) request.watch->begin(layout);
        if (sink)
            sink->begin(layout);
        else
            collected = with_room_for_values(std::move(layout));
    };
    described.add = [&, row = 0](const std::vector<Channel>& channels, int rows) mutable {
        if (request.watch) request.watch->add(channels, rows);
        if (sink)
            sink->add(channels, rows);
        else
            collect_strip(channels, row, rows, collected);
        row += rows;
    };
    const bool in_strips = sink || request.watch;
    const Stopwatch drawing;
    picture.image =
        draw_layers(world, *viewer, layers, after_gathering.part(share_of_marks, 1 - share_of_marks),
                    {&picture.statistics, in_strips ? &described : nullptr,
                     marks.marks.empty() ? nullptr : &painter, CrowdedOutTeller(warn)});
    if (in_strips && !sink) picture.image = std::move(collected);
    picture.draw_seconds = drawing.seconds();
    picture.statistics.probes = probes_of(world, *viewer);
    picture.statistics.marks = marks.marks.size();
    picture.statistics.hidden_marks = marks.hidden;
    picture.statistics.crowded_marks = marks.crowded_out;
    picture.statistics.unseen_marks = marks.unseen;
    describe(world, request, picture.image);
    if (warn) {
        tell(world, layers, picture.statistics, warn);
        tell_omissions(world, request.engine.engine, picture.statistics, warn);
        tell_marks(world, marks, warn);
    }
    if (request.engine.engine == Engine::kLimitTruth)
        picture.statistics.traced_pixels = picture.statistics.optic_pixels;
    return picture;
}

}  // namespace trilens
