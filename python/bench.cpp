// The race of the projector against Embree.
#include <pybind11/stl.h>

#include <optional>

#include "bindings.h"
#include "talk.h"

namespace trilens::python {
namespace {

/// What bench() returns: the race, and what both sides have in common.
struct Race : RaceResult {
    bool direct = false;
    double surface_ms = 0, corner_rays_ms = 0, shade_ms = 0;
};

Race race_of(const BenchResult& result) {
    return {result.race, result.direct, result.surface_ms, result.rays_ms, result.shade_ms};
}

void bind_race(py::module_& module) {
    py::class_<RaceResult::Ratios> ratios(
        module, "RaceRatios", "Embree's time over the projector's: above 1 where the projector is faster.");
    bind_fields(ratios,
                field("visible", &RaceResult::Ratios::visible,
                      "What is seen left in order: triangles, and t within bounds."),
                field("draw", &RaceResult::Ratios::draw, "Hits left in order, rays and samples made before."),
                field("written", &RaceResult::Ratios::written, "Hits written per sample."),
                field("with_build", &RaceResult::Ratios::with_build, "Hits left in order, with both trees."),
                field("whole", &RaceResult::Ratios::whole, "Hits written, with trees, rays and samples."));
    py::class_<Mismatches> mismatches(module, "Mismatches",
                                      "Pixels in which the two see different triangles.");
    bind_fields(mismatches, field("pixels", &Mismatches::pixels, "All."),
                field("edge", &Mismatches::edge, "Both triangles are met within a thousandth of an edge."),
                field("depth", &Mismatches::depth, "Both at one depth to a thousandth."),
                field("unexplained", &Mismatches::unexplained, "The others."));
    py::class_<Race> race(module, "Race", "Medians over the rounds, milliseconds of wall time.");
    bind_fields(
        race, field("pixels", &RaceResult::pixels, "Samples whose rays were raced."),
        field("facets", &RaceResult::facets, "Facets with such samples."),
        field("triangles", &RaceResult::triangles, "Of the scene."),
        field("depth_complexity", &RaceResult::depth_complexity,
              "Depths at which a ray meets the scene, mean of some of the rays."),
        field("threads", &RaceResult::threads, "Of both sides."),
        field("isa", &RaceResult::projector_isa, "The projector's instruction set."),
        field("direct", &Race::direct,
              "The camera's own rays were raced, since it sees no optic; else those that leave the optics."),
        field("surface_ms", &Race::surface_ms, "Both: the optics' surfaces and the scene's triangles."),
        field("corner_rays_ms", &Race::corner_rays_ms,
              "Both: the camera's rays, the optics' grids and their corner rays up to the first optic."),
        field("shade_ms", &Race::shade_ms, "Both: colours of all samples of the film."),
        field("prepare_ms", &RaceResult::prepare_ms, "Projector: its tree."),
        field("samples_ms", &RaceResult::samples_ms, "Projector: samples in vectors."),
        field("visible_ms", &RaceResult::visible_ms,
              "Projector: triangles seen and bounds of t left in vectors' order."),
        field("draw_ms", &RaceResult::draw_ms, "Projector: hits left in vectors' order."),
        field("written_ms", &RaceResult::written_ms, "Projector: hits by sample."),
        field("whole_ms", &RaceResult::whole_ms, "Projector: hits by sample, vectors made while drawing."),
        field("shared", &RaceResult::shared,
              "Projector: share of the samples that lie in vectors with other facets' samples."),
        field("doubtful", &RaceResult::doubtful,
              "Projector: share of the samples that were decided exactly, where floats left doubt."),
        field("unbounded", &RaceResult::unbounded,
              "Projector: share of the samples that floats have no bounds for, drawn block by block."),
        field("build_ms", &RaceResult::build_ms, "Embree: its tree."),
        field("rays_ms", &RaceResult::rays_ms, "Embree: rays in packets."),
        field("trace_ms", &RaceResult::trace_ms, "Embree: hits left in packets' order."),
        field("trace_written_ms", &RaceResult::trace_written_ms, "Embree: hits by sample."),
        field("configuration", &RaceResult::embree_configuration, "What Embree was asked for."),
        field("ratio", &RaceResult::ratio, "Medians of each round's own ratio."),
        field("draw_low", &RaceResult::slowest_ratio, "The lowest ratio.draw of a round."),
        field("draw_high", &RaceResult::fastest_ratio, "The highest."),
        field("mismatches", &RaceResult::mismatches, "Against Embree's float triangles."));
}

}  // namespace

void bind_bench(py::module_& module) {
    bind_race(module);
    module.def(
        "bench",
        [](const Scene& scene, int resolution, const std::optional<std::string>& camera, int repeat,
           const std::string& isa, const py::object& warn) {
            Talk talk(py::none(), warn);
            BenchRequest request;
            request.frame.camera = find_camera(scene, camera.value_or(""));
            request.frame.resolution = resolution;
            request.race = {repeat, isa};
            const Warn warner = talk.warner();
            return talk.run([&] { return race_of(run_bench(scene, request, warner)); });
        },
        py::arg("scene"), py::kw_only(), py::arg("resolution") = 0, py::arg("camera") = py::none(),
        py::arg("repeat") = 9, py::arg("isa") = "", py::arg("warn") = py::none(),
        "The projector against Embree's packets on the same rays in the same run: those that leave the "
        "scene's optics, or the camera's own where it sees none. isa: \"avx512\", \"avx2\" or \"sse4.2\" "
        "for both sides; \"\": the best of this machine. repeat: rounds, at least 1. The others: see "
        "render.\n"
        "Raises as render does, and UsageError for an instruction set that this machine does not have.");
}

}  // namespace trilens::python
