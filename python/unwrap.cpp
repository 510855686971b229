// Photographs unwrapped, maps for other programs, and anamorphoses.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <variant>

#include "arrays.h"
#include "bindings.h"
#include "python_call.h"

namespace trilens::python {
namespace {

using Name = std::optional<std::string>;
using PhotoFile = std::filesystem::path;
using Photo = std::variant<std::shared_ptr<HeldImage>, PhotoFile>;

UnwrapPhoto photo_from(const Photo& given, const std::string& name) {
    if (const auto* held = std::get_if<std::shared_ptr<HeldImage>>(&given))
        return photo_of((*held)->image, name);
    return read_photo(std::get<PhotoFile>(given).string());
}

std::optional<std::size_t> optic_index(const Renderer& renderer, const Name& name) {
    if (!name) return std::nullopt;
    std::vector<std::string> names;
    for (const OpticInfo& optic : renderer.optics()) names.push_back(optic.name);
    require_known("optic", *name, names);
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), *name) - names.begin());
}

std::optional<Path> path_named(const Name& name) {
    if (!name) return std::nullopt;
    require_known("path", *name, std::vector<std::string>{"reflect", "refract", "direct"});
    return *name == "direct" ? Path::kDirect : *name == "refract" ? Path::kRefract : Path::kReflect;
}

std::optional<Vec3> center_of(const std::optional<Triple>& center) {
    return center ? std::optional(vec3(*center)) : std::nullopt;
}

struct TargetArguments {
    std::string to, proxy;
    std::optional<Triple> center;
    Name optic, path;
    double tolerance = TargetRequest().tolerance;
};

TargetRequest target_request(const Renderer& self, const TargetArguments& given) {
    TargetRequest request;
    request.target = parse_target(given.to, self.scene());
    request.proxy = parse_proxy(given.proxy);
    request.center = center_of(given.center);
    request.optic = optic_index(self, given.optic);
    request.path = path_named(given.path);
    request.tolerance = given.tolerance;
    return request;
}

void set_images(UnwrapRequest& request, const std::variant<std::string, int>& images) {
    if (const int* rank = std::get_if<int>(&images)) {
        request.rank = *rank;
    } else {
        request.images = require_named<UnwrapImages>("choice of images", std::get<std::string>(images));
    }
}

void bind_unwrap_itself(RendererClass& renderer) {
    renderer.def(
        "unwrap",
        [](const Renderer& self, const std::variant<Photo, std::vector<Photo>>& photo, const std::string& to,
           const std::optional<std::vector<std::string>>& cameras,
           const std::optional<std::vector<Photo>>& masks,
           const std::optional<std::vector<double>>& exposures, double white,
           const std::optional<Triple>& center, const std::string& proxy, const Name& optic, const Name& path,
           const std::variant<std::string, int>& images, double min_resolution, double tolerance,
           bool divide_weight, const py::object& progress) {
            UnwrapRequest request{target_request(self, {to, proxy, center, optic, path, tolerance})};
            set_images(request, images);
            request.min_resolution = min_resolution;
            request.divide_weight = divide_weight;
            const auto* several = std::get_if<std::vector<Photo>>(&photo);
            const std::vector<Photo> given = several ? *several : std::vector<Photo>{std::get<Photo>(photo)};
            for (const std::size_t count :
                 {cameras ? cameras->size() : given.size(), masks ? masks->size() : given.size(),
                  exposures ? exposures->size() : given.size()})
                if (count != given.size())
                    throw UsageError("there is not one camera, mask or exposure for each photograph");
            std::vector<UnwrapPhoto> photos;
            for (std::size_t i = 0; i < given.size(); ++i) {
                UnwrapPhoto one = photo_from(given[i], "photo");
                one.camera = cameras             ? find_camera(self.scene(), (*cameras)[i])
                             : given.size() == 1 ? self.scene().own_camera
                                                 : i;
                if (masks) one.mask = photo_from((*masks)[i], "mask").picture;
                if (exposures) one.exposure = (*exposures)[i];
                one.white = white;
                photos.push_back(std::move(one));
            }
            PythonCall call(progress);
            Unwrapped made = call.run([&] { return unwrap(self, request, photos, call.progress("unwrap")); });
            py::dict statistics;
            statistics["coverage"] = made.coverage;
            statistics["resolution_median"] = made.resolution_median;
            statistics["exact_places"] = made.exact_places;
            statistics["worst_accepted"] = made.worst_accepted;
            return HeldImage{std::move(made.image), statistics};
        },
        py::arg("photo"), py::arg("to"), py::kw_only(), py::arg("cameras") = py::none(),
        py::arg("masks") = py::none(), py::arg("exposures") = py::none(), py::arg("white") = 0.0,
        py::arg("center") = py::none(), py::arg("proxy") = "scene", py::arg("optic") = py::none(),
        py::arg("path") = py::none(), py::arg("images") = "best", py::arg("min_resolution") = 0.0,
        py::arg("tolerance") = UnwrapRequest().tolerance, py::arg("divide_weight") = true,
        py::arg("progress") = py::none(),
        "A photograph of mirrors or glass as a panorama, a cube map, a plane or an object's texture.\n\n"
        "photo: an Image of the film's size, or a file; or a list of such, one for each camera.\n"
        "to: \"equirect:WxH\" (as the background has it: the middle column is -Z, the top row +Y), "
        "\"cubemap:N\" "
        "(six faces\nside by side, +X -X +Y -Y +Z -Z), \"fisheye:N\" or \"fisheye:N:DEGREES\" (about +Y), "
        "\"plane:ox,oy,oz,ux,uy,uz,\nvx,vy,vz,WxH\" (lower left corner, side to the right, side upward), or "
        "an object "
        "as \"NAME\" or \"NAME:WxH\".\n"
        "cameras: by name, one for each photograph; None: the scene's own, or of several photographs the "
        "scene's in "
        "order.\n"
        "masks: pictures of the film's size, one for each photograph; where they are dark nothing is taken.\n"
        "exposures: what each photograph's values are divided by; longer ones are taken first.\n"
        "white: values from here on are clipped, and taken only where nothing else is; 0: none.\n"
        "center: where directions start, world; None: the middle of the optics.\n"
        "proxy: how far what a direction shows is: \"scene\" (its objects), \"infinity\", \"sphere:R\",\n"
        "\"box:x0,y0,z0,x1,y1,z1\" or a file \"room.obj\".\n"
        "optic: only over this one, by name. path: \"reflect\", \"refract\" or \"direct\"; None: by the "
        "optic.\n"
        "images: of several images \"best\" (resolved), \"blend\", or the number of the best: 1, 2, ...\n"
        "min_resolution: pixels of the photograph per degree, or unit; what is resolved worse is left out.\n"
        "tolerance: pixels of the photograph that places between exact ones may be off.\n"
        "divide_weight: by what mirrors and glass leave of the light.\n"
        "progress: called as progress(done, job); returning False raises Interrupted.\n"
        "Returns an Image of the target's size: R G B, A (1 where it is seen), res.min and res.max (pixels "
        "of the "
        "photograph\nper degree, or unit, in the worst and the best resolved direction), src.X and src.Y "
        "(place on the "
        "photograph), image.count\nand, of several photographs, image.photo; statistics: coverage (share of "
        "the solid "
        "angle, or area), resolution_median,\nexact_places, worst_accepted (pixels).\n"
        "Raises UsageError for what the scene does not have, InputError for a photograph of another size, a "
        "camera "
        "inside\nthe optic, and where nothing of the target is seen.");
}

py::dict map_arrays(FilmMap map) {
    const std::vector<py::ssize_t> shape{map.height, map.width};
    std::vector<float> jacobian(4 * map.x.size());
    for (std::size_t p = 0; p < map.x.size(); ++p)
        for (std::size_t k = 0; k < 4; ++k) jacobian[4 * p + k] = map.jacobian[k][p];
    py::dict arrays;
    arrays["x"] = array_of(std::move(map.x), shape);
    arrays["y"] = array_of(std::move(map.y), shape);
    arrays["jacobian"] = array_of(std::move(jacobian), {map.height, map.width, 2, 2});
    const py::array valid = array_of(std::move(map.valid), shape);
    arrays["valid"] = valid.attr("view")("bool");
    return arrays;
}

FilmMapRequest map_request(const Renderer& self, const TargetArguments& target, const Name& word,
                           const Name& camera) {
    FilmMapRequest request{target_request(self, target)};
    if (word) request.word = EventWord(*word);
    request.frame = frame_params(self, 0, camera);
    return request;
}

void bind_caustic(RendererClass& renderer) {
    renderer.def(
        "caustic",
        [](const Renderer& self, const std::string& onto, int light, bool back, bool exact, double tolerance,
           const std::optional<PhotoFile>& file, const py::object& progress, const py::object& warn) {
            CausticMapRequest request;
            request.light = light < 0 ? self.scene().lights.size() : static_cast<std::size_t>(light);
            request.target = parse_target(onto, self.scene());
            request.back = back;
            request.exact = exact;
            request.tolerance = tolerance;
            PythonCall call(progress, warn);
            const CausticMap map = call.run([&] {
                CausticMap made = make_caustic_map(self, request, call.progress("caustic"));
                if (file) write_image(file->string(), image_of(made));
                call.tell_all(made.warnings);
                return made;
            });
            std::vector<double> light_there;
            for (const Vec3& one : map.irradiance)
                for (int k = 0; k < 3; ++k) light_there.push_back(one[k]);
            const auto numbers = [](const Vec3& flux) { return std::array{flux.x, flux.y, flux.z}; };
            py::dict made;
            made["irradiance"] = array_of(std::move(light_there), {map.height, map.width, 3});
            made["flux_in"] = numbers(map.flux_in);
            made["flux_on_objects"] = numbers(map.flux_on_objects);
            made["flux_away"] = numbers(map.flux_away);
            made["flux_received"] = numbers(map.flux_received);
            made["beams"] = map.beams;
            made["coarse"] = map.coarse;
            made["warnings"] = map.warnings;
            return made;
        },
        py::arg("onto"), py::arg("light") = 0, py::kw_only(), py::arg("back") = false,
        py::arg("exact") = false, py::arg("tolerance") = CausticMapRequest().tolerance,
        py::arg("file") = py::none(), py::arg("progress") = py::none(), py::arg("warn") = py::none(),
        "The light that comes over mirrors and through glass onto an object or a plane.\n\n"
        "onto: \"NAME:WxH\", an object, or \"plane:...\", as in unwrap.\n"
        "light: index of the scene's light, whether it has caustics or not.\n"
        "back: the light on the other side of the surface than its front.\n"
        "exact: the truth, as trace has it: by exact rays at every pixel, however long it takes.\n"
        "tolerance: how far light may fall from its place, as a share of the scene's size.\n"
        "file: written too: .exr.\n"
        "progress: as in draw. warn: as in load_scene.\n"
        "Returns a dict: irradiance (height, width, 3), linear Rec.709, the mean of each pixel; flux_in, "
        "from "
        "the light to the\noptics, flux_on_objects and flux_away, from there, and flux_received, in the map, "
        "each three colours; beams;\ncoarse, the parts of the light that the tolerance would have divided "
        "further; warnings, what is left out.\n"
        "Raises UsageError for a light that is none or has no rays of its own, and targets that are none.");
}

void bind_map(RendererClass& renderer) {
    renderer.def(
        "map",
        [](const Renderer& self, const std::string& to, const std::string& way, const Name& camera,
           const std::optional<Triple>& center, const std::string& proxy, const Name& optic, const Name& path,
           const Name& word, double tolerance, const std::optional<PhotoFile>& file,
           const py::object& progress) {
            FilmMapRequest request =
                map_request(self, {to, proxy, center, optic, path, tolerance}, word, camera);
            request.way = require_named<MapWay>("way", way);
            PythonCall call(progress);
            FilmMap map = call.run([&] {
                FilmMap made = make_map(self, request, call.progress("map"));
                if (file) write_map(file->string(), made);
                return made;
            });
            return map_arrays(std::move(map));
        },
        py::arg("to"), py::arg("way") = "unwrap", py::arg("camera") = py::none(), py::kw_only(),
        py::arg("center") = py::none(), py::arg("proxy") = "scene", py::arg("optic") = py::none(),
        py::arg("path") = py::none(), py::arg("word") = py::none(),
        py::arg("tolerance") = FilmMapRequest().tolerance, py::arg("file") = py::none(),
        py::arg("progress") = py::none(),
        "A map between the film and a target, pixel by pixel.\n\n"
        "to, center, proxy, optic, progress: as in unwrap; path too, for the way \"unwrap\" alone.\n"
        "way: \"unwrap\": of the target's size, with places on the film; \"view\": of the film's size, with "
        "places on the\ntarget: exactly the pixels whose own ray, as shoot follows it, shows it.\n"
        "word: for the way \"view\" alone, the events to follow, as in shoot.\n"
        "tolerance: source pixels that places between exact ones may be off; of a view, whose places are all "
        "exact, that the\nderivatives' lattice may be off them.\n"
        "file: written too: .exr (STMap), .npz (for cv2.remap) or .pgm (two files, for ffmpeg's remap).\n"
        "Returns a dict of arrays (height, width): x and y, float32, where to look, pixels from the source's "
        "top left, a pixel's\ncentre at .5, -1 where nothing is; valid, bool; jacobian (height, width, 2, "
        "2): [[dx/dx, dx/dy], [dy/dx, dy/dy]],\nsource pixels per pixel.\n"
        "Raises UsageError for what the scene does not have and a path or a word with the other way,\n"
        "InputError where nothing is mapped, OutputError.");
    renderer.def(
        "warp_mesh",
        [](const Renderer& self, const std::string& to, int columns, int rows, const Name& camera,
           double max_error, const std::optional<Triple>& center, const std::string& proxy, const Name& optic,
           const Name& path, const Name& word, const std::string& grid,
           const std::optional<PhotoFile>& file) {
            FilmMapRequest request = map_request(self, {to, proxy, center, optic, path}, word, camera);
            const WarpGrid regular_on = require_named<WarpGrid>("grid", grid);
            request.way = MapWay::kView;
            const WarpMesh mesh = PythonCall().run([&] {
                WarpMesh made = make_mesh(self, request, {columns, rows, max_error, regular_on});
                if (file) write_mesh(file->string(), made);
                return made;
            });
            std::vector<double> nodes;
            for (const WarpNode& node : mesh.nodes)
                for (const double value :
                     {node.film.x, node.film.y, node.target.x, node.target.y, node.intensity})
                    nodes.push_back(value);
            py::dict made;
            made["nodes"] = array_of(std::move(nodes), {mesh.rows, mesh.columns, 5});
            const auto error = [&](double WarpError::*which) {
                return mesh.error ? py::cast((*mesh.error).*which) : py::none();
            };
            made["error_mean"] = error(&WarpError::mean);
            made["error_p99"] = error(&WarpError::p99);
            made["error_max"] = error(&WarpError::max);
            return made;
        },
        py::arg("to"), py::arg("columns") = 0, py::arg("rows") = 0, py::arg("camera") = py::none(),
        py::kw_only(), py::arg("max_error") = WarpMeshParams().max_error, py::arg("center") = py::none(),
        py::arg("proxy") = "scene", py::arg("optic") = py::none(), py::arg("path") = py::none(),
        py::arg("word") = py::none(), py::arg("grid") = "film", py::arg("file") = py::none(),
        "A warp mesh: the film of a projector as a grid of quadrilaterals, with their places in the picture\n"
        "that is projected.\n\n"
        "to: the picture, of directions: \"fisheye:N\" or \"equirect:WxH\".\n"
        "center, proxy, optic: as in map.\n"
        "grid: where the mesh is regular: \"film\", where `word` says how rays go, as in map; or\n"
        "  \"target\", where `path` does, as in unwrap: a fisheye in rays and rings, an equirect in\n"
        "  columns and rows, so that cells are small at an optic's rim.\n"
        "columns, rows: nodes; both 0: as many as keep 99 % of the cells within max_error pixels (of the\n"
        "  target; with grid \"target\" of the film).\n"
        "file: written too: .data (Bourke's format) or .obj.\n"
        "Returns a dict: nodes (rows, columns, 5): film x and y, target x and y, in pixels from the top "
        "left,\n"
        "and intensity, 0..1, negative where nothing is drawn; error_mean, error_p99, error_max: how far "
        "off\n"
        "what programs interpolate in cells is, bilinearly or on two triangles, in the same pixels; None\n"
        "where no cell is drawn at all its nodes.\n"
        "Raises UsageError for what the scene does not have, and a word or a path with the other grid,\n"
        "InputError where the film shows nothing, OutputError.");
}

void bind_anamorph(py::module_& module) {
    module.def(
        "anamorph",
        [](const Renderer& renderer, const Photo& picture, const std::string& page, const Name& paper,
           double dpi, const std::string& unit, double bleed,
           const std::optional<std::array<double, 4>>& window, const Name& optic, const Name& camera,
           bool verify, const std::optional<PhotoFile>& file, const py::object& progress) {
            AnamorphRequest request;
            request.picture = photo_from(picture, "picture").picture;
            request.page = find_mesh(renderer.scene(), page);
            request.optic = optic_index(renderer, optic);
            request.window = window;
            request.dpi = dpi;
            request.unit = parse_unit(unit);
            request.bleed = bleed;
            request.frame = frame_params(renderer, 0, camera);
            if (paper) {
                PaperSize size = parse_paper(*paper);
                const auto flat = flat_rectangle(renderer.scene().meshes[request.page].object);
                if (flat && (length(flat->u) > length(flat->v)) == (size.width < size.height))
                    std::swap(size.width, size.height);
                request.paper = size;
            }
            if (file) check_page_name(file->string());
            PythonCall call(progress);
            std::optional<AnamorphCheck> check;
            Anamorph made = call.run([&] {
                Anamorph done = make_anamorph(renderer, request, call.progress("anamorph"));
                if (file) write_page(file->string(), done.page);
                if (verify) check = verify_anamorph(renderer, request, done);
                return done;
            });
            py::dict answer;
            const int wide = made.page.width, high = made.page.height;
            answer["page"] = array_of(std::move(made.page.rgb), {high, wide, 3});
            answer["paper"] = py::make_tuple(made.page.paper.width, made.page.paper.height);
            answer["window"] = py::cast(made.window);
            answer["coverage"] = made.coverage;
            answer["conflict"] = made.conflict;
            answer["extents"] = py::cast(made.extents);
            answer["psnr_db"] = check ? py::cast(check->psnr_db) : py::none();
            answer["seen"] = check ? py::cast(HeldImage{std::move(check->seen), {}}) : py::none();
            return answer;
        },
        py::arg("renderer"), py::arg("picture"), py::arg("page"), py::kw_only(),
        py::arg("paper") = py::none(), py::arg("dpi") = AnamorphRequest().dpi, py::arg("unit") = "cm",
        py::arg("bleed") = AnamorphRequest().bleed, py::arg("window") = py::none(),
        py::arg("optic") = py::none(), py::arg("camera") = py::none(), py::arg("verify") = false,
        py::arg("file") = py::none(), py::arg("progress") = py::none(),
        "The page to print so that the camera sees the picture undistorted in the mirror that stands on "
        "it.\n\n"
        "picture: an Image or a file. page: the flat object, by name.\n"
        "paper: \"A4\", \"letter\", \"WxH\" in millimetres..., turned as the page lies and centred on it; "
        "None: the "
        "page's size.\n"
        "dpi: dots per inch. unit: of the scene: \"mm\", \"cm\", \"dm\", \"m\", \"km\", \"in\" or \"ft\".\n"
        "bleed: millimetres by which the picture's rim is drawn on.\n"
        "window: (x0, y0, x1, y1) on the film where the picture is to be seen; None: the largest that fits.\n"
        "optic, camera: by name; None: all mirrors, the scene's own camera.\n"
        "verify: ray trace the scene with the page in it, and compare.\n"
        "file: .pdf, .svg or .png at true scale.\n"
        "progress: called as progress(done, job); returning False raises Interrupted.\n"
        "Returns a dict: page (height, width, 3), float32, linear; paper (width, height in millimetres); "
        "window; "
        "coverage (share of\nthe window that shows the page over a mirror); conflict (share that shows "
        "places of the "
        "page seen larger elsewhere);\nextents (x0, y0, x1, y1 of what is printed, millimetres from the "
        "lower left); "
        "psnr_db and seen (an Image), None unless\nverified.\n"
        "Raises UsageError for what the scene does not have and unknown names, InputError where the page is "
        "not flat or "
        "is not\nseen, OutputError.");
}

}  // namespace

void bind_unwrap(RendererClass& renderer, py::module_& module) {
    bind_unwrap_itself(renderer);
    bind_map(renderer);
    bind_caustic(renderer);
    bind_anamorph(module);
}

}  // namespace trilens::python
