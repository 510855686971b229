// Radiosity baked into scenes.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>

#include "bindings.h"
#include "python_call.h"

namespace trilens::python {
namespace {

py::dict report_dict(const BakeReport& report) {
    py::dict power;
    const RadiosityBalance& balance = report.balance;
    power["emitted"] = tuple_of(balance.emitted);
    power["from_lights"] = tuple_of(balance.from_lights);
    power["absorbed"] = tuple_of(balance.absorbed);
    power["blocked"] = tuple_of(balance.blocked);
    power["escaped"] = tuple_of(balance.escaped);
    power["unshot"] = tuple_of(balance.unshot);
    py::list convergence;
    for (const RadiosityStep& step : report.convergence)
        convergence.append(py::make_tuple(step.rows, step.unshot));
    py::dict made;
    made["triangles"] = report.triangles;
    made["patches"] = report.patches;
    made["elements"] = report.elements;
    made["vertices"] = report.vertices;
    made["flat"] = report.flat;
    made["coarse"] = report.coarse;
    made["passes"] = report.passes;
    made["power"] = power;
    made["convergence"] = convergence;
    made["mean_difference"] = report.check.mean;
    made["most_difference"] = report.check.most;
    made["warnings"] = report.warnings;
    return made;
}

}  // namespace

void bind_bake(RendererClass& renderer) {
    const BakeRequest usual;
    renderer.def(
        "bake",
        [](const Renderer& self, const std::string& solver, const std::string& form_factors, int hemicube,
           int rays, double tolerance, double patch_size, double smallest_size, double contrast,
           std::size_t max_elements, bool keep_lights, const std::optional<std::filesystem::path>& file,
           const py::object& progress, const py::object& warn) {
            BakeRequest request;
            request.solver = require_named<RadiositySolver>("solver", solver);
            request.form_factors = require_named<FormFactorMethod>("kind of form factors", form_factors);
            request.hemicube_resolution = hemicube;
            request.rays = rays;
            request.tolerance = tolerance;
            request.patch_size = patch_size;
            request.smallest_size = smallest_size;
            request.contrast = contrast;
            request.most_elements = max_elements;
            request.keeps_lights = keep_lights;
            PythonCall call(progress, warn);
            Bake bake = call.run([&] {
                Bake made = bake_light(self, request, call.progress("bake"));
                if (file)
                    replace_text_file(
                        file->string(),
                        scene_document(made.scene, std::filesystem::absolute(*file).parent_path().string()));
                call.tell_all(made.report.warnings);
                return made;
            });
            return py::make_tuple(std::move(bake.scene), report_dict(bake.report));
        },
        py::kw_only(), py::arg("solver") = "progressive", py::arg("form_factors") = "hemicube",
        py::arg("hemicube") = usual.hemicube_resolution, py::arg("rays") = usual.rays,
        py::arg("tolerance") = usual.tolerance, py::arg("patch_size") = usual.patch_size,
        py::arg("smallest_size") = usual.smallest_size, py::arg("contrast") = usual.contrast,
        py::arg("max_elements") = usual.most_elements, py::arg("keep_lights") = false,
        py::arg("file") = py::none(), py::arg("progress") = py::none(), py::arg("warn") = py::none(),
        "Radiosity: the light that matt objects send to one another, at the corners of their triangles.\n\n"
        "solver: \"progressive\", the brightest patch shoots, or \"gauss-seidel\", all gather.\n"
        "form_factors: \"hemicube\", drawn, or \"rays\", traced: the truth.\n"
        "hemicube: pixels along an edge. rays: from each patch and vertex.\n"
        "tolerance: share of the power that may be left on its way.\n"
        "patch_size, smallest_size: longest edges of patches at most, and of elements that are not halved,\n"
        "as shares of the scene's diagonal.\n"
        "contrast: elements are halved where their light changes by more, in means over the scene.\n"
        "max_elements: halving stops before there are more.\n"
        "keep_lights: the lights go on shining; only what comes after is baked.\n"
        "file: the scene is written there, too: .json.\n"
        "progress: as in draw. warn: as in load_scene.\n"
        "Returns (scene, report): the Scene with its light, and a dict: triangles, patches, elements, "
        "vertices, "
        "flat, coarse, passes,\npower (emitted, from_lights, absorbed, blocked, escaped, unshot: three "
        "colours each), "
        "convergence (pairs of\nrows and the share unshot), mean_difference and most_difference of light by "
        "hemicubes and by rays, warnings.\n"
        "Raises UsageError for numbers out of range, InputError where nothing can be baked or nothing "
        "shines.");
}

}  // namespace trilens::python
