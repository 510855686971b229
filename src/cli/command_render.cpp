// trilens render and trilens trace: one picture.
#include <trilens/animation.h>
#include <trilens/files.h>
#include <trilens/image.h>
#include <trilens/regions.h>
#include <trilens/render.h>
#include <trilens/stopwatch.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>

#include "cli/commands.h"
#include "cli/explain.h"
#include "cli/frames.h"
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
    bool wire = false;
    std::string rays;       // empty: each optic's own
    double max_error = -1;  // < 0: as the scene says
    std::string grid;       // empty: as the scene says
    double exposure = 0;    // stops
    std::string tone = "none";
    FrameOptions frames;
    double white = ToneMapping().white;

    ToneMapping tone_mapping() const { return {exposure, tone_curve(tone), white}; }
    bool maps_tones() const { return exposure != 0 || tone != "none" || white != ToneMapping().white; }
};

/// What an output is, by --format or its name's ending: "exr", "png" or "svg". Standard output gets OpenEXR
/// where nothing else is asked for.
std::string output_format(const RenderOptions& options, const std::string& command) {
    if (!options.format.empty()) return options.format;
    if (is_standard_stream(options.output)) return "exr";
    const std::string ending = std::filesystem::path(options.output).extension().string();
    if (options.frames.asks() && ending == ".apng") return "apng";
    if (ending == ".exr" || ending == ".png" || (ending == ".svg" && command == "render"))
        return ending.substr(1);
    throw UsageError("the output \"" + options.output + "\" must end in .exr (all layers)" +
                     (command == "render" ? ", .png (the beauty, sRGB) or .svg (outlines)"
                                          : " or .png (the beauty, sRGB)"));
}

Json picture_fields(const Renderer& renderer, const Picture& picture) {
    return {
        {"width", picture.image.width},
        {"height", picture.image.height},
        {"triangles", renderer.triangle_count()},
        {"facets", renderer.facet_count()},
        {"optic_pixels", picture.statistics.optic_pixels},
        {"pixels_without_ray", picture.statistics.pixels_without_ray},
        {"subdivided_pixels", picture.statistics.subdivided_pixels},
        {"traced_pixels", picture.statistics.traced_pixels},
        {"projected_facets", picture.statistics.projected_facets},
        {"predicted_error", picture.statistics.predicted_error},
        {"left_out", {{"faint", picture.statistics.faint_light}, {"deep", picture.statistics.deep_light}}},
        {"prepare_seconds", picture.prepare_seconds},
        {"draw_seconds", picture.draw_seconds}};
}

std::optional<CornerRays> chosen_rays(const RenderOptions& options) {
    if (options.rays.empty()) return std::nullopt;
    return options.rays == "fitted" ? CornerRays::kFitted : CornerRays::kInterpolated;
}

/// Outlines instead of pixels.
Answer run_vector(const RenderOptions& options, const Renderer& renderer, Console& console) {
    if (!options.scene.crop.empty())
        throw UsageError("--crop is for pictures of pixels; an .svg shows the whole film");
    const std::size_t camera = find_camera(renderer.scene(), options.scene.camera);
    FrameParams frame;
    frame.camera = camera;
    frame.rays = chosen_rays(options);
    const LineDrawing drawing = renderer.draw_lines(frame, options.wire, console.warner());
    Answer answer = write_output(options.output, drawing.svg, console);
    answer.fields.update(Json{{"engine", "exact"},
                              {"width", renderer.scene().film.width},
                              {"height", renderer.scene().film.height},
                              {"wire", options.wire},
                              {"curves", drawing.curves},
                              {"arcs", drawing.arcs}});
    return answer;
}

void check_options(const RenderOptions& options, const std::string& format, const EngineChoice& engine) {
    if (format == "svg" && engine.engine == Engine::kClassic)
        throw UsageError("an .svg is drawn by the exact engine; leave out --engine classic");
    if (format == "svg" && options.max_error >= 0)
        throw UsageError("--max-error is for pictures of pixels; an .svg shows the facets undivided");
    if (options.frames.asks() && (format == "svg" || !options.pixel.empty()))
        throw UsageError("--frames and --turntable are for .exr, .png and .apng outputs");
    if (options.maps_tones() && format != "png" && format != "apng")
        throw UsageError(
            "--exposure, --tone and --white are for .png outputs; an .exr holds the light of the scene");
    if (options.white != ToneMapping().white && options.tone != "reinhard")
        throw UsageError("--white is for --tone reinhard");
    if (options.wire && format != "svg") throw UsageError("--wire is for .svg outputs");
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
    console.note(fmt::format(
        "drew {} x {} pixels, {} of them of optics ({} subdivided, {} traced): prepared in {:.3f} s, "
        "drawn in {:.3f} s",
        picture.image.width, picture.image.height, picture.statistics.optic_pixels,
        picture.statistics.subdivided_pixels, picture.statistics.traced_pixels, picture.prepare_seconds,
        picture.draw_seconds));
    Answer answer =
        is_encoded
            ? write_output(options.output, encoded.exr, console)
            : write_output(options.output, picture.image,
                           {format == "png" ? ImageFormat::kPng : ImageFormat::kExr, options.tone_mapping()},
                           console);
    answer.fields["engine"] = engine_name(request.engine.engine);
    if (request.engine.engine == Engine::kClassic)
        answer.fields["classic"] = classic_name(request.engine.classic);
    answer.fields.update(picture_fields(renderer, picture));
    if (console.wants_json()) answer.fields["regions"] = count_regions(picture.image);
    return answer;
}

/// One frame after the other, each in a file of its own, or all in one animated picture.
class FrameSequence {
  public:
    FrameSequence(const RenderOptions& options, const std::string& format, const PictureRequest& request,
                  Console& console)
        : options_(options), format_(format), request_(request), console_(console) {}

    Answer draw() {
        const std::vector<int> frames = frame_numbers(options_.frames);
        const Scene scene = load_scene(options_.scene, console_);
        const std::optional<AnimationInfo> animation = find_animation(scene);
        request_.frame.camera = find_camera(scene, options_.scene.camera);
        if (!animation && options_.frames.turntable == 0)
            throw UsageError("--frames: the scene has no animation; add --turntable K, or an \"animation\"");
        std::vector<std::string> outputs;
        for (const int frame : frames) {
            outputs.push_back(is_apng() ? options_.output : frame_file(options_.output, frame));
            if (!is_apng() || outputs.size() == 1) check_output(outputs.back(), console_);
        }
        Answer answer;
        answer.is_report = true;
        answer.fields = Json{{"engine", engine_name(request_.engine.engine)}, {"frames", Json::array()}};
        for (std::size_t k = 0; k < frames.size(); ++k)
            answer.fields["frames"].push_back(draw_frame(scene, frames[k], outputs[k]));
        if (is_apng()) write_apng(animation ? animation->fps : AnimationInfo().fps);
        answer.text =
            is_apng() || frames.size() == 1 ? outputs.back() : outputs.front() + " .. " + outputs.back();
        return answer;
    }

  private:
    bool is_apng() const { return format_ == "apng"; }

    Scene scene_of(const Scene& scene, int frame) const {
        const int turn = options_.frames.turntable;
        return scene_at_frame(
            scene, frame,
            turn > 0 ? turntable(scene, request_.frame.camera, frame, turn) : std::vector<SceneOverride>());
    }

    Json draw_frame(const Scene& scene, int frame, const std::string& output) {
        const Stopwatch watch;
        KeptParts kept;
        if (renderer_)
            kept = renderer_->change(scene_of(scene, frame), once());
        else
            renderer_.emplace(scene_of(scene, frame), once());
        const double scene_seconds = watch.seconds();
        const std::string job = fmt::format("frame {}", frame);
        const bool is_picture = format_ != "exr";
        EncodedPicture drawn;
        if (is_picture)
            drawn.picture = renderer_->draw(request_, console_.progress(job), once());
        else
            drawn = renderer_->draw_exr(request_, console_.progress(job), once());
        if (is_picture)
            drawn.exr = encode_image_as(drawn.picture.image, ImageFormat::kPng, options_.tone_mapping());
        if (is_apng())
            pngs_.push_back(std::move(drawn.exr));
        else
            write_output(output, drawn.exr, console_);
        const Picture& picture = drawn.picture;
        console_.note(
            fmt::format("{}: scene {:.3f} s ({} and {} optics kept), prepared in {:.3f} s, drawn in {:.3f} s",
                        job, scene_seconds, kept.objects ? "objects" : "no objects", kept.optics,
                        picture.prepare_seconds, picture.draw_seconds));
        return {{"frame", frame},
                {"output", output},
                {"kept_objects", kept.objects},
                {"kept_optics", kept.optics},
                {"scene_seconds", scene_seconds},
                {"prepare_seconds", picture.prepare_seconds},
                {"draw_seconds", picture.draw_seconds},
                {"seconds", watch.seconds()}};
    }

    void write_apng(double fps) const { write_output(options_.output, encode_apng(pngs_, fps), console_); }

    /// What every frame would say is said once.
    Warn once() {
        return [this](const std::string& warning) {
            if (told_.insert(warning).second) console_.warner()(warning);
        };
    }

    const RenderOptions& options_;
    std::string format_;
    PictureRequest request_;
    Console& console_;
    std::optional<Renderer> renderer_;
    std::vector<std::vector<unsigned char>> pngs_;
    std::set<std::string> told_;
};

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
    if (!options.frames.asks()) check_output(options.output, console);
    if (is_standard_stream(options.output) && options.frames.asks() && format != "apng")
        throw UsageError("frames go into files of their own: give -o a name, f.####.exr");
    if (is_standard_stream(options.output) && !options.pixel.empty())
        throw UsageError("--pixel explains on standard output, where -o - writes the image: give -o a name");
    check_options(options, format, engine);
    PictureRequest request;
    request.engine = engine;
    request.layers = layer_request(options.scene);
    request.frame.rays = chosen_rays(options);
    if (options.max_error >= 0) request.frame.max_error = options.max_error;
    if (!options.grid.empty())
        request.frame.grid = options.grid == "screen" ? GridKind::kScreen : GridKind::kSurface;
    if (options.frames.asks()) return FrameSequence(options, format, request, console).draw();
    const Renderer renderer = load_renderer(options.scene, console);
    request.frame.camera = find_camera(renderer.scene(), options.scene.camera);
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
        {picture_options(*render, ".exr (all layers), .png (beauty), .svg (outlines) or, of frames, .apng"),
         frame_options(render->frames),
         engine_options(*render),
         facet_options(*render),
         {{.names = "--format",
           .target = &render->format,
           .help = "what to write, whatever the output is called",
           .choices = {"exr", "png", "svg"}},
          {.names = "--wire", .target = &render->wire, .help = "svg: hidden edges too"}}});
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
