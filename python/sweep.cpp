// Sweeps over resolutions, their summaries, and fits.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <functional>
#include <variant>

#include "arrays.h"
#include "bindings.h"
#include "python_call.h"

namespace trilens::python {
namespace {

using SweepPath = std::filesystem::path;

/// A value as --over takes it: texts bare, numbers as they read back.
std::string value_text(const py::handle& value) {
    if (py::hasattr(value, "tolist")) return value_text(value.attr("tolist")());  // numpy's
    if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
    return py::str(value).cast<std::string>();
}

AxisRequest axis_of(const std::string& name, const py::handle& values) {
    AxisRequest request{name, {}};
    if (py::isinstance<py::str>(values))
        return {name, parse_over(name + "=" + values.cast<std::string>()).values};
    for (const py::handle value : values) request.values.push_back(value_text(value));
    return request;
}

/// Axes from a text ("resolution=1,2,4"), a dict of values by axis, a list of such texts, or resolutions.
std::vector<AxisRequest> axes_of(const py::object& over) {
    if (py::isinstance<py::str>(over)) return {parse_over(over.cast<std::string>())};
    std::vector<AxisRequest> axes;
    if (py::isinstance<py::dict>(over)) {
        for (const auto& [name, values] : over.cast<py::dict>())
            axes.push_back(axis_of(name.cast<std::string>(), values));
        return axes;
    }
    bool has_texts = false;
    for (const py::handle value : over) {
        has_texts |= py::isinstance<py::str>(value);
        if (py::isinstance<py::str>(value)) axes.push_back(parse_over(value.cast<std::string>()));
    }
    return has_texts ? axes : std::vector<AxisRequest>{axis_of("resolution", over)};
}

SweepObserver observer_of(PythonCall& call) {
    return {[&call](const std::string& job) { return call.progress(job); }, call.warner()};
}

const SweepFit* find_fit(const SweepSummary& summary, const std::string& metric, const std::string& layer,
                         const std::string& optic) {
    for (const SweepFit& fit : summary.fits)
        if (fit.metric == metric && fit.layer == layer && (optic.empty() || fit.optic == optic)) return &fit;
    return nullptr;
}

py::dict dict_of(const Coordinates& point) {
    py::dict values;
    for (const Coordinate& one : point) values[py::str(one.axis)] = one.value.text;
    return values;
}

void bind_fits(py::module_& module) {
    py::class_<SweepPoint> point(module, "SweepPoint", "One measurement of a fit.");
    bind_fields(point,
                field("n", &SweepPoint::n, "The resolution, or where the run stands along SweepFit.axis."),
                field("value", &SweepPoint::value, "The error."),
                field("used", &SweepPoint::used, "Whether it took part in the fit."));
    py::class_<SweepFit> fit(module, "SweepFit", "error = constant * n^-order over the runs of a sweep.");
    bind_fields(
        fit, field("metric", &SweepFit::metric, "The column's name in runs.csv."),
        field("layer", &SweepFit::layer, "\"reflect\", \"refract\"; \"\" for the whole picture."),
        field("optic", &SweepFit::optic, "Its name, or \"all\"."),
        field("axis", &SweepFit::axis, "The axis along which it is fitted."),
        field("order", &SweepFit::order, "None: fewer than two usable points."),
        field("order_low", &SweepFit::order_low, "95 % confidence; None: fewer than three points."),
        field("order_high", &SweepFit::order_high, "Likewise."),
        field("constant", &SweepFit::constant, "The error that the law gives at n = 1."),
        field("r2", &SweepFit::r2, "Of the line in log-log."),
        field("n_for_1px", &SweepFit::n_for_1px, "Resolution for an error of one pixel (metrics in pixels)."),
        field("n_for_half_px", &SweepFit::n_for_half_px, "Likewise, of half a pixel."),
        field("coverage", &SweepFit::coverage,
              "The least share of pixels that a run behind the law measured (metrics in pixels)."),
        field("points", &SweepFit::points, "Every finished run that has the metric."));
    fit.def_property_readonly(
        "group", [](const SweepFit& one) { return dict_of(one.group); },
        "What the runs have in common along the other axes: text by axis.");
    py::class_<Fit> law(module, "Fit", "error = constant * n^-order.");
    bind_fields(law, field("order", &Fit::order, "2: doubling n quarters the error."),
                field("constant", &Fit::constant, "The error at n = 1."),
                field("r2", &Fit::r2, "Of the line in log-log."),
                field("order_low", &Fit::order_low, "95 % confidence; None with two points."),
                field("order_high", &Fit::order_high, "Likewise."),
                field("used", &Fit::used, "Per point: whether it took part."),
                field("n_for_1", &Fit::n_for_1, "Smallest n for an error of 1; None where it does not fall."),
                field("n_for_half", &Fit::n_for_half, "Likewise, of 0.5."));
    module.def(
        "fit_power_law",
        [](const Doubles& n, const Doubles& errors, double floor, bool drop_plateau) {
            require_shape(n, std::array<py::ssize_t, 1>{-1}, "n");
            require_shape(errors, std::array<py::ssize_t, 1>{n.shape(0)}, "errors");
            std::vector<FitPoint> points;
            for (py::ssize_t i = 0; i < n.shape(0); ++i) points.push_back({n.at(i), errors.at(i)});
            return fit_power_law(points, {floor, drop_plateau});
        },
        py::arg("n"), py::arg("errors"), py::kw_only(), py::arg("floor") = 0.0,
        py::arg("drop_plateau") = false,
        "Least squares of log error over log n; n and errors: (N,). Errors at or below floor are left out;\n"
        "drop_plateau: and the finest runs over which the error hardly falls any more.\n"
        "None where fewer than two distinct n are left.");
}

void bind_summary(py::module_& module) {
    py::class_<OpticDisplacement> shift(module, "OpticDisplacement",
                                        "Displacement of one optic's layer in one run.");
    bind_fields(shift, field("layer", &OpticDisplacement::layer, "\"reflect\" or \"refract\"."),
                field("optic", &OpticDisplacement::optic, "Its name, or \"all\"."),
                field("metrics", &OpticDisplacement::metrics,
                      "Values by column name: pixels, counts of pixels, and disp_coverage, 0..1."));
    py::class_<RunRecord>(module, "SweepRun", "One run of a sweep.")
        .def_property_readonly(
            "n", [](const RunRecord& run) { return run.plan.n(); },
            "Its resolution; 0 where that is no axis.")
        .def_property_readonly(
            "id", [](const RunRecord& run) { return run.plan.id; }, "Its folder's name under runs/.")
        .def_property_readonly(
            "point", [](const RunRecord& run) { return dict_of(run.plan.at); }, "Its values: text by axis.")
        .def_property_readonly(
            "state", [](const RunRecord& run) { return state_name(run.state); },
            "\"done\", \"failed\" or \"missing\".")
        .def_readonly("metrics", &RunRecord::metrics, "Values by column name of runs.csv.")
        .def_readonly("displacement", &RunRecord::displacement)
        .def_readonly("warnings", &RunRecord::warnings)
        .def_readonly("error", &RunRecord::error, "Of a failed run.")
        .def("__repr__", [](const RunRecord& run) {
            return "<trilens.SweepRun " + point_text(run.plan.at) + ", " + state_name(run.state) + ">";
        });
    py::class_<SweepSummary>(module, "SweepSummary", "What a sweep's folder says.")
        .def_readonly("folder", &SweepSummary::folder)
        .def_property_readonly("title",
                               [](const SweepSummary& summary) { return summary.manifest.subject.title; })
        .def_readonly("runs", &SweepSummary::runs,
                      "In the order of the plan: the first axis changes slowest.")
        .def_readonly("fits", &SweepSummary::fits)
        .def_property_readonly(
            "left_out",
            [](const SweepSummary& summary) {
                std::vector<std::pair<std::string, std::string>> scenes;
                for (const LeftOutScene& one : summary.manifest.subject.left_out)
                    scenes.emplace_back(one.scene, one.reason);
                return scenes;
            },
            "Of an axis of scenes those that lack what another axis varies, each with the reason.")
        .def("fit", find_fit, py::arg("metric") = "disp_mean_px", py::arg("layer") = "reflect",
             py::arg("optic") = "", py::return_value_policy::reference_internal,
             "The fit of this metric, layer and optic (\"\": the first); None where there is none.")
        .def("__repr__", [](const SweepSummary& summary) {
            return "<trilens.SweepSummary '" + summary.manifest.subject.title + "', " +
                   std::to_string(summary.count(RunState::kDone)) + " of " +
                   std::to_string(summary.runs.size()) + " runs done>";
        });
}

using SceneOrFile = std::variant<SweepPath, std::reference_wrapper<const Scene>>;

void set_scene(const SceneOrFile& scene, const py::dict& overrides, SweepRequest& request) {
    if (const SweepPath* const file = std::get_if<SweepPath>(&scene)) {
        request.scene = {file->string(), overrides_of(overrides), 0};
        return;
    }
    if (!overrides.empty())
        throw UsageError("overrides are for scene files; Scene.with_overrides changes a scene in memory");
    request.loaded = std::get<1>(scene);
}

/// Binds run_sweep or plan_sweep: the same arguments, other work.
template <class Work>
void def_sweep(py::module_& module, const char* name, const Work& work, const char* doc) {
    module.def(
        name,
        [work](const SceneOrFile& scene, const SweepPath& folder, const py::object& over,
               const std::string& truth, const std::optional<std::string>& camera, const py::dict& overrides,
               const std::string& shard, const std::string& title, bool replace, bool zip, int jobs,
               int repeats, const py::object& progress, const py::object& warn) {
            SweepRequest request;
            set_scene(scene, overrides, request);
            request.camera = camera.value_or("");
            request.over = axes_of(over);
            request.zip = zip;
            request.jobs = jobs;
            request.repeats = repeats;
            request.truth = truth;
            request.shard = shard;
            request.folder = folder.string();
            request.title = title;
            request.replace = replace;
            PythonCall call(progress, warn);
            return call.run([&] { return work(request, observer_of(call)); });
        },
        py::arg("scene"), py::arg("folder"), py::arg("over") = "resolution=1..16:x2", py::kw_only(),
        py::arg("truth") = "limit", py::arg("camera") = py::none(), py::arg("overrides") = py::dict(),
        py::arg("shard") = "0/1", py::arg("title") = "", py::arg("replace") = false, py::arg("zip") = false,
        py::arg("jobs") = 1, py::arg("repeats") = 1, py::arg("progress") = py::none(),
        py::arg("warn") = py::none(), doc);
}

}  // namespace

void bind_sweep(py::module_& module) {
    bind_fits(module);
    bind_summary(module);
    def_sweep(
        module, "sweep",
        [](const SweepRequest& request, const SweepObserver& call) { return run_sweep(request, call); },
        "Renders, traces and compares over the optics' resolutions or any other axes, in a folder that can "
        "be "
        "resumed:\n"
        "what is done there already is not done again. Sums up with fits, tables, plots and report.html.\n\n"
        "scene: a scene file, or a Scene. folder: where the results go.\n"
        "over: resolutions as whole numbers; or axes as text, a list of texts, or a dict: "
        "\"resolution=1,2,4\",\n"
        "\"resolution=1..64:x2\", {\"engine\": [\"exact\", \"classic\"], \"/materials/0/ior\": [1.3, 1.5]}.\n"
        "zip: their values pair by pair, not in every combination. jobs: runs at once. repeats: measured\n"
        "drawings of each picture.\n"
        "truth: \"limit\" or \"facets\". shard: part \"i/n\" of it, or \"auto\" in a job array.\n"
        "replace: starts the folder afresh, whichever sweep it belongs to.\n"
        "progress: called as progress(done, job); returning False raises Interrupted. What is done is kept.\n"
        "camera, overrides, warn: as in load_scene and render.\n"
        "A Scene is known by its label; without one by all that it holds, so that a changed one is another\n"
        "sweep's and raises UsageError in the folder of the first.\n"
        "A run that fails is recorded (SweepRun.error), and the others go on. Raises UsageError for what is "
        "no "
        "axis,\ntruth or shard, InputError where a scene has no optic or cannot be read, OutputError.\n"
        "A scene file without an optic is swept over its camera's facets where the axis is resolution and "
        "the\ncamera chooses them, with a warning.");
    def_sweep(
        module, "plan_sweep",
        [](const SweepRequest& request, const SweepObserver& call) { return plan_sweep(request, call); },
        "Writes the plan of a sweep and runs nothing; returns the plan's file. Arguments: see sweep.");
    module.def(
        "load_sweep",
        [](const SweepPath& folder) { return PythonCall().run([&] { return load_sweep(folder.string()); }); },
        py::arg("folder"),
        "What a sweep's folder says, with fits; writes nothing. Raises InputError without a plan.");
    module.def(
        "report_sweep",
        [](const SweepPath& folder) {
            return PythonCall().run([&] { return report_sweep(folder.string()); });
        },
        py::arg("folder"), "The same, and writes tables, plots and report.html.");
}

}  // namespace trilens::python
