// Renderers: pictures and line drawings of a scene.
#include "arrays.h"
#include "bindings.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <trilens/display.h>

#include <optional>

#include "python_call.h"

namespace trilens::python {
namespace {

using Window = std::array<int, 4>;
using Names = std::vector<std::string>;

/// What the classic engine may be told; none of it may be given to another engine.
struct ClassicArguments {
    std::optional<std::string> curves, clip;
    std::optional<int> pieces;
    std::optional<double> tolerance;
};

ClassicParams classic_params(const ClassicArguments& given) {
    ClassicParams params;
    if (given.curves) params.curves = require_named<Curves>("curves", *given.curves);
    if (given.clip) params.clip = require_named<Clip>("clip", *given.clip);
    params.pieces = given.pieces.value_or(params.pieces);
    params.tolerance = given.tolerance.value_or(params.tolerance);
    return params;
}

/// What facets are asked to be, beside their number.
struct FacetArguments {
    std::optional<std::string> rays;
    std::optional<double> max_error;
    std::optional<std::string> grid;
    std::optional<std::string> seen_optics = {};
    std::optional<std::string> facets = {};
    bool certify = false;

    FrameParams of(FrameParams frame) const {
        if (grid) frame.grid = require_named<GridKind>("grid", *grid);
        if (rays) frame.rays = require_named<CornerRays>("rays", *rays);
        if (seen_optics) {
            require_known("seen_optics", *seen_optics, Names{"layers", "divided"});
            frame.layered = *seen_optics == "layers";
        }
        if (facets) frame.facets = require_named<FacetUse>("facets", *facets);
        frame.max_error = max_error;
        frame.certify = certify;
        return frame;
    }
};

EngineChoice projecting_engine(const std::string& name, const ClassicArguments& classic) {
    const Names projecting{"exact", "classic", "envmap", "planar"};
    require_known("projecting engine", name, projecting);
    if (name == "classic") return classic_params(classic);
    if (classic.curves || classic.clip || classic.pieces || classic.tolerance)
        throw UsageError(
            "curves, clip, pieces and tolerance are the classic engine's; add engine=\"classic\"");
    return engine_choice(name);
}

LayerRequest layer_request(const std::optional<Names>& layers, const std::optional<Window>& window,
                           const std::string& shading = "fragment") {
    LayerRequest request;
    if (window) {
        if (*window == Window{}) throw UsageError("0,0,0,0 is no window of the film");
        request = {(*window)[0], (*window)[1], (*window)[2], (*window)[3], {}};
    }
    if (layers) {
        if (layers->empty()) throw UsageError("no layers are asked for; None asks for the usual ones");
        request.layers = *layers;
    }
    request.shading = require_named<Shading>("shading", shading);
    return request;
}

using File = std::optional<std::filesystem::path>;

/// How light becomes what a screen shows, and whether before a pixel's samples are averaged.
struct ToneArguments {
    ToneMapping mapping;
    bool filter_shown = false;

    /// What is done when a file is written: nothing more, where it was done to the samples.
    ToneMapping written() const { return filter_shown ? ToneMapping() : mapping; }
};

ToneArguments tone_arguments(double exposure, const std::string& tone, double white, bool filter_shown) {
    const ToneArguments given{{exposure, tone_curve(tone), white}, filter_shown};
    check_tone_mapping(given.mapping);
    return given;
}

/// What is asked for: "render" or "trace", the file that takes it, the viewer that shows it, if any, and what
/// of its light is shown.
struct Job {
    std::string name;
    const File& file;
    const std::optional<std::string>& display_server;
    ToneArguments tones;
};

/// Throws UsageError where light is to be changed that stays what it is.
void check_tones(const Job& job) {
    const ToneMapping usual, &asked = job.tones.mapping;
    const bool maps =
        asked.exposure != usual.exposure || asked.curve != usual.curve || asked.white != usual.white;
    const bool is_exr = job.file && image_format(job.file->string()) == ImageFormat::kExr;
    if (is_exr && (maps || job.tones.filter_shown))
        throw UsageError(
            "exposure, tone, white and filter_shown are for .png files; an .exr holds the light of the "
            "scene");
    if (!job.file && maps && !job.tones.filter_shown)
        throw UsageError(
            "exposure, tone and white are for .png files and for filter_shown; give them to Image.save");
}

/// Draws the picture, into the job's file where it has one.
Picture draw_or_write(const Renderer& renderer, PictureRequest request, const Job& job, PythonCall& call) {
    const Progress progress = call.progress(job.name);
    std::optional<DisplayServer> display;
    StripSink shown;
    if (job.display_server) {
        display.emplace(*job.display_server, call.warner());
        shown = display->sink(job.file ? job.file->string() : job.name);
        request.watch = &shown;
    }
    if (!job.file) return renderer.draw(request, progress, call.warner());
    const std::string file = job.file->string();
    if (image_format(file) == ImageFormat::kExr)
        return renderer.write_exr(file, request, progress, call.warner());
    Picture picture = renderer.draw(request, progress, call.warner());
    write_image(file, picture.image, job.tones.written());
    return picture;
}

HeldImage draw(const Renderer& renderer, PictureRequest request, const Job& job, PythonCall& call) {
    check_tones(job);
    if (job.tones.filter_shown)
        request.layers.shown = [mapping = job.tones.mapping](const Vec3& light) {
            return glm::clamp(tone_mapped(light, mapping), 0.0, 1.0);
        };
    Picture picture = call.run([&] { return draw_or_write(renderer, request, job, call); });
    const py::dict statistics = statistics_dict(picture);
    return {std::move(picture.image), statistics};
}

void bind_pictures(RendererClass& renderer) {
    renderer.def(
        "render",
        [](const Renderer& self, int resolution, const std::optional<std::string>& camera,
           const std::string& engine, const std::optional<Names>& layers, const std::optional<Window>& window,
           const std::optional<std::string>& curves, const std::optional<std::string>& clip,
           std::optional<int> pieces, std::optional<double> tolerance, const std::optional<std::string>& rays,
           std::optional<double> max_error, const std::optional<std::string>& grid,
           const std::optional<std::string>& seen_optics, const std::optional<std::string>& facets,
           bool certify, const std::string& shading, double exposure, const std::string& tone, double white,
           bool filter_shown, const File& file, const std::optional<std::string>& display_server,
           const py::object& progress, const py::object& warn) {
            PythonCall call(progress, warn);
            return draw(self,
                        {FacetArguments{rays, max_error, grid, seen_optics, facets, certify}.of(
                             frame_params(self, resolution, camera)),
                         projecting_engine(engine, {curves, clip, pieces, tolerance}),
                         layer_request(layers, window, shading)},
                        {"render", file, display_server, tone_arguments(exposure, tone, white, filter_shown)},
                        call);
        },
        py::arg("resolution") = 0, py::arg("camera") = py::none(), py::arg("engine") = "exact",
        py::arg("layers") = py::none(), py::arg("window") = py::none(), py::kw_only(),
        py::arg("curves") = py::none(), py::arg("clip") = py::none(), py::arg("pieces") = py::none(),
        py::arg("tolerance") = py::none(), py::arg("rays") = py::none(), py::arg("max_error") = py::none(),
        py::arg("grid") = py::none(), py::arg("seen_optics") = py::none(), py::arg("facets") = py::none(),
        py::arg("certify") = false, py::arg("shading") = "fragment", py::arg("exposure") = 0.0,
        py::arg("tone") = "none", py::arg("white") = ToneMapping().white, py::arg("filter_shown") = false,
        py::arg("file") = py::none(), py::arg("display_server") = py::none(),
        py::arg("progress") = py::none(), py::arg("warn") = py::none(),
        "Draws the scene by projection. The same pixels for any number of threads.\n\n"
        "resolution: 1..1024, of every optic's grid; 0: as the scene says.\n"
        "camera: by name; None: the scene's own.\n"
        "engine: \"exact\", \"classic\" (the thesis' engine), \"envmap\" or \"planar\" (the usual "
        "approximations).\n"
        "layers: to keep beside R G B A, of layer_names(); None: all but \"path\", \"stat\", "
        "\"magnification\",\n"
        "\"position\", \"ray\", \"bound\" and \"coverage\".\n"
        "window: (x0, y0, x1, y1) of the film in pixels, x1 and y1 outside; None: all of it.\n"
        "curves, clip, pieces, tolerance: of the classic engine: \"arcs\", \"slices\", \"tessellate\" or\n"
        "\"straight\"; \"scene\", \"screen\" or \"none\"; pieces 1..1024; arcs keep within tolerance "
        "pixels.\n"
        "rays: \"fitted\" or \"interpolated\", of every optic; None: as the scene says.\n"
        "max_error: pixels, 0..1000; facets whose predicted displacement is more are divided, and at last\n"
        "traced; 0: only those off by more than (32 / n)^2 pixels of a film 480 high, and by one;\n"
        "None: as the scene says.\n"
        "seen_optics: \"layers\" (optics seen in mirrors are layers of their own, where they can be) or "
        "\"divided\";\n"
        "None: as the scene says.\n"
        "facets: \"worthwhile\" (those that it takes longer to probe than to follow the rays of their "
        "samples\nare traced) or \"all\" (none is for that); None: worthwhile.\n"
        "certify: it is proven at each pixel's middle that what optics show is off by at most max_error > "
        "0\n(layer \"bound\"); what is not proven is traced.\n"
        "shading: where pixels have several samples: \"fragment\" (once for those that see one triangle by "
        "one way,\nthe classic engine each) or \"sample\".\n"
        "grid: \"surface\" (n x n facets on each face) or \"screen\" (n x n over each optic's bounds on the "
        "film);\nNone: as the scene says.\n"
        "exposure, tone, white: of a .png file, as Image.save has them.\n"
        "filter_shown: average a pixel's samples as the screen shows them, after exposure and tone, not "
        "their light:\nbright highlights neither stay jagged nor leave dark rings. R, G and B then are what "
        "is shown, 0..1, linear; not\nfor .exr files, which hold the light of the scene.\n"
        "file: an OpenEXR file (.exr) that is written while the picture is drawn, which is then never held "
        "whole: the\nimage that is returned has header and statistics, but no channels; or the beauty as "
        "8-bit sRGB (.png), and\nthe image is whole. Raises UsageError for other endings, OutputError; an "
        "old file stays until the new one is\nwhole.\n"
        "display_server: \"HOST:PORT\" of the viewer tev (127.0.0.1:14158), which shows the picture while it "
        "is drawn.\nOutputError where nobody answers there; a viewer that goes away later is a warning.\n"
        "progress: called as progress(done, job), done in 0..1; returning False raises Interrupted. True: a "
        "bar, in\nnotebooks and on terminals.\n"
        "warn: called with each warning; None: the warnings module tells (TrilensWarning).\n"
        "Raises UsageError for a camera, layer, window or other value that there is not, InputError where "
        "the\n"
        "picture does not fit in memory or the camera cannot show what the scene has, ComputationError for "
        "pixels that are not finite. Ctrl-C stops it: "
        "KeyboardInterrupt.");
    renderer.def(
        "trace",
        [](const Renderer& self, const std::string& surface, int resolution,
           const std::optional<std::string>& camera, const std::optional<Names>& layers,
           const std::optional<Window>& window, const std::optional<std::string>& rays,
           std::optional<double> max_error, const std::optional<std::string>& grid,
           const std::optional<std::string>& seen_optics, const std::optional<std::string>& facets,
           double exposure, const std::string& tone, double white, bool filter_shown, const File& file,
           const std::optional<std::string>& display_server, const py::object& progress,
           const py::object& warn) {
            require_known("surface", surface, Names{"limit", "facets"});
            if (surface == "limit" && (rays || max_error || grid || seen_optics || facets))
                throw UsageError(
                    "rays, max_error, grid, seen_optics and facets are about facets; add "
                    "surface=\"facets\"");
            PythonCall call(progress, warn);
            return draw(self,
                        {FacetArguments{rays, max_error, grid, seen_optics, facets}.of(
                             frame_params(self, resolution, camera)),
                         engine_choice(surface), layer_request(layers, window)},
                        {"trace", file, display_server, tone_arguments(exposure, tone, white, filter_shown)},
                        call);
        },
        py::arg("surface") = "limit", py::arg("resolution") = 0, py::arg("camera") = py::none(),
        py::arg("layers") = py::none(), py::arg("window") = py::none(), py::kw_only(),
        py::arg("rays") = py::none(), py::arg("max_error") = py::none(), py::arg("grid") = py::none(),
        py::arg("seen_optics") = py::none(), py::arg("facets") = py::none(), py::arg("exposure") = 0.0,
        py::arg("tone") = "none", py::arg("white") = ToneMapping().white, py::arg("filter_shown") = false,
        py::arg("file") = py::none(), py::arg("display_server") = py::none(),
        py::arg("progress") = py::none(), py::arg("warn") = py::none(),
        "Draws the same scene by ray tracing: the truth.\n\n"
        "surface: \"limit\" (the exact surfaces) or \"facets\" (the rays that render's facets interpolate).\n"
        "rays, max_error, grid, seen_optics and facets are about facets: UsageError without "
        "surface=\"facets\". The "
        "other\narguments, and what is raised, are those of render.");
}

void bind_line_drawing(py::module_& module, RendererClass& renderer) {
    py::class_<LineDrawing>(module, "LineDrawing", "A picture as lines. Notebooks show it.")
        .def_readonly("svg", &LineDrawing::svg, "One SVG document.")
        .def_readonly("curves", &LineDrawing::curves, "How many curves it has.")
        .def_readonly("arcs", &LineDrawing::arcs, "How many arcs the curves have.")
        .def_readonly("folds", &LineDrawing::folds, "How many fold curves it has.")
        .def_readonly("obj", &LineDrawing::obj,
                      "Caustics and fold curves in the world as a Wavefront OBJ; \"\" where not asked for.")
        .def_property_readonly(
            "caustics", &caustic_list,
            "The sheets of the caustics, where asked for: a list of dicts of path\n"
            "(\"reflect\", \"refract\", \"direct\": of the camera's own rays), optic (object id; None: the "
            "camera),\n"
            "sheet (0, 1), virtual (behind the optic), points (N, 3), triangles (M, 3), segments (K, 2).")
        .def_property_readonly(
            "edge_lines", &edge_list,
            "The curves as polygonal lines: a list of dicts of path, optic (object id; None: the camera),\n"
            "object (whose edge it is) and points (N, 2) in pixels.")
        .def_property_readonly(
            "fold_curves", &fold_list,
            "A list of dicts of object (id on which the curve lies; None: the environment), points (N, 2)\n"
            "in pixels, places (N, 3): the world points seen there, in the environment unit directions.")
        .def("_repr_svg_", [](const LineDrawing& drawing) { return drawing.svg; })
        .def(
            "save",
            [](const LineDrawing& drawing, const std::filesystem::path& file) {
                replace_text_file(file.string(), drawing.svg);
            },
            py::arg("file"), "Writes the document. Raises OutputError.");
    renderer.def(
        "draw_lines",
        [](const Renderer& self, int resolution, const std::optional<std::string>& camera, bool wire,
           bool folds, bool caustics, const std::optional<std::string>& rays,
           const std::optional<std::string>& grid, const py::object& warn) {
            PythonCall call(py::none(), warn);
            const FrameParams frame =
                FacetArguments{rays, std::nullopt, grid}.of(frame_params(self, resolution, camera));
            return call.run([&] { return self.draw_lines(frame, {wire, folds, caustics}, call.warner()); });
        },
        py::arg("resolution") = 0, py::arg("camera") = py::none(), py::kw_only(), py::arg("wire") = false,
        py::arg("folds") = false, py::arg("caustics") = false, py::arg("rays") = py::none(),
        py::arg("grid") = py::none(), py::arg("warn") = py::none(),
        "The outlines of what the camera and the optics show, every curved edge an exact conic.\n"
        "wire: hidden edges too. folds: the curves too where what an optic shows turns over on the film "
        "(the\n"
        "eye's caustics). caustics: the surfaces too where neighbouring rays that leave an optic meet. The\n"
        "other arguments, and what is raised, are those of render; nothing is divided, so there is no "
        "max_error.");
}

}  // namespace

FrameParams frame_params(const Renderer& renderer, int resolution, const std::optional<std::string>& camera) {
    FrameParams frame{find_camera(renderer.scene(), camera.value_or("")), resolution};
    frame.facets = FacetUse::kWorthwhile;
    return frame;
}

EngineChoice engine_choice(const std::string& name) {
    const auto engine = require_named<Engine>("engine", name);
    return engine == Engine::kClassic ? EngineChoice(ClassicParams{}) : EngineChoice(engine);
}

void bind_renderer(py::module_& module) {
    py::class_<OpticInfo> optic(module, "Optic", "An optic of a renderer.");
    bind_fields(optic, field("object", &OpticInfo::object, "Its object id: its index in Scene.meshes."),
                field("name", &OpticInfo::name, "Its name."),
                field("mirror", &OpticInfo::mirror, "Whether it is a mirror; else it is glass."),
                field("resolution", &OpticInfo::resolution, "The scene's: N x N facets per quad face."),
                field("faces", &OpticInfo::faces, "Faces of its surface."));
    RendererClass renderer(
        module, "Renderer",
        "A scene with what is built from it, each part once: surfaces, trees, grids. Several\n"
        "threads may draw with one renderer at once.");
    renderer.def(py::init([](const Scene& scene, const py::object& warn) {
                     PythonCall call(py::none(), warn);
                     return call.run([&] { return std::make_shared<Renderer>(scene, call.warner()); });
                 }),
                 py::arg("scene"), py::kw_only(), py::arg("warn") = py::none(),
                 "Raises InputError where a cage has no limit surface. warn: see load_scene.");
    renderer.def(
        "change",
        [](Renderer& self, const Scene& scene, const py::object& warn) {
            PythonCall call(py::none(), warn);
            const SceneReuse kept = call.run([&] { return self.change(scene, call.warner()); });
            py::dict parts;
            parts["objects"] = kept.objects;
            parts["optics"] = kept.optics;
            return parts;
        },
        py::arg("scene"), py::kw_only(), py::arg("warn") = py::none(),
        "Goes on with another scene, as of an animation's next frame; what is built of meshes that are the "
        "same\nin both stays. Returns what stayed: objects (all of them, or not) and how many optics. "
        "Raises\nas the constructor does, and UsageError while another thread draws; then nothing has "
        "changed.");
    bind_pictures(renderer);
    bind_line_drawing(module, renderer);
    bind_project(renderer);
    bind_shoot(renderer);
    bind_bake(renderer);
    bind_unwrap(renderer, module);
    bind_explain(renderer);
    bind_facts(renderer);
}

}  // namespace trilens::python
