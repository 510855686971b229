// trilens render and trilens trace: one picture.
#include <CLI/CLI.hpp>
#include <algorithm>

#include "cli/check_output.h"
#include "cli/command.h"
#include "cli/explain.h"
#include "cli/picture.h"
#include "cli/scene_options.h"
#include "cli/vector_drawing.h"
#include "image/image_io.h"
#include "sweep/files.h"

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

enum class OutputKind { kExr, kPng, kSvg };

OutputKind output_kind(const RenderOptions& options, const std::string& command) {
    const std::string& file = options.output;
    if (options.format == "exr") return OutputKind::kExr;
    if (options.format == "png") return OutputKind::kPng;
    if (options.format == "svg") return OutputKind::kSvg;
    const auto ends_with = [&](const std::string& end) {
        return file.size() > end.size() && file.compare(file.size() - end.size(), end.size(), end) == 0;
    };
    if (ends_with(".exr")) return OutputKind::kExr;
    if (ends_with(".png")) return OutputKind::kPng;
    if (ends_with(".svg") && command == "render") return OutputKind::kSvg;
    throw UsageError("the output \"" + file + "\" must end in .exr (all layers)" +
                     (command == "render" ? ", .png (the beauty, sRGB) or .svg (outlines)"
                                          : " or .png (the beauty, sRGB)"));
}

void write_picture(const std::string& file, const Image& image, OutputKind kind) {
    if (kind == OutputKind::kExr) return write_exr(file, image);
    const std::vector<float>*r = &image.find("R")->floats(), *g = &image.find("G")->floats(),
          *b = &image.find("B")->floats();
    std::vector<float> rgb(3 * image.pixels());
    for (std::size_t p = 0; p < image.pixels(); ++p) {
        rgb[3 * p] = (*r)[p];
        rgb[3 * p + 1] = (*g)[p];
        rgb[3 * p + 2] = (*b)[p];
    }
    write_png(file, image.data_width, image.data_height, rgb);
}

Json picture_fields(const World& world, const Picture& picture) {
    Json fields;
    fields["width"] = picture.image.width;
    fields["height"] = picture.image.height;
    fields["triangles"] = world.objects.size();
    std::size_t facets = 0;
    for (const Optic& optic : world.optics) facets += optic.facet_count();
    fields["facets"] = facets;
    fields["optic_pixels"] = picture.statistics.optic_pixels;
    fields["pixels_without_ray"] = picture.statistics.pixels_without_ray;
    fields["prepare_seconds"] = picture.prepare_seconds;
    fields["draw_seconds"] = picture.draw_seconds;
    return fields;
}

/// Outlines instead of pixels.
Answer run_vector(const RenderOptions& options, const World& world, Console& console) {
    if (!options.scene.crop.empty())
        throw UsageError("--crop is for pictures of pixels; an .svg shows the whole film");
    const std::size_t camera = chosen_camera(options.scene, world.scene);
    const std::unique_ptr<Drawing> drawing = make_drawing(world, camera, options.wire, console.warner());
    replace_text_file(options.output, drawing_svg(*drawing, world));
    Answer answer;
    std::size_t curves = 0, arcs = 0;
    for (const auto& layer : drawing->layers) {
        curves += layer->curves.size();
        for (const EdgeCurve& curve : layer->curves) arcs += curve.arcs.size();
    }
    answer.text = options.output;
    answer.fields = {{"output", options.output},
                     {"engine", "exact"},
                     {"width", drawing->width},
                     {"height", drawing->height},
                     {"wire", options.wire},
                     {"curves", curves},
                     {"arcs", arcs}};
    return answer;
}

Answer run(const RenderOptions& options, const std::string& command, const EngineChoice& engine,
           Console& console) {
    if (options.pixel.empty() && options.output.empty())
        throw UsageError(command + " needs -o OUT.exr, or --pixel x,y");
    OutputKind kind = OutputKind::kExr;
    if (!options.output.empty()) {
        kind = output_kind(options, command);
        check_writable(options.output, {options.scene.scene});
    }
    if (kind == OutputKind::kSvg && engine.engine == Engine::kClassic)
        throw UsageError("an .svg is drawn by the exact engine; leave out --engine classic");
    if (options.wire && kind != OutputKind::kSvg) throw UsageError("--wire is for .svg outputs");
    const std::unique_ptr<World> world = load_world(options.scene, console);
    PictureRequest request;
    request.camera = chosen_camera(options.scene, world->scene);
    request.engine = engine;
    request.command = command;
    Answer answer;
    if (!options.pixel.empty()) {
        const std::vector<int> pixel = parse_integers(options.pixel, ',', 2, "--pixel");
        answer.fields = explain_pixel(*world, request, pixel[0], pixel[1], console);
        answer.text = answer.fields.dump(2);
        if (options.output.empty()) return answer;
    }
    if (kind == OutputKind::kSvg) return run_vector(options, *world, console);
    request.layers = layer_request(options.scene, world->scene.film);
    const Picture picture = draw_picture(*world, request, console);
    write_picture(options.output, picture.image, kind);
    answer.fields["output"] = options.output;
    answer.fields["engine"] = engine_name(engine.engine);
    if (engine.engine == Engine::kClassic) answer.fields["classic"] = classic_name(engine.classic);
    answer.fields.update(picture_fields(*world, picture));
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
