// trilens render and trilens trace: one picture.
#include <trilens/files.h>
#include <trilens/image.h>
#include <trilens/render.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "cli/command.h"
#include "cli/explain.h"
#include "cli/scene_options.h"

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
};

/// What an output is, by --format or its name's ending: "exr", "png" or "svg".
std::string output_format(const RenderOptions& options, const std::string& command) {
    if (!options.format.empty()) return options.format;
    const std::string ending = std::filesystem::path(options.output).extension().string();
    if (ending == ".exr" || ending == ".png" || (ending == ".svg" && command == "render"))
        return ending.substr(1);
    throw UsageError("the output \"" + options.output + "\" must end in .exr (all layers)" +
                     (command == "render" ? ", .png (the beauty, sRGB) or .svg (outlines)"
                                          : " or .png (the beauty, sRGB)"));
}

Json picture_fields(const Renderer& renderer, const Picture& picture) {
    return {{"width", picture.image.width},
            {"height", picture.image.height},
            {"triangles", renderer.triangle_count()},
            {"facets", renderer.facet_count()},
            {"optic_pixels", picture.statistics.optic_pixels},
            {"pixels_without_ray", picture.statistics.pixels_without_ray},
            {"prepare_seconds", picture.prepare_seconds},
            {"draw_seconds", picture.draw_seconds}};
}

/// Outlines instead of pixels.
Answer run_vector(const RenderOptions& options, const Renderer& renderer, Console& console) {
    if (!options.scene.crop.empty())
        throw UsageError("--crop is for pictures of pixels; an .svg shows the whole film");
    const std::size_t camera = find_camera(renderer.scene(), options.scene.camera);
    const LineDrawing drawing = renderer.draw_lines({camera, 0}, options.wire, console.warner());
    replace_text_file(options.output, drawing.svg);
    Answer answer;
    answer.text = options.output;
    answer.fields = {{"output", options.output},
                     {"engine", "exact"},
                     {"width", renderer.scene().film.width},
                     {"height", renderer.scene().film.height},
                     {"wire", options.wire},
                     {"curves", drawing.curves},
                     {"arcs", drawing.arcs}};
    return answer;
}

void check_options(const RenderOptions& options, const std::string& format, const EngineChoice& engine) {
    if (format == "svg" && engine.engine == Engine::kClassic)
        throw UsageError("an .svg is drawn by the exact engine; leave out --engine classic");
    if (options.wire && format != "svg") throw UsageError("--wire is for .svg outputs");
}

Answer run(const RenderOptions& options, const std::string& command, const EngineChoice& engine,
           Console& console) {
    if (options.pixel.empty() && options.output.empty())
        throw UsageError(command + " needs -o OUT.exr, or --pixel x,y");
    const std::string format = options.output.empty() ? "" : output_format(options, command);
    if (!options.output.empty()) check_writable(options.output, {options.scene.scene});
    check_options(options, format, engine);
    PictureRequest request;
    request.engine = engine;
    request.layers = layer_request(options.scene);
    const Renderer renderer = load_renderer(options.scene, console);
    request.frame.camera = find_camera(renderer.scene(), options.scene.camera);
    Answer answer;
    if (!options.pixel.empty()) {
        const std::vector<int> pixel = parse_integers(options.pixel, ',', 2, "--pixel");
        answer.fields = explanation_json(renderer, engine, renderer.explain(request, pixel[0], pixel[1]));
        answer.text = answer.fields.dump(2);
        if (options.output.empty()) return answer;
    }
    if (format == "svg") return run_vector(options, renderer, console);
    const Picture picture = renderer.draw(request, console.progress(command), console.warner());
    write_image_as(options.output, picture.image, format == "png" ? ImageFormat::kPng : ImageFormat::kExr);
    answer.fields["output"] = options.output;
    answer.fields["engine"] = engine_name(engine.engine);
    if (engine.engine == Engine::kClassic) answer.fields["classic"] = classic_name(engine.classic);
    answer.fields.update(picture_fields(renderer, picture));
    if (answer.text.empty()) answer.text = options.output;
    return answer;
}

void add_render_options(CLI::App& command, RenderOptions& options) {
    add_scene_options(command, options.scene);
    add_window_options(command, options.scene);
    command
        .add_option("-o,--output", options.output,
                    "image to write: .exr (all layers) or .png (beauty); render: or .svg (outlines)")
        ->type_name("OUT");
    command.add_option("--pixel", options.pixel, "explain one pixel as JSON")->type_name("x,y");
}

void add_engine_options(CLI::App& command, RenderOptions& options) {
    command
        .add_option("--engine", options.engine,
                    "exact; classic: by the outlines of projected triangles; auto (which is exact for now)")
        ->check(CLI::IsMember({"exact", "classic", "auto"}));
    CLI::Option* slices =
        command
            .add_option("--slices", options.slices,
                        "classic: curved edges by K straight pieces between levels of t, not arcs")
            ->check(CLI::Range(1, 1024))
            ->type_name("K");
    command
        .add_option("--tessellate", options.tessellate,
                    "classic: curved edges by K x K smaller triangles, not arcs")
        ->check(CLI::Range(1, 1024))
        ->type_name("K")
        ->excludes(slices);
    command
        .add_option(
            "--clip", options.clip,
            "classic: where outlines are cut at a facet's border: in the scene, on the screen, or not (none)")
        ->check(CLI::IsMember({"scene", "screen", "none"}));
}

EngineChoice chosen_engine(const RenderOptions& options) {
    if (options.engine != "classic") {
        if (options.slices > 0 || options.tessellate > 0 || options.clip != "scene")
            throw UsageError(
                "--slices, --tessellate and --clip are the classic engine's; add --engine classic");
        return Engine::kExact;
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

void register_render(const CommandRegistry& registry) {
    auto render = std::make_shared<RenderOptions>();
    CLI::App* command = registry.app->add_subcommand("render", "draw the scene by projection");
    add_render_options(*command, *render);
    add_engine_options(*command, *render);
    command->add_option("--format", render->format, "exr, png or svg; default: by the output's ending")
        ->check(CLI::IsMember({"exr", "png", "svg"}));
    command->add_flag("--wire", render->wire, "svg: hidden edges too");
    registry.add(command, "render", [render](Console& console) {
        return run(*render, "render", chosen_engine(*render), console);
    });

    auto trace = std::make_shared<RenderOptions>();
    command = registry.app->add_subcommand("trace", "draw the same scene by ray tracing: the truth");
    add_render_options(*command, *trace);
    command->add_option("--format", trace->format, "exr or png; default: by the output's ending")
        ->check(CLI::IsMember({"exr", "png"}));
    command
        ->add_option("--surface", trace->surface,
                     "facets: the rays of render's facets; limit: the exact surface")
        ->check(CLI::IsMember({"facets", "limit"}));
    registry.add(command, "trace", [trace](Console& console) {
        return run(*trace, "trace", trace->surface == "facets" ? Engine::kFacetsTruth : Engine::kLimitTruth,
                   console);
    });
}

}  // namespace trilens
