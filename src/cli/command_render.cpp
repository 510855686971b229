// trilens render and trilens trace: one picture, or the frames of an animation.
#include <trilens/animation.h>
#include <trilens/compare.h>
#include <trilens/display.h>
#include <trilens/utilities.h>

#include <optional>
#include <set>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print/print.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

/// One frame after the other, each in a file of its own, or all in one animated picture.
class FrameSequence {
  public:
    FrameSequence(const RenderOptions& options, const std::string& format, const PictureRequest& request,
                  Console& console)
        : options_(options), format_(format), request_(request), console_(console) {}

    Answer draw() {
        const std::vector<int> frames = parse_frames(
            options_.frames.frames.empty() ? "0.." + std::to_string(options_.frames.turntable - 1)
                                           : options_.frames.frames);
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
        return turn > 0 ? scene_on_turntable(scene, frame, request_.frame.camera, turn)
                        : scene_at_frame(scene, frame);
    }

    Picture write_frame(const std::string& output, const std::string& job) {
        const Progress progress = console_.progress(job);
        if (format_ == "exr") {
            Picture picture = renderer_->write_exr(output, request_, progress, once());
            name_output(output, console_);
            return picture;
        }
        EncodedPicture encoded = renderer_->draw_png(request_, options_.written_tones(), progress, once());
        if (is_apng())
            pngs_.push_back(std::move(encoded.bytes));
        else
            write_output(output, encoded.bytes, console_);
        return std::move(encoded.picture);
    }

    Json draw_frame(const Scene& scene, int frame, const std::string& output) {
        const Stopwatch watch;
        SceneReuse kept;
        if (renderer_)
            kept = renderer_->change(scene_of(scene, frame), once());
        else
            renderer_.emplace(scene_of(scene, frame), once());
        const double scene_seconds = watch.seconds();
        const std::string job = fmt::format("frame {}", frame);
        const Picture picture = write_frame(output, job);
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

/// Outlines, or caustics, instead of pixels.
Answer run_vector(const RenderOptions& options, const std::string& format, const Renderer& renderer,
                  Console& console) {
    if (!options.scene.crop.empty())
        throw UsageError("--crop is for pictures of pixels; an ." + format + " shows the whole film");
    const std::size_t camera = find_camera(renderer.scene(), options.scene.camera);
    FrameParams frame = picture_request(options, {}).frame;
    frame.camera = camera;
    const bool is_obj = format == "obj";
    warn_of_roughness(renderer.scene(), console);
    const LineDrawing drawing =
        renderer.draw_lines(frame, {options.wire, options.folds || is_obj, is_obj, false}, console.warner());
    Answer answer = write_output(options.output, is_obj ? drawing.obj : drawing.svg, console);
    answer.fields.update(
        drawing_fields(renderer.scene().film, {options.wire, options.folds, is_obj}, drawing));
    return answer;
}

Answer draw(const RenderOptions& options, const std::string& format, const PictureRequest& request,
            const Renderer& renderer, Console& console, const std::string& command) {
    // A picture is encoded, and a file of OpenEXR written, while it is drawn, unless the whole picture is
    // asked something; a PNG has the beauty alone.
    const bool is_png = format == "png", held = console.wants_json();
    const Progress progress = console.progress(command);
    Picture picture;
    Answer answer;
    const auto take = [&](Picture drawn) {
        picture = std::move(drawn);
        console.note(picture_note(picture));
    };
    if (held) {
        take(renderer.draw(request, progress, console.warner()));
        answer =
            write_output(options.output, picture.image,
                         {is_png ? ImageFormat::kPng : ImageFormat::kExr, options.written_tones()}, console);
    } else if (is_png || is_standard_stream(options.output)) {
        EncodedPicture encoded =
            is_png ? renderer.draw_png(request, options.written_tones(), progress, console.warner())
                   : renderer.draw_exr(request, progress, console.warner());
        take(std::move(encoded.picture));
        answer = write_output(options.output, encoded.bytes, console);
    } else {
        take(renderer.write_exr(options.output, request, progress, console.warner()));
        answer = name_output(options.output, console);
    }
    answer.fields["engine"] = engine_name(request.engine.engine);
    if (request.engine.engine == Engine::kClassic)
        answer.fields["classic"] = classic_name(request.engine.classic);
    answer.fields.update(picture_fields(renderer, picture));
    if (console.wants_json()) answer.fields["regions"] = count_regions(picture.image);
    return answer;
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
    PictureRequest request = picture_request(options, engine);
    // A .png shows the beauty alone; the count of regions in a JSON answer needs the ids.
    const bool is_beauty = format == "png" || format == "apng";
    if (is_beauty && request.layers.layers.empty() && !console.wants_json()) request.layers.layers = {"Z"};
    std::optional<DisplayServer> display;
    StripSink shown;
    if (!options.display_server.empty()) {
        display.emplace(options.display_server, console.warner());
        shown = display->sink(is_standard_stream(options.output) ? command : options.output);
        request.watch = &shown;
    }
    if (options.frames.asks()) return FrameSequence(options, format, request, console).draw();
    const Renderer renderer = load_renderer(options.scene, console);
    request.frame.camera = find_camera(renderer.scene(), options.scene.camera);
    check_on_film(options, request.layers, renderer.scene().film);
    if (options.pixel.empty())
        return is_vector(format) ? run_vector(options, format, renderer, console)
                                 : draw(options, format, request, renderer, console, command);

    const std::vector<int> pixel = parse_integers(options.pixel, ',', 2, "--pixel");
    Answer answer;
    answer.fields = explanation_json(renderer, engine, renderer.explain(request, pixel[0], pixel[1]));
    answer.text = answer.fields.dump(2);
    if (options.output.empty()) return answer;
    const Answer drawn = is_vector(format) ? run_vector(options, format, renderer, console)
                                           : draw(options, format, request, renderer, console, command);
    answer.fields.update(drawn.fields);
    return answer;
}

}  // namespace

std::vector<Command> render_commands() {
    auto render = std::make_shared<RenderOptions>(), trace = std::make_shared<RenderOptions>();
    Command by_projection{.name = "render", .summary = "draw the scene by projection", .schema = "render"};
    by_projection.options = joined(
        {picture_options(*render,
                         ".exr (all layers), .png (beauty), .svg (outlines), .obj (caustics) or, of frames, "
                         ".apng"),
         frame_options(render->frames),
         engine_options(*render),
         facet_options(*render),
         {{.names = "--format",
           .target = &render->format,
           .help = "what to write, whatever the output is called",
           .choices = {"exr", "png", "svg", "obj"}},
          {.names = "--wire", .target = &render->wire, .help = "svg: hidden edges too"},
          {.names = "--folds",
           .target = &render->folds,
           .help = "svg: also the curves where what an optic shows turns over (the eye's caustics); an .obj "
                   "has them and the caustics' surfaces, in the world"}}});
    by_projection.body = [render](Console& console) {
        return run(*render, "render", chosen_engine(*render), console);
    };

    Command by_rays{
        .name = "trace", .summary = "draw the same scene by ray tracing: the truth", .schema = "trace"};
    by_rays.options =
        joined({picture_options(*trace, ".exr (all layers), .png (beauty) or, of frames, .apng"),
                frame_options(trace->frames),
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
        if (trace->surface == "limit" &&
            (trace->rays + trace->grid + trace->facets != "" || trace->max_error >= 0 || trace->certify))
            throw UsageError(
                "--rays, --grid, --facets, --max-error and --certify are about facets; add --surface facets");
        if (trace->surface == "limit" && !trace->scene.resolution.empty())
            console.warn(
                "-n is about facets, and exact surfaces have none: it changes nothing without "
                "--surface facets");
        return run(*trace, "trace", trace->surface == "facets" ? Engine::kFacetsTruth : Engine::kLimitTruth,
                   console);
    };
    return {std::move(by_projection), std::move(by_rays)};
}

}  // namespace trilens
