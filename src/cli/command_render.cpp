// trilens render and trilens trace: one picture.
#include <trilens/files.h>
#include <trilens/image.h>
#include <trilens/regions.h>
#include <trilens/render.h>
#include <trilens/stopwatch.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "answer/explanation.h"
#include "answer/picture.h"
#include "cli/commands.h"
#include "cli/image_output.h"
#include "cli/scene_options.h"
#include "terminal/format.h"

namespace trilens {
namespace {

struct RenderOptions {
    SceneOptions scene;
    std::string output;
    std::string pixel;  // "x,y"
    std::string engine = "exact";
    std::string clip = "scene";
    int slices = 0, tessellate = 0;  // 0: not asked for
    std::string surface = "limit";
    std::string format;  // empty: by the output's ending
    bool wire = false, folds = false;
    std::string rays;       // empty: each optic's own
    double max_error = -1;  // < 0: as the scene says
    std::string grid;       // empty: as the scene says
};

/// What an output is, by --format or its name's ending: "exr", "png" or "svg". Standard output gets OpenEXR
/// where nothing else is asked for.
std::string output_format(const RenderOptions& options, const std::string& command) {
    if (!options.format.empty()) return options.format;
    if (is_standard_stream(options.output)) return "exr";
    const std::string ending = std::filesystem::path(options.output).extension().string();
    if (ending == ".exr" || ending == ".png" || (ending == ".svg" && command == "render"))
        return ending.substr(1);
    throw UsageError("the output \"" + options.output + "\" must end in .exr (all layers)" +
                     (command == "render" ? ", .png (the beauty, sRGB) or .svg (outlines)"
                                          : " or .png (the beauty, sRGB)"));
}

std::optional<CornerRays> chosen_rays(const RenderOptions& options) {
    if (options.rays.empty()) return std::nullopt;
    return options.rays == "fitted" ? CornerRays::kFitted : CornerRays::kInterpolated;
}

std::optional<GridKind> chosen_grid(const RenderOptions& options) {
    if (options.grid.empty()) return std::nullopt;
    return options.grid == "screen" ? GridKind::kScreen : GridKind::kSurface;
}

/// Outlines instead of pixels.
Answer run_vector(const RenderOptions& options, const Renderer& renderer, Console& console) {
    if (!options.scene.crop.empty())
        throw UsageError("--crop is for pictures of pixels; an .svg shows the whole film");
    const std::size_t camera = find_camera(renderer.scene(), options.scene.camera);
    FrameParams frame;
    frame.camera = camera;
    frame.rays = chosen_rays(options);
    frame.grid = chosen_grid(options);
    const LineDrawing drawing = renderer.draw_lines(frame, {options.wire, options.folds}, console.warner());
    Answer answer = write_output(options.output, drawing.svg, console);
    answer.fields.update(Json{{"engine", "exact"},
                              {"width", renderer.scene().film.width},
                              {"height", renderer.scene().film.height},
                              {"wire", options.wire},
                              {"folds", drawing.folds},
                              {"curves", drawing.curves},
                              {"arcs", drawing.arcs}});
    return answer;
}

void check_options(const RenderOptions& options, const std::string& format, const EngineChoice& engine) {
    if (format == "svg" && engine.engine == Engine::kClassic)
        throw UsageError("an .svg is drawn by the exact engine; leave out --engine classic");
    if (format == "svg" && options.max_error >= 0)
        throw UsageError("--max-error is for pictures of pixels; an .svg shows the facets undivided");
    if (options.wire && format != "svg") throw UsageError("--wire is for .svg outputs");
    if (options.folds && format != "svg")
        throw UsageError("--folds is for .svg outputs; layer magnification has folds in pixels");
}

Answer draw(const RenderOptions& options, const std::string& format, const PictureRequest& request,
            const Renderer& renderer, Console& console, const std::string& command) {
    // An OpenEXR file is encoded while it is drawn, unless the whole picture is asked something; other
    // formats have the beauty alone.
    const bool is_encoded = format != "png" && !console.wants_json();
    EncodedPicture encoded;
    if (!is_encoded)
        encoded.picture = renderer.draw(request, console.progress(command), console.warner());
    else
        encoded = renderer.draw_exr(request, console.progress(command), console.warner());
    const Picture& picture = encoded.picture;
    console.note(picture_note(picture));
    Answer answer = is_encoded
                        ? write_output(options.output, encoded.exr, console)
                        : write_output(options.output, picture.image,
                                       format == "png" ? ImageFormat::kPng : ImageFormat::kExr, console);
    answer.fields["engine"] = engine_name(request.engine.engine);
    if (request.engine.engine == Engine::kClassic)
        answer.fields["classic"] = classic_name(request.engine.classic);
    answer.fields.update(picture_fields(renderer, picture));
    if (console.wants_json()) answer.fields["regions"] = count_regions(picture.image);
    return answer;
}

/// Throws UsageError with the option's name for a window or a pixel that the film does not have.
void check_on_film(const RenderOptions& options, const LayerRequest& window, const Film& film) {
    const std::string size = fmt::format("the film of {} x {} pixels", film.width, film.height);
    const bool fits = window.x0 >= 0 && window.y0 >= 0 && window.x1 <= film.width &&
                      window.y1 <= film.height && window.x0 < window.x1 && window.y0 < window.y1;
    if (!options.scene.crop.empty() && !fits)
        throw UsageError("--crop " + options.scene.crop + " is no window of " + size);
    if (options.pixel.empty()) return;
    const std::vector<int> pixel = parse_integers(options.pixel, ',', 2, "--pixel");
    if (pixel[0] < 0 || pixel[1] < 0 || pixel[0] >= film.width || pixel[1] >= film.height)
        throw UsageError("--pixel " + options.pixel + " is not on " + size);
}

Answer run(const RenderOptions& options, const std::string& command, const EngineChoice& engine,
           Console& console) {
    if (options.pixel.empty() && options.output.empty())
        throw UsageError(command + " needs -o OUT.exr, or --pixel x,y");
    const std::string format = options.output.empty() ? "" : output_format(options, command);
    console.files().reads({options.scene.scene});
    check_output(options.output, console);
    if (is_standard_stream(options.output) && !options.pixel.empty())
        throw UsageError("--pixel explains on standard output, where -o - writes the image: give -o a name");
    check_options(options, format, engine);
    PictureRequest request;
    request.engine = engine;
    request.layers = layer_request(options.scene);
    const Renderer renderer = load_renderer(options.scene, console);
    request.frame.rays = chosen_rays(options);
    if (options.max_error >= 0) request.frame.max_error = options.max_error;
    request.frame.camera = find_camera(renderer.scene(), options.scene.camera);
    request.frame.grid = chosen_grid(options);
    check_on_film(options, request.layers, renderer.scene().film);
    if (options.pixel.empty())
        return format == "svg" ? run_vector(options, renderer, console)
                               : draw(options, format, request, renderer, console, command);

    const std::vector<int> pixel = parse_integers(options.pixel, ',', 2, "--pixel");
    Answer answer;
    answer.fields = explanation_json(renderer, engine, renderer.explain(request, pixel[0], pixel[1]));
    answer.text = answer.fields.dump(2);
    if (options.output.empty()) return answer;
    const Answer drawn = format == "svg" ? run_vector(options, renderer, console)
                                         : draw(options, format, request, renderer, console, command);
    answer.fields.update(drawn.fields);
    return answer;
}

std::vector<Option> picture_options(RenderOptions& options, const std::string& formats) {
    return joined({scene_argument(options.scene),
                   scene_overrides(options.scene),
                   window_options(options.scene),
                   {{.names = "-o,--output",
                     .target = &options.output,
                     .help = "file to write, by its ending: " + formats + "; - for standard output",
                     .value = "OUT",
                     .offer = Offer::kImage},
                    {.names = "--grid",
                     .target = &options.grid,
                     .help = "where the optics' facets lie: on the surface, or on the film over the optic",
                     .choices = {"surface", "screen"}},
                    {.names = "--pixel",
                     .target = &options.pixel,
                     .help = "explain one pixel as JSON",
                     .value = "x,y"}}});
}

std::vector<Option> facet_options(RenderOptions& options) {
    return {
        {.names = "--rays",
         .target = &options.rays,
         .help = "of every optic's facets, whatever the scene says: fitted to the exact rays in the mean, or "
                 "exact at the corners and interpolated between them",
         .choices = {"fitted", "interpolated"}},
        {.names = "--max-error",
         .target = &options.max_error,
         .help = "divide facets until they show things this many pixels from their place at most, as "
                 "predicted, and trace where that does not help; 0: leave them as they are",
         .value = "PX",
         .range = {0, 1000}}};
}

std::vector<Option> engine_options(RenderOptions& options) {
    return {
        {.names = "--engine",
         .target = &options.engine,
         .help = "exact; classic: by the outlines of projected triangles; auto (which is exact for now); for "
                 "comparison, envmap: an environment map at the optic's centre, planar: flat facets",
         .choices = {"exact", "classic", "auto", "envmap", "planar"}},
        {.names = "--slices",
         .target = &options.slices,
         .help = "classic: curved edges by K straight pieces between levels of t, not arcs",
         .value = "K",
         .range = {1, 1024}},
        {.names = "--tessellate",
         .target = &options.tessellate,
         .help = "classic: curved edges by K x K smaller triangles, not arcs",
         .value = "K",
         .range = {1, 1024},
         .excludes = "--slices"},
        {.names = "--clip",
         .target = &options.clip,
         .help = "classic: where outlines are cut at a facet's border: in the scene, on the screen, or not "
                 "(none)",
         .choices = {"scene", "screen", "none"}}};
}

EngineChoice chosen_engine(const RenderOptions& options) {
    if (options.engine != "classic") {
        if (options.slices > 0 || options.tessellate > 0 || options.clip != "scene")
            throw UsageError(
                "--slices, --tessellate and --clip are the classic engine's; add --engine classic");
        return options.engine == "envmap"   ? Engine::kEnvironment
               : options.engine == "planar" ? Engine::kPlanar
                                            : Engine::kExact;
    }
    ClassicParams params;
    params.clip = options.clip == "scene"    ? Clip::kScene
                  : options.clip == "screen" ? Clip::kScreen
                                             : Clip::kUnclipped;
    params.curves = options.slices > 0       ? Curves::kSlices
                    : options.tessellate > 0 ? Curves::kTessellate
                                             : Curves::kArcs;
    if (params.curves != Curves::kArcs) params.pieces = std::max(options.slices, options.tessellate);
    return params;
}

}  // namespace

std::vector<Command> render_commands() {
    auto render = std::make_shared<RenderOptions>(), trace = std::make_shared<RenderOptions>();
    Command by_projection{.name = "render", .summary = "draw the scene by projection", .schema = "render"};
    by_projection.options = joined(
        {picture_options(*render, ".exr (all layers), .png (beauty) or .svg (outlines)"),
         engine_options(*render),
         facet_options(*render),
         {{.names = "--format",
           .target = &render->format,
           .help = "what to write, whatever the output is called",
           .choices = {"exr", "png", "svg"}},
          {.names = "--wire", .target = &render->wire, .help = "svg: hidden edges too"},
          {.names = "--folds",
           .target = &render->folds,
           .help = "svg: also the curves where what an optic shows turns over (the eye's caustics)"}}});
    by_projection.body = [render](Console& console) {
        return run(*render, "render", chosen_engine(*render), console);
    };

    Command by_rays{
        .name = "trace", .summary = "draw the same scene by ray tracing: the truth", .schema = "trace"};
    by_rays.options = joined({picture_options(*trace, ".exr (all layers) or .png (beauty)"),
                              facet_options(*trace),
                              {{.names = "--format",
                                .target = &trace->format,
                                .help = "what to write, whatever the output is called",
                                .choices = {"exr", "png"}},
                               {.names = "--surface",
                                .target = &trace->surface,
                                .help = "facets: the rays of render's facets; limit: the exact surface",
                                .choices = {"facets", "limit"}}}});
    by_rays.body = [trace](Console& console) {
        if (trace->surface == "limit" && (!trace->rays.empty() || trace->max_error >= 0))
            throw UsageError("--rays and --max-error are about facets; add --surface facets");
        return run(*trace, "trace", trace->surface == "facets" ? Engine::kFacetsTruth : Engine::kLimitTruth,
                   console);
    };
    return {std::move(by_projection), std::move(by_rays)};
}

}  // namespace trilens
