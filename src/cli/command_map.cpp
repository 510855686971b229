// trilens map: maps between a film and a panorama, dome, plane or object, for other programs.
#include <trilens/error.h>
#include <trilens/maps.h>
#include <trilens/utilities.h>
#include <limits>
#include <memory>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print/print.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

struct MapOptions {
    SceneOptions scene;
    DirectionOptions direction;
    std::string to, way, word, mesh = "auto", grid = "film", output;
    double tolerance = FilmMapRequest().tolerance, max_error = WarpMeshParams().max_error;
    bool t_up = false;
};

FilmMapRequest request_of(const MapOptions& options, const Renderer& renderer) {
    FilmMapRequest request{target_request(renderer, options.direction, options.to, options.tolerance)};
    if (!options.way.empty()) request.way = *find_named<MapWay>(options.way);
    if (!options.word.empty()) request.word = EventWord(options.word);
    request.frame.camera = find_camera(renderer.scene(), options.scene.camera);
    return request;
}

Json error_json(const std::optional<WarpError>& error) {
    if (!error) return nullptr;
    return {{"mean", error->mean}, {"p99", error->p99}, {"max", error->max}};
}

Answer run_mesh(const MapOptions& options, const FilmMapRequest& request, const Renderer& renderer,
                Console& console) {
    if (options.way == "unwrap") throw UsageError("a mesh is of the film: --way view, or none");
    WarpMeshParams params;
    params.max_error = options.max_error;
    params.grid = *find_named<WarpGrid>(options.grid);
    if (options.mesh != "auto") {
        const std::vector<int> size = parse_integers(options.mesh, 'x', 2, "--mesh");
        params.columns = size[0];
        params.rows = size[1];
        if (params.columns < 2 || params.rows < 2) throw UsageError("--mesh has at least 2x2 nodes");
    }
    const Stopwatch watch;
    const WarpMesh mesh = make_mesh(renderer, request, params, console.progress("map"));
    const double seconds = watch.seconds();
    write_mesh(options.output, mesh);
    if (!mesh.error)
        console.warn("no cell of the mesh is drawn whole, or none can be measured: its error is unmeasured");
    else if (params.columns == 0 && mesh.error->p99 > params.max_error)
        console.warn(
            fmt::format("the finest mesh is off by {:.3g} pixels between its nodes (p99)", mesh.error->p99));
    Answer answer = name_output(options.output, console);
    answer.fields["grid"] = name_of(mesh.grid);
    answer.fields["columns"] = mesh.columns;
    answer.fields["rows"] = mesh.rows;
    answer.fields["drawn"] = mesh.drawn_count();
    answer.fields["error_px"] = error_json(mesh.error);
    answer.fields["seconds"] = seconds;
    console.note_stage(fmt::format("made a mesh of {} x {} nodes", mesh.columns, mesh.rows), watch);
    return answer;
}

Answer run(const MapOptions& options, Console& console) {
    console.files().reads({options.scene.scene});
    const std::string format = map_format(options.output);
    if (format == "pgm") {
        for (const MapAxis axis : {MapAxis::kX, MapAxis::kY})
            check_output(pgm_name(options.output, axis), console);
    } else {
        check_output(options.output, console);
    }
    if (options.t_up && format != "exr") throw UsageError("--t-up is about STMaps: .exr");
    const Renderer renderer = load_smooth_renderer(options.scene, console);
    const FilmMapRequest request = request_of(options, renderer);
    if (format == "data" || format == "obj") return run_mesh(options, request, renderer, console);

    const Stopwatch watch;
    const FilmMap map = make_map(renderer, request, console.progress("map"));
    const double seconds = watch.seconds();
    write_map(options.output, map, options.t_up);
    Answer answer =
        name_output(format == "pgm" ? pgm_name(options.output, MapAxis::kX) : options.output, console);
    if (format == "pgm") answer.text += "\n" + pgm_name(options.output, MapAxis::kY);
    answer.fields["way"] = name_of(request.way);
    answer.fields["width"] = map.width;
    answer.fields["height"] = map.height;
    answer.fields["source"] = {map.source_width, map.source_height};
    answer.fields["valid"] = map.valid_count();
    answer.fields["exact_places"] = map.exact_places;
    answer.fields["worst_accepted_px"] = map.worst_accepted;
    answer.fields["seconds"] = seconds;
    console.note_stage(fmt::format("mapped {} of {} x {} pixels", map.valid_count(), map.width, map.height),
                       watch);
    return answer;
}

}  // namespace

Command map_command() {
    auto options = std::make_shared<MapOptions>();
    Command command{
        .name = "map", .summary = "maps of film to world and back, for other programs", .schema = "map"};
    command.options = joined(
        {scene_argument(options->scene),
         {{.names = "--to",
           .target = &options->to,
           .help =
               "equirect:WxH, cubemap:N, fisheye:N[:DEGREES], plane:ox,oy,oz,ux,uy,uz,vx,vy,vz,WxH, or an "
               "object as NAME or NAME:WxH",
           .value = "TARGET",
           .is_required = true},
          {.names = "-o,--output",
           .target = &options->output,
           .help =
               ".exr (STMap), .npz (OpenCV's remap), .pgm (ffmpeg's remap, two files), .data (Bourke's warp "
               "mesh) or .obj (the mesh)",
           .value = "FILE",
           .offer = Offer::kFile,
           .is_required = true},
          {.names = "--way",
           .target = &options->way,
           .help =
               "unwrap: of the target's size, warps photographs into it (the default); view: of the film's "
               "size, warps pictures of the target into what the camera sees, by every pixel's own ray",
           .choices = {"unwrap", "view"}},
          {.names = "--word",
           .target = &options->word,
           .help = "view and meshes on the film, instead of --path: events to follow, R reflected, T "
                   "transmitted, ? either",
           .value = "WORD"},
          {.names = "--tolerance",
           .target = &options->tolerance,
           .help = "source pixels that places between exact ones may be off (of a view all are exact: that "
                   "the derivatives' lattice may be off them)",
           .range = {1e-9, 100}},
          {.names = "--mesh",
           .target = &options->mesh,
           .help = "nodes of a warp mesh; auto: as many as --max-error needs",
           .value = "NxM|auto"},
          {.names = "--grid",
           .target = &options->grid,
           .help =
               "where a mesh is regular: on the film, or on the target (a fisheye in rays and rings), which "
               "needs fewer nodes at an optic's rim; --word goes with the first, --path with the other",
           .choices = {"film", "target"}},
          {.names = "--max-error",
           .target = &options->max_error,
           .help =
               "pixels that 99 % of a mesh's cells may be off, as programs interpolate: of the target, with "
               "--grid target of the film",
           .range = {1e-6, 1000}},
          {.names = "--t-up",
           .target = &options->t_up,
           .help = "STMaps whose t counts from the bottom, as Nuke's"}},
         direction_options(options->direction),
         scene_overrides_but_optic(options->scene)});
    command.body = [options](Console& console) { return run(*options, console); };
    return command;
}

}  // namespace trilens
