#include "bench/race/print_race.h"

#include <nlohmann/json.hpp>

#include "base/util/format.h"

namespace trilens_bench {

using namespace trilens;
namespace {

nlohmann::ordered_json fields(const BenchResult& bench) {
    const RaceResult& r = bench.race;
    return {{"pixels", r.pixels},
            {"facets", r.facets},
            {"triangles", r.triangles},
            {"depth_complexity", r.depth_complexity},
            {"rays", bench.direct ? "direct" : "optics"},
            {"threads", r.threads},
            {"isa", r.projector_isa},
            {"surface_ms", bench.surface_ms},
            {"rays_ms", bench.rays_ms},
            {"shade_ms", bench.shade_ms},
            {"projector",
             {{"prepare_ms", r.prepare_ms},
              {"samples_ms", r.samples_ms},
              {"visible_ms", r.visible_ms},
              {"written_ms", r.written_ms},
              {"whole_ms", r.whole_ms},
              {"shared", r.shared},
              {"ambiguous", r.ambiguous},
              {"unbounded", r.unbounded}}},
            {"embree",
             {{"build_ms", r.build_ms},
              {"rays_ms", r.rays_ms},
              {"trace_ms", r.trace_ms},
              {"written_ms", r.trace_written_ms},
              {"configuration", r.embree_configuration},
              {"rays_at_once", r.rays_at_once}}},
            {"ratio",
             {{"visible", r.ratio.visible},
              {"written", r.ratio.written},
              {"written_low", r.slowest_ratio},
              {"written_high", r.fastest_ratio},
              {"with_build", r.ratio.with_build},
              {"whole", r.ratio.whole}}},
            {"mismatch_pixels", r.mismatches.pixels},
            {"mismatch",
             {{"edge", r.mismatches.edge},
              {"depth", r.mismatches.depth},
              {"unexplained", r.mismatches.unexplained}}}};
}

std::string line(const std::string& phase, double projector, double embree) {
    return fmt::format("{:<34} {:>10.3f} {:>10.3f} {:>7.2f}\n", phase, projector, embree, embree / projector);
}

std::string text(const BenchResult& bench) {
    const RaceResult& r = bench.race;
    std::string text = fmt::format(
        "{} pixels through {} facets, {} rays; {} triangles in {:.1f} layers; {} thread{}, {}\n"
        "Embree: {}, packets of {}, coherent, triangles and rays in float\n"
        "medians: surfaces {:.1f} ms, corner rays {:.1f} ms, shading of all samples {:.1f} ms\n\n",
        r.pixels, r.facets, bench.direct ? "the camera's own" : "the optics'", r.triangles,
        r.depth_complexity, r.threads, r.threads == 1 ? "" : "s", r.projector_isa, r.embree_configuration,
        r.rays_at_once, bench.surface_ms, bench.rays_ms, bench.shade_ms);
    text += fmt::format("{:<34} {:>10} {:>10} {:>7}\n", "medians, ms", "projector", "Embree", "ratio");
    text += line("tree", r.prepare_ms, r.build_ms);
    text += line("samples in vectors, rays in packets", r.samples_ms, r.rays_ms);
    text += line("triangles seen, t within bounds", r.visible_ms, r.trace_ms);
    text +=
        fmt::format("{:<34} {:>10.3f} {:>10.3f} {:>7.2f}  ({:.2f} to {:.2f})\n", "hits written per sample",
                    r.written_ms, r.trace_written_ms, r.ratio.written, r.slowest_ratio, r.fastest_ratio);
    text += line("samples, rays and hits per sample", r.whole_ms, r.rays_ms + r.trace_written_ms);
    text += fmt::format("with both trees {:.2f}, with samples, rays and trees {:.2f} times Embree's speed\n",
                        r.ratio.with_build, r.ratio.whole);
    text += fmt::format(
        "of the pixels {:.1f} % lie in vectors that facets share, {:.2f} % were decided exactly, {:.2f} % "
        "one by one\n",
        100 * r.shared, 100 * r.ambiguous, 100 * r.unbounded);
    text += fmt::format(
        "{} pixels differ: {} within a thousandth of an edge, {} at one depth to a thousandth, {} otherwise",
        r.mismatches.pixels, r.mismatches.edge, r.mismatches.depth, r.mismatches.unexplained);
    return text;
}

}  // namespace

std::string race_json(const BenchResult& bench) {
    nlohmann::ordered_json json = fields(bench);
    json["schema"] = "trilens.bench/1";
    return json.dump(2) + "\n";
}

std::string race_text(const BenchResult& bench) {
    return text(bench) + "\n";
}

}  // namespace trilens_bench
