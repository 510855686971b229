// Two images compared: metrics, verdict, displacement, difference.
#include <pybind11/stl.h>

#include "arrays.h"
#include "bindings.h"
#include "python_call.h"

namespace trilens::python {
namespace {

using HeldPointer = std::shared_ptr<HeldImage>;

/// Everything that compare() finds, with the images it was found in.
struct ImageComparison {
    HeldPointer reference, test;
    CompareOptions options;
    Comparison comparison;
    std::vector<LayerComparison> layers;
};

const char* verdict_name(Verdict verdict) {
    return verdict == Verdict::kFailure ? "failure" : verdict == Verdict::kWarning ? "warning" : "pass";
}

HeldImage difference(const ImageComparison& self) {
    const DifferenceOptions options{self.options.layer, self.options.mask_object};
    return {PythonCall().run([&] {
                Image image = make_difference(self.reference->image, self.test->image, options);
                add_shifts(self.layers, image);
                return image;
            }),
            {}};
}

py::dict layers_of(const py::object& self) {
    py::dict layers;
    for (const LayerComparison& layer : self.cast<const ImageComparison&>().layers)
        layers[py::str(layer.layer)] = py::cast(layer, py::return_value_policy::reference_internal, self);
    return layers;
}

/// A per-pixel list of a displacement, in the window's shape.
template <class Value>
py::array per_pixel(const std::vector<Value>& values, const Image& image, const py::object& owner) {
    using Number = std::conditional_t<std::is_enum_v<Value>, std::uint8_t, Value>;
    static_assert(sizeof(Number) == sizeof(Value));
    return constant_view(reinterpret_cast<const Number*>(values.data()),
                         {{image.data_height, image.data_width},
                          {static_cast<py::ssize_t>(sizeof(Value)) * image.data_width, sizeof(Value)}},
                         owner);
}

py::object displacement_arrays(const py::object& self, const std::string& layer) {
    const ImageComparison& held = self.cast<const ImageComparison&>();
    for (const LayerComparison& one : held.layers) {
        if (one.layer != layer || !one.displacement) continue;
        const Image& image = held.test->image;
        py::dict arrays;
        arrays["state"] = per_pixel(one.displacement->state, image, self);
        arrays["shift_x"] = per_pixel(one.displacement->shift_x, image, self);
        arrays["shift_y"] = per_pixel(one.displacement->shift_y, image, self);
        return arrays;
    }
    throw py::key_error(layer);
}

void bind_metrics(py::module_& module) {
    py::class_<Metrics> metrics(module, "Metrics", "Errors over R, G and B of all compared pixels, peak 1.");
    std::apply([&](const auto&... one) { bind_fields(metrics, field(one.name, one.value, one.help)...); },
               kColourMetrics);
    py::class_<CompareCounts> counts(module, "Counts", "Counts of pixels.");
    bind_fields(
        counts, field("pixels", &CompareCounts::pixels, "Compared."),
        field("fail", &CompareCounts::fail, "Beyond fail and failrelative."),
        field("warn", &CompareCounts::warn, "Beyond warn."),
        field("hard", &CompareCounts::hard, "Beyond hardfail."),
        field("nan_ref", &CompareCounts::nan_ref, "With a NaN in any float channel of the reference."),
        field("nan_test", &CompareCounts::nan_test, "Likewise, of the test."),
        field("inf_ref", &CompareCounts::inf_ref, "With an infinity in any float channel of the reference."),
        field("inf_test", &CompareCounts::inf_test, "Likewise, of the test."),
        field("masked", &CompareCounts::masked, "Left out by the mask."));
    py::class_<WorstPixel> worst(module, "WorstPixel", "The largest finite difference.");
    bind_fields(worst, field("x", &WorstPixel::x, "Film pixel."), field("y", &WorstPixel::y, "Film pixel."),
                field("channel", &WorstPixel::channel, "Its name; empty where nothing differs."),
                field("ref", &WorstPixel::reference, "The reference's value."),
                field("test", &WorstPixel::test, "The test's value."));
}

/// A displacement's numbers, flat, as the command's JSON has them.
struct Moved {
    std::optional<double> mean, p50, p95, p99, max;
    std::size_t pixels = 0, lost = 0, unmeasured = 0, beyond_radius = 0, missing = 0;
    std::optional<double> coverage, mean_off_folds;
    std::size_t near_folds = 0;
};

Moved moved_of(const Displacement& d) {
    Moved moved;
    if (const auto& s = d.summary)
        moved.mean = s->mean, moved.p50 = s->p50, moved.p95 = s->p95, moved.p99 = s->p99, moved.max = s->max;
    moved.pixels = d.pixels, moved.lost = d.lost, moved.unmeasured = d.unmeasured;
    moved.beyond_radius = d.beyond_radius, moved.missing = d.missing;
    moved.coverage = d.coverage, moved.mean_off_folds = d.mean_off_folds;
    moved.near_folds = d.near_folds;
    return moved;
}

void bind_layers(py::module_& module) {
    py::class_<SeenMismatch> seen(module, "Seen", "Counts of pixels whose optic shows other things.");
    bind_fields(
        seen, field("pixels", &SeenMismatch::pixels, "At least one image sees something."),
        field("object_mismatch", &SeenMismatch::object_mismatch, "They see different objects."),
        field("primitive_mismatch", &SeenMismatch::primitive_mismatch, "Different triangles of one object."),
        field("coverage_mismatch", &SeenMismatch::coverage_mismatch,
              "One sees something, the other nothing."));
    py::class_<Moved> shift(
        module, "Displacement",
        "How far what the test's optics show lies from where the reference shows it: pixels. None where "
        "nothing "
        "was\n"
        "measured; what could not be measured is in no mean, so read each with coverage, lost, missing\n"
        "and unmeasured.");
    bind_fields(
        shift, field("mean", &Moved::mean, "Pixels."), field("p50", &Moved::p50, "Pixels."),
        field("p95", &Moved::p95, "Pixels."), field("p99", &Moved::p99, "Pixels."),
        field("max", &Moved::max, "Pixels."), field("pixels", &Moved::pixels, "How many pixels were found."),
        field("lost", &Moved::lost, "Pixels of the test whose point the reference does not show."),
        field("unmeasured", &Moved::unmeasured,
              "Pixels that show the same triangle in both, at a distance that nothing tells."),
        field("beyond_radius", &Moved::beyond_radius,
              "Those lost or unmeasured whose point it shows farther away than the radius."),
        field("missing", &Moved::missing, "Pixels of the reference whose point the test does not show."),
        field("coverage", &Moved::coverage, "Found pixels over those that show the layer, 0..1."),
        field("mean_off_folds", &Moved::mean_off_folds, "Mean away from folds of the reference, pixels."),
        field("near_folds", &Moved::near_folds, "Found pixels near such a fold."));
    py::class_<BoundCheck> bounds(
        module, "BoundCheck",
        "Proven bounds of displacement (the test's layer \"bound\") against what was "
        "measured.");
    bind_fields(bounds, field("pixels", &BoundCheck::pixels, "Pixels that were checked."),
                field("beyond", &BoundCheck::beyond, "Those displaced by more than their bound."),
                field("excess", &BoundCheck::excess, "The largest displacement less its bound, pixels."),
                field("tightness_p50", &BoundCheck::tightness_p50, "Median of bound over displacement."),
                field("tightness_max", &BoundCheck::tightness_max, "Largest of bound over displacement."));
    py::class_<LayerComparison>(module, "LayerComparison", "What one layer of both images shows.")
        .def_readonly("layer", &LayerComparison::layer, "\"reflect\", \"refract\" or \"direct\".")
        .def_readonly("seen", &LayerComparison::seen, "None where the images do not tell.")
        .def_readonly("bounds", &LayerComparison::bounds, "None where the test has no layer \"bound\".")
        .def_property_readonly(
            "displacement",
            [](const LayerComparison& self) {
                return self.displacement ? std::optional(moved_of(*self.displacement)) : std::nullopt;
            },
            "None where the images do not tell.");
}

void bind_comparison(py::module_& module) {
    py::class_<ImageComparison>(module, "Comparison", "How far two images are apart. It keeps both alive.")
        .def_property_readonly(
            "verdict", [](const ImageComparison& self) { return verdict_name(self.comparison.verdict); },
            "\"pass\", \"warning\" or \"failure\".")
        .def_property_readonly(
            "passed",
            [](const ImageComparison& self) { return self.comparison.verdict != Verdict::kFailure; },
            "Whether the verdict is no failure: where the command exits with 0.")
        .def_property_readonly(
            "reasons", [](const ImageComparison& self) { return self.comparison.reasons; },
            "One sentence for each rule that was broken.")
        .def_property_readonly(
            "metrics", [](const ImageComparison& self) -> const Metrics& { return self.comparison.metrics; })
        .def_property_readonly(
            "counts",
            [](const ImageComparison& self) -> const CompareCounts& { return self.comparison.counts; })
        .def_property_readonly(
            "worst", [](const ImageComparison& self) -> const WorstPixel& { return self.comparison.worst; })
        .def_property_readonly("layers", layers_of, "LayerComparison by layer: those the reference has.")
        .def_property_readonly(
            "seen", [](const ImageComparison& self) { return total_seen(self.layers); },
            "Sums over the layers.")
        .def_property_readonly(
            "displacement",
            [](const ImageComparison& self) {
                const Displacement total = total_displacement(self.layers, self.options.layer);
                return total.coverage ? std::optional(moved_of(total)) : std::nullopt;
            },
            "Of the layer that was asked for, or of all that show something together; None where none does.")
        .def("displacement_arrays", displacement_arrays, py::arg("layer"),
             "Of a layer, per pixel of the window (height, width), views without a copy: state (uint8: 0 "
             "nothing\n"
             "seen, 1 found, 2 lost, 3 unmeasured), shift_x and shift_y (float32, pixels, from the test's "
             "pixel to the "
             "place in\n"
             "the reference, x right and y down). Raises KeyError where it was not measured.")
        .def("difference", difference,
             "The difference as an image: R G B test - reference, abs.R G B, mask.M, flip.Y; of "
             "each layer\n"
             "that shows something <layer>.shift.X Y in pixels and <layer>.shift.M (1 found, -1 lost, "
             "-2 unmeasured, 0 nothing seen).")
        .def("__repr__", [](const ImageComparison& self) {
            return std::string("<trilens.Comparison ") + verdict_name(self.comparison.verdict) + ", rmse " +
                   shortest_text(self.comparison.metrics.rmse) + ">";
        });
}

ImageComparison compare_images(const HeldPointer& reference, const HeldPointer& test,
                               const CompareOptions& options, double radius) {
    if (!(radius >= 1 && radius <= 4096)) throw UsageError("the radius is 1 to 4096 pixels");
    return PythonCall().run([&] {
        ImageComparison result{reference, test, options, {}, {}};
        result.comparison = compare(reference->image, test->image, options);
        result.layers = compare_layers(reference->image, test->image, {radius, options.mask_object});
        return result;
    });
}

/// Throws UsageError for thresholds that are negative or NaN, and for percentages above 100.
CompareOptions checked(const CompareOptions& options) {
    const auto require = [](double value, double most, const char* name) {
        if (!(value >= 0 && value <= most)) throw UsageError(std::string(name) + " is out of range");
    };
    constexpr double kAny = std::numeric_limits<double>::infinity();
    require(options.fail, kAny, "fail");
    require(options.failrelative, kAny, "failrelative");
    require(options.failpercent, 100, "failpercent");
    require(options.hardfail, kAny, "hardfail");
    require(options.warn, kAny, "warn");
    require(options.warnpercent, 100, "warnpercent");
    return options;
}

}  // namespace

void bind_compare(py::module_& module) {
    bind_metrics(module);
    bind_layers(module);
    bind_comparison(module);
    const CompareOptions defaults;
    module.def(
        "compare",
        [](const HeldPointer& reference, const HeldPointer& test, const std::string& layer,
           std::optional<Id> mask_object, double fail, double failrelative, double failpercent,
           double hardfail, std::size_t allowfailures, double warn, double warnpercent, double radius) {
            return compare_images(reference, test,
                                  checked({layer, mask_object, fail, failrelative, failpercent, hardfail,
                                           allowfailures, warn, warnpercent}),
                                  radius);
        },
        py::arg("reference").none(false), py::arg("test").none(false), py::kw_only(), py::arg("layer") = "",
        py::arg("mask_object") = py::none(), py::arg("fail") = defaults.fail,
        py::arg("failrelative") = defaults.failrelative, py::arg("failpercent") = defaults.failpercent,
        py::arg("hardfail") = defaults.hardfail, py::arg("allowfailures") = defaults.allowfailures,
        py::arg("warn") = defaults.warn, py::arg("warnpercent") = defaults.warnpercent,
        py::arg("radius") = DisplacementOptions{}.radius,
        "How far two images are apart, pixel by pixel and in what their optics show; thresholds with idiff's "
        "names.\n\n"
        "layer: \"\" (the beauty), \"direct\", \"reflect\" or \"refract\".\n"
        "mask_object: only pixels whose optic.object is this id in either image.\n"
        "fail, hardfail, warn: absolute differences. failpercent, warnpercent: of the compared pixels.\n"
        "failrelative: a failing pixel also differs by this share. allowfailures: pixels that may differ by "
        "any.\n"
        "radius: how far displaced points are looked for, 1..4096 pixels.\n"
        "Raises InputError where the images cannot be compared, UsageError for thresholds out of range.");
}

}  // namespace trilens::python
