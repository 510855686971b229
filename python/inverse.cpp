// Inverse problems: parameters from correspondences, and mirrors for a wanted map.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "arrays.h"
#include "python_call.h"

namespace trilens::python {
namespace {

py::array_t<double> matrix_array(const std::vector<std::vector<double>>& rows) {
    std::vector<double> values;
    for (const std::vector<double>& row : rows) values.insert(values.end(), row.begin(), row.end());
    const auto count = static_cast<py::ssize_t>(rows.size());
    const auto columns = rows.empty() ? py::ssize_t{0} : static_cast<py::ssize_t>(rows[0].size());
    return array_of(std::move(values), {count, columns});
}

/// A fit with the scene that it found.
struct PythonFit : FitResult {
    Scene scene;
};

struct FitArguments {
    std::vector<Correspondence> pairs;
    FitRequest request;
};

std::vector<Correspondence> pairs_of(const Doubles& pixels, const Doubles& points, const py::object& sigma,
                                     const py::object& camera) {
    const std::array<py::ssize_t, 2> shape{-1, 2};
    require_shape(pixels, shape, "pixels");
    const std::vector<Vec3> world = points_of(points, "points");
    if (static_cast<std::size_t>(pixels.shape(0)) != world.size())
        throw UsageError("there are " + std::to_string(pixels.shape(0)) + " pixels for " +
                         std::to_string(world.size()) + " points");
    const auto at = pixels.unchecked<2>();
    std::vector<Correspondence> pairs(world.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        pairs[i].pixel = {at(static_cast<py::ssize_t>(i), 0), at(static_cast<py::ssize_t>(i), 1)};
        pairs[i].point = world[i];
    }
    if (py::isinstance<py::str>(camera)) {
        for (Correspondence& pair : pairs) pair.camera = camera.cast<std::string>();
    } else if (!camera.is_none()) {
        const auto names = camera.cast<std::vector<std::string>>();
        if (names.size() != pairs.size()) throw UsageError("camera is one name, or one for each pair");
        for (std::size_t i = 0; i < pairs.size(); ++i) pairs[i].camera = names[i];
    }
    if (!sigma.is_none() && !py::isinstance<py::float_>(sigma) && !py::isinstance<py::int_>(sigma)) {
        const auto each = sigma.cast<std::vector<double>>();
        if (each.size() != pairs.size()) throw UsageError("sigma is one number, or one for each pair");
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            if (!(each[i] > 0)) throw UsageError("sigma is above 0");
            pairs[i].sigma = each[i];
        }
    }
    return pairs;
}

std::vector<PriorValue> priors_of(const py::dict& priors) {
    std::vector<PriorValue> values;
    for (const auto& [pointer, value] : priors) {
        const auto pair = value.cast<py::sequence>();
        if (pair.size() != 2) throw UsageError("a prior is (value, sigma)");
        PriorValue prior;
        prior.pointer = pointer.cast<std::string>();
        const py::object middle = pair[0];
        prior.values = py::isinstance<py::float_>(middle) || py::isinstance<py::int_>(middle)
                           ? std::vector<double>{middle.cast<double>()}
                           : middle.cast<std::vector<double>>();
        prior.sigma = pair[1].cast<double>();
        values.push_back(std::move(prior));
    }
    return values;
}

PythonFit fit(const Scene& scene, const FitArguments& arguments, PythonCall& call) {
    return call.run([&] {
        PythonFit found;
        static_cast<FitResult&>(found) =
            fit_scene(scene, arguments.pairs, arguments.request, call.progress("fit"));
        found.scene = parse_scene(found.document, scene.folder, {}, "fitted");
        call.tell_all(found.warnings);
        return found;
    });
}

FitMatch match_of(const std::string& name) {
    if (name == "ray") return FitMatch::kRay;
    if (name == "nearest") return FitMatch::kNearest;
    throw UsageError("match is \"ray\" or \"nearest\", not \"" + name + "\"");
}

void bind_fit(py::module_& module) {
    py::class_<FittedParameter> parameter(module, "FittedParameter", "A free number of a fit.");
    bind_fields(parameter, field("pointer", &FittedParameter::pointer, "Its JSON pointer."),
                field("start", &FittedParameter::start, "Before the fit; 0 of a turn."),
                field("value", &FittedParameter::value, "After it; of a turn degrees about the axis."),
                field("sigma", &FittedParameter::sigma, "Standard deviation; 0 where nothing fixes it."));
    py::class_<PythonFit>(module, "FitResult", "What a fit found.")
        .def_readonly("scene", &PythonFit::scene, "The scene with what was found.")
        .def_property_readonly(
            "parameters", [](const PythonFit& self) { return self.parameters; }, "FittedParameter, in order.")
        .def_property_readonly(
            "values",
            [](const PythonFit& self) {
                py::dict values;
                for (const FittedParameter& one : self.parameters) values[one.pointer.c_str()] = one.value;
                return values;
            },
            "Value by pointer.")
        .def_property_readonly(
            "covariance", [](const PythonFit& self) { return matrix_array(self.covariance); },
            "(P, P), of parameters in their units, from the pairs' sigmas.")
        .def_property_readonly(
            "correlation", [](const PythonFit& self) { return matrix_array(self.correlation); },
            "(P, P), -1..1.")
        .def_property_readonly(
            "residuals",
            [](const PythonFit& self) {
                std::vector<double> values;
                for (const FittedPair& pair : self.pairs)
                    values.insert(values.end(), {pair.residual.x, pair.residual.y});
                return array_of(std::move(values), {static_cast<py::ssize_t>(self.pairs.size()), 2});
            },
            "(N, 2), pixels: image of the point minus pixel; NaN where lost.")
        .def_property_readonly(
            "states",
            [](const PythonFit& self) {
                std::vector<std::string> states;
                for (const FittedPair& pair : self.pairs) states.emplace_back(pair_state_name(pair.state));
                return states;
            },
            "Of each pair: \"used\", \"lost\" or \"outlier\".")
        .def_property_readonly(
            "rms", [](const PythonFit& self) { return self.rms; },
            "Pixels: root of the mean squared length of residuals, of pairs that are not lost.")
        .def_property_readonly(
            "rms_start", [](const PythonFit& self) { return self.rms_start; },
            "The same where the fit began.")
        .def_property_readonly(
            "noise", [](const PythonFit& self) { return self.noise; },
            "Pixels in x and in y that residuals show, whatever sigma says; robust. 0: too few.")
        .def_property_readonly(
            "iterations", [](const PythonFit& self) { return self.iterations; }, "Steps taken.")
        .def_property_readonly(
            "converged", [](const PythonFit& self) { return self.converged; }, "Whether it came to rest.")
        .def_property_readonly(
            "rank", [](const PythonFit& self) { return self.rank; },
            "How many directions of parameters the pairs fix.")
        .def_property_readonly(
            "undetermined", [](const PythonFit& self) { return self.undetermined; },
            "Motions that no pair tells of, in words.")
        .def_property_readonly(
            "null_vectors", [](const PythonFit& self) { return matrix_array(self.null_vectors); },
            "(K, P): the same as unit vectors of parameters in large steps.")
        .def_property_readonly(
            "warnings", [](const PythonFit& self) { return self.warnings; },
            "Of correlated parameters and lost pairs.");
    module.def(
        "fit",
        [](const Scene& scene, const Doubles& pixels, const Doubles& points,
           const std::vector<std::string>& free, const py::object& sigma, double huber,
           const py::dict& priors, const std::string& path, const std::string& match,
           const py::object& camera, int max_iterations, const py::object& progress, const py::object& warn) {
            FitArguments arguments{pairs_of(pixels, points, sigma, camera), {}};
            FitRequest& request = arguments.request;
            request.free = free;
            if (py::isinstance<py::float_>(sigma) || py::isinstance<py::int_>(sigma))
                request.sigma = sigma.cast<double>();
            request.huber = huber;
            request.priors = priors_of(priors);
            request.path = path;
            request.match = match_of(match);
            if (max_iterations < 1) throw UsageError("max_iterations is 1 or more");
            request.most_iterations = max_iterations;
            PythonCall call(progress, warn);
            return fit(scene, arguments, call);
        },
        py::arg("scene"), py::arg("pixels"), py::arg("points"), py::arg("free"), py::kw_only(),
        py::arg("sigma") = 0.5, py::arg("huber") = 8.0, py::arg("priors") = py::dict(), py::arg("path") = "",
        py::arg("match") = "ray", py::arg("camera") = py::none(), py::arg("max_iterations") = 100,
        py::arg("progress") = py::none(), py::arg("warn") = py::none(),
        "Parameters of a scene from pixels and the world points that are seen there, over mirrors and "
        "through\n"
        "glass: Levenberg and Marquardt's method on the points' exact images.\n\n"
        "pixels: (N, 2), from the film's top left, a pixel's centre at .5. points: (N, 3), world frame.\n"
        "free: JSON pointers of numbers or arrays of numbers of cameras, optics and materials; a mesh's\n"
        "  quaternion transform/rotate is three turns about the world's axes, in degrees.\n"
        "sigma: standard deviation of the pixels, one or N.\n"
        "huber: sigmas of its pair from which a residual counts linearly; inf: never.\n"
        "priors: {pointer: (value, sigma)} that hold free numbers near values.\n"
        "path: what happens at the optics that a ray meets: \"R\", \"TT\", \"R?\"; \"D\": seen directly;\n"
        "  \"\": mirrors reflect, glass transmits.\n"
        "match: \"ray\" follows the pixels' rays; \"nearest\" begins with the point's image nearest to its "
        "pixel.\n"
        "camera: name of one or of N; None: the scene's own.\n"
        "warn: called with each of the result's warnings; None: the warnings module tells "
        "(TrilensWarning).\n"
        "Raises InputError for pointers that name no number and too few pairs, UsageError for shapes, names "
        "and\n"
        "paths that there are not, ComputationError where every pair is lost.");
}

/// A design with the wish that it is of.
struct PythonDesign : Design {
    DesignWish wish;
};

py::dict errors_dict(const DesignErrors& errors) {
    py::dict values;
    values["mean"] = errors.mean, values["p95"] = errors.p95, values["max"] = errors.max;
    return values;
}

py::array_t<double> map_array(const PatchMap& map) {
    return array_of(std::vector<double>(map.values), {map.rows, map.columns});
}

/// A wish from a dict of a wish file's form; `target` takes the place of its map.
DesignWish wish_of(const py::object& given, const py::object& target, bool directions) {
    py::object json = py::module_::import("json");
    py::dict dict = given.cast<py::dict>().attr("copy")().cast<py::dict>();
    if (target.is_none()) return parse_wish(json.attr("dumps")(dict).cast<std::string>(), "wish", "");
    if (dict.contains("wish")) throw UsageError("a wish has either its own map or a target");
    // Read with a plane that every eye may ask for, whose place the target then takes.
    py::dict plane;
    plane["type"] = "plane";
    const py::dict patch = dict["patch"].cast<py::dict>();
    const auto center = patch["center"].cast<std::array<double, 3>>(),
               normal = patch["normal"].cast<std::array<double, 3>>(),
               tangent = patch["tangent"].cast<std::array<double, 3>>();
    const Vec3 up = cross(vec3(normal), vec3(tangent));
    plane["origin"] = tuple_of(vec3(center) + (dict.contains("lens") ? -1e3 : 1e3) * vec3(normal));
    plane["u"] = tuple_of(vec3(tangent));
    plane["v"] = tuple_of(up);
    dict["wish"] = plane;
    dict["version"] = 1;
    DesignWish wish = parse_wish(json.attr("dumps")(dict).cast<std::string>(), "wish", "");
    const Doubles values = target.cast<Doubles>();
    const std::array<py::ssize_t, 3> shape{-1, -1, 3};
    require_shape(values, shape, "target");
    wish.wish = {};
    wish.wish.type = WishType::kMap;
    wish.wish.is_directions = directions;
    wish.wish.rows = static_cast<int>(values.shape(0)), wish.wish.columns = static_cast<int>(values.shape(1));
    const auto at = values.unchecked<3>();
    for (py::ssize_t row = 0; row < values.shape(0); ++row)
        for (py::ssize_t column = 0; column < values.shape(1); ++column)
            wish.wish.values.emplace_back(at(row, column, 0), at(row, column, 1), at(row, column, 2));
    check_wish(wish);
    return wish;
}

void bind_design(py::module_& module) {
    py::class_<PythonDesign>(module, "Design",
                             "A freeform mirror or lens, and how near it comes to its wish.")
        .def_property_readonly(
            "errors", [](const PythonDesign& self) { return errors_dict(self.errors); },
            "{\"mean\", \"p95\", \"max\"}: degrees between leaving and wished rays.")
        .def_property_readonly(
            "sphere",
            [](const PythonDesign& self) -> py::object {
                if (!self.sphere) return py::none();
                py::dict values = errors_dict(self.sphere->errors);
                values["radius"] = self.sphere->radius;
                return py::object(values);
            },
            "The same of the best sphere with its \"radius\" (positive: convex); None where it was not asked "
            "for.")
        .def_property_readonly(
            "curl", [](const PythonDesign& self) { return self.curl; },
            "Rms of what no mirror or lens can do, 1 / length: 0 where the wish is some one's.")
        .def_property_readonly(
            "curl_flat", [](const PythonDesign& self) { return self.curl_flat; },
            "The same over the flat rectangle.")
        .def_property_readonly(
            "curl_map", [](const PythonDesign& self) { return map_array(self.curl_map); },
            "(rows, columns) of samples, from below.")
        .def_property_readonly(
            "error_map", [](const PythonDesign& self) { return map_array(self.error_map); },
            "(rows, columns) of samples, from below: degrees.")
        .def_property_readonly(
            "sag", [](const PythonDesign& self) { return self.sag; }, "Highest minus lowest point.")
        .def_property_readonly(
            "smallest_radius", [](const PythonDesign& self) { return self.smallest_radius; }, "Of curvature.")
        .def_property_readonly(
            "iterations", [](const PythonDesign& self) { return self.iterations; }, "Of the solver.")
        .def_property_readonly(
            "converged", [](const PythonDesign& self) { return self.converged; }, "Whether it came to rest.")
        .def_property_readonly(
            "warnings", [](const PythonDesign& self) { return self.warnings; },
            "Of what no mirror or lens does.")
        .def_property_readonly(
            "heights",
            [](const PythonDesign& self) {
                return array_of(std::vector<double>(self.surface.heights),
                                {self.surface.controls[1], self.surface.controls[0]});
            },
            "(rows, columns): heights of the B-spline's control points over the rectangle.")
        .def(
            "height",
            [](const PythonDesign& self, double x, double y) {
                return self.surface.height({x, y}).z;
            },
            py::arg("x"), py::arg("y"),
            "The surface's height over a place of its rectangle, from its middle.")
        .def_property_readonly(
            "scene",
            [](const PythonDesign& self) {
                return parse_scene(design_scene(self.wish, self), "", {}, optic_word(self.wish));
            },
            "The mirror or lens with the eye as camera, and the wished plane.")
        .def(
            "to_json", [](const PythonDesign& self) { return design_scene(self.wish, self); },
            "That scene as JSON text.")
        .def(
            "save_stl",
            [](const PythonDesign& self, const std::filesystem::path& file, double thickness) {
                const double side = std::max(self.wish.patch.size.x, self.wish.patch.size.y);
                const std::string bytes = design_stl(self, thickness > 0 ? thickness : side / 20);
                replace_file(file.string(),
                             std::span(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
            },
            py::arg("file"), py::arg("thickness") = 0.0,
            "A closed body, binary STL; thickness: of a mirror behind its lowest point, 0: a twentieth of "
            "its longer side.")
        .def(
            "save_obj",
            [](const PythonDesign& self, const std::filesystem::path& file) {
                replace_text_file(file.string(), design_obj(self));
            },
            py::arg("file"), "The designed surface as polygons with normals, Wavefront OBJ.")
        .def(
            "save_sag",
            [](const PythonDesign& self, const std::filesystem::path& file) {
                replace_text_file(file.string(), design_sag_table(self));
            },
            py::arg("file"), "A table x,y,z,nx,ny,nz.");
    module.def(
        "design_mirror",
        [](const py::object& wish, const py::object& target, bool directions, bool compare_sphere,
           const std::string& method, int max_iterations, const py::object& progress,
           const py::object& warn) {
            if (method != "gauss-newton" && method != "picard")
                throw UsageError("method is \"gauss-newton\" or \"picard\", not \"" + method + "\"");
            if (max_iterations < 1) throw UsageError("max_iterations is 1 or more");
            const bool is_file = !py::isinstance<py::dict>(wish);
            if (is_file && !target.is_none()) throw UsageError("a target goes with a wish as a dict");
            PythonDesign made;
            made.wish = is_file ? read_wish(wish.cast<std::filesystem::path>().string())
                                : wish_of(wish, target, directions);
            const DesignRequest request{
                method == "picard" ? DesignMethod::kPicard : DesignMethod::kGaussNewton, compare_sphere,
                max_iterations};
            PythonCall call(progress, warn);
            static_cast<Design&>(made) = call.run([&] {
                Design found = design_mirror(made.wish, request, call.progress("design"));
                call.tell_all(found.warnings);
                return found;
            });
            return made;
        },
        py::arg("wish"), py::arg("target") = py::none(), py::kw_only(), py::arg("directions") = false,
        py::arg("compare_sphere") = false, py::arg("method") = "gauss-newton", py::arg("max_iterations") = 20,
        py::arg("progress") = py::none(), py::arg("warn") = py::none(),
        "The freeform mirror whose reflections come nearest to a wish, or where the wish has \"lens\" the\n"
        "front of a lens.\n\n"
        "wish: a wish file, or a dict of the same form (wish_schema).\n"
        "target: (rows, columns, 3) instead of the dict's \"wish\": what is to be seen over the mirror as "
        "the eye\n"
        "  sees it, rows from below, the first and last at its rims: world points, or with `directions` "
        "directions.\n"
        "compare_sphere: find the best sphere too.\n"
        "warn: called with each of the design's warnings; None: the warnings module tells "
        "(TrilensWarning).\n"
        "method: \"gauss-newton\" on the rays that leave, or \"picard\", linear on slopes.\n"
        "Raises InputError for wishes that no mirror or lens can have, ComputationError where no surface is "
        "found.");
    module.def(
        "wish_schema", [] { return py::module_::import("json").attr("loads")(wish_schema()); },
        "The JSON Schema (draft 7) of wish files, as a dict.");
    module.def(
        "wish_example", [] { return py::module_::import("json").attr("loads")(wish_example()); },
        "A wish to start from, as a dict: a driver's mirror.");
}

}  // namespace

void bind_inverse(py::module_& module) {
    bind_fit(module);
    bind_design(module);
}

}  // namespace trilens::python
