#include "cli/options.h"

#include <trilens/animation.h>
#include <algorithm>

#include "terminal/libraries.h"

namespace trilens {

namespace {

std::vector<std::string> projecting_engines() {
    std::vector<std::string> names = names_of<Engine>();
    std::erase_if(names, [](const std::string& name) { return !projects(*find_named<Engine>(name)); });
    return names;
}

}  // namespace

std::vector<Option> picture_options(RenderOptions& options, const std::string& formats) {
    return joined(
        {scene_argument(options.scene),
         scene_overrides(options.scene),
         window_options(options.scene),
         {{.names = "-o,--output",
           .target = &options.output,
           .help = "file to write, by its ending: " + formats + "; - for standard output",
           .value = "OUT",
           .offer = Offer::kImage},
          {.names = "--exposure",
           .target = &options.exposure,
           .help = "png: stops by which the light is made brighter first",
           .value = "EV",
           .range = {-100, 100}},
          {.names = "--tone",
           .target = &options.tone,
           .help = "png: how bright light is brought into the screen's range: not (none), Reinhard's "
                   "extended curve of 2002, Narkowicz's fit to ACES, or Khronos' PBR Neutral",
           .choices = {"none", "reinhard", "aces", "neutral"}},
          {.names = "--white",
           .target = &options.white,
           .help = "png: the least luminance that --tone reinhard shows as white",
           .value = "L",
           .range = {1e-6, 1e6}},
          {.names = "--filter-shown",
           .target = &options.filter_shown,
           .help = "png: average a pixel's samples as the screen shows them, after exposure and tone, not "
                   "their light: bright highlights neither stay jagged nor leave dark rings"},
          {.names = "--grid",
           .target = &options.grid,
           .help = "where the optics' facets lie: on the surface, or on the film over the optic",
           .choices = names_of<GridKind>()},
          {.names = "--display-server",
           .target = &options.display_server,
           .help = "show the picture in the viewer tev while it is drawn (tev listens at 127.0.0.1:14158)",
           .value = "HOST:PORT"},
          {.names = "--pixel",
           .target = &options.pixel,
           .help = "explain one pixel as JSON",
           .value = "x,y"}}});
}

std::vector<Option> frame_options(FrameOptions& options) {
    return {
        {.names = "--frames",
         .target = &options.frames,
         .help =
             "draw these frames of the scene's animation, each into a file of its own (-o f.####.exr), or "
             "all into one .apng",
         .value = "A..B"},
        {.names = "--turntable",
         .target = &options.turntable,
         .help = "turn the camera once around what it looks at, in K frames; --frames chooses some of them",
         .value = "K",
         .range = {1, kMostFrames}}};
}

std::vector<Option> facet_options(RenderOptions& options) {
    return {
        {.names = "--rays",
         .target = &options.rays,
         .help = "of every optic's facets, whatever the scene says: fitted to the exact rays in the mean, or "
                 "exact at the corners and interpolated between them",
         .choices = names_of<CornerRays>()},
        {.names = "--facets",
         .target = &options.facets,
         .help = "worthwhile: facets that it takes longer to probe than to follow the rays of their samples "
                 "are traced, by a count of samples; all: none is for that",
         .choices = names_of<FacetUse>()},
        {.names = "--max-error",
         .target = &options.max_error,
         .help = "divide facets until they show things this many pixels from their place at most, as "
                 "predicted, and trace where that does not help; 0: only those that are off by more than "
                 "(32 / n)^2 pixels of a film 480 high, and by one",
         .value = "PX",
         .range = {0, 1000}},
        {.names = "--certify",
         .target = &options.certify,
         .help =
             "prove at each pixel's middle that what optics show is off by no more than --max-error (layer "
             "bound), and trace what is not proven"}};
}

std::vector<Option> engine_options(RenderOptions& options) {
    return {
        {.names = "--shading",
         .target = &options.shading,
         .help = "where pixels have several samples: shade those that see one triangle by one way once, or "
                 "each by itself",
         .choices = names_of<Shading>()},
        {.names = "--engine",
         .target = &options.engine,
         .help = "exact; classic: by the outlines of projected triangles; for comparison, envmap: an "
                 "environment map at the optic's centre, planar: flat facets",
         .choices = projecting_engines()},
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
         .choices = names_of<Clip>()}};
}

std::string output_format(const RenderOptions& options, const std::string& command) {
    if (!options.format.empty()) return options.format;
    if (is_standard_stream(options.output)) return "exr";
    const std::string ending = file_ending(options.output);
    if (options.frames.asks() && ending == ".apng") return "apng";
    if (ending == ".exr" || ending == ".png" ||
        (command == "render" && (ending == ".svg" || ending == ".obj")))
        return ending.substr(1);
    throw UsageError("the output \"" + options.output + "\" must end in .exr (all layers)" +
                     (command == "render" ? ", .png (the beauty, sRGB), .svg (outlines) or .obj (caustics)"
                                          : " or .png (the beauty, sRGB)"));
}

EngineChoice chosen_engine(const RenderOptions& options) {
    if (options.engine != "classic") {
        if (options.slices > 0 || options.tessellate > 0 || options.clip != "scene")
            throw UsageError(
                "--slices, --tessellate and --clip are the classic engine's; add --engine classic");
        return find_named<Engine>(options.engine).value();
    }
    ClassicParams params;
    params.clip = find_named<Clip>(options.clip).value();
    params.curves = options.slices > 0       ? Curves::kSlices
                    : options.tessellate > 0 ? Curves::kTessellate
                                             : Curves::kArcs;
    if (params.curves != Curves::kArcs) params.pieces = std::max(options.slices, options.tessellate);
    return params;
}

PictureRequest picture_request(const RenderOptions& options, const EngineChoice& engine) {
    PictureRequest request;
    request.engine = engine;
    request.layers = layer_request(options.scene);
    request.layers.shading = find_named<Shading>(options.shading).value();
    if (options.filter_shown) {
        const ToneMapping mapping = options.tone_mapping();
        check_tone_mapping(mapping);
        request.layers.shown = [mapping](const Vec3& light) {
            return glm::clamp(tone_mapped(light, mapping), 0.0, 1.0);
        };
    }
    request.frame.rays = find_named<CornerRays>(options.rays);
    request.frame.grid = find_named<GridKind>(options.grid);
    request.frame.facets = find_named<FacetUse>(options.facets).value_or(FacetUse::kWorthwhile);
    if (options.max_error >= 0) request.frame.max_error = options.max_error;
    request.frame.certify = options.certify;
    return request;
}

void check_options(const RenderOptions& options, const std::string& format, const EngineChoice& engine) {
    if (is_vector(format) && engine.engine == Engine::kClassic)
        throw UsageError("an ." + format + " is drawn by the exact engine; leave out --engine classic");
    if (is_vector(format) && (options.max_error >= 0 || options.certify))
        throw UsageError("--max-error and --certify are for pictures of pixels; an ." + format +
                         " shows the facets undivided");
    if (!options.display_server.empty() && (is_vector(format) || format.empty()))
        throw UsageError("--display-server shows pictures of pixels: it needs -o OUT.exr or OUT.png");
    if (!options.scene.aov.empty() && !format.empty() && format != "exr")
        throw UsageError("--aov is for .exr outputs: ." + format + " has no layers");
    if (options.frames.asks() && (is_vector(format) || !options.pixel.empty()))
        throw UsageError("--frames and --turntable are for .exr, .png and .apng outputs");
    if (options.frames.asks() && !options.scene.time.empty())
        throw UsageError(
            "--time is of one picture: frames are times themselves, whole ones of the scene's animation");
    if (options.maps_tones() && format != "png" && format != "apng")
        throw UsageError(
            "--exposure, --tone and --white are for .png outputs; an .exr holds the light of the scene");
    if (options.filter_shown && format != "png" && format != "apng")
        throw UsageError("--filter-shown is for .png outputs; an .exr holds the light of the scene");
    if (options.white != ToneMapping().white && options.tone != "reinhard")
        throw UsageError("--white is for --tone reinhard");
    if (options.wire && format != "svg") throw UsageError("--wire is for .svg outputs");
    if (options.folds && format != "svg")
        throw UsageError("--folds is for .svg outputs; layer magnification has folds in pixels");
}

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

}  // namespace trilens
