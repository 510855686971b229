// trilens bench: the fields that scripts read.
#include <cstdlib>

#include "cli/command_line.h"
#include "support/test.h"

using namespace trilens_test;

namespace {

/// The number behind "name": at or after `from` in a JSON text; -1 where there is none.
double number_after(const std::string& json, const std::string& name, const std::string& from) {
    const std::size_t start = json.find("\"" + from + "\"");
    if (start == std::string::npos) return -1;
    const std::size_t at = json.find("\"" + name + "\":", start);
    return at == std::string::npos ? -1 : std::atof(json.c_str() + at + name.size() + 3);
}

}  // namespace

TEST_CASE("bench prints one object with both sides' times and their ratios", "[cli]") {
    const std::string folder = scratch_dir("cli_bench");
    const std::string scene = write_file(folder, "scene.json", small_scene());
    const CommandRun run = run_trilens("bench " + scene + " -n 4 --repeat 1 --threads 1 --json");
    REQUIRE(run.exit_code == 0);
    CHECK(run.out.find("\"schema\": \"trilens.bench/1\"") != std::string::npos);
    for (const char* count : {"pixels", "facets", "triangles"})
        CHECK(number_after(run.out, count, count) > 0);
    for (const char* time : {"prepare_ms", "visible_ms", "draw_ms"})
        CHECK(number_after(run.out, time, "projector") > 0);
    for (const char* share : {"shared", "doubtful", "unbounded"}) {
        CHECK(number_after(run.out, share, "projector") >= 0);
        CHECK(number_after(run.out, share, "projector") <= 1);
    }
    CHECK(number_after(run.out, "depth_complexity", "depth_complexity") > 0);
    for (const char* time : {"build_ms", "trace_ms"}) CHECK(number_after(run.out, time, "embree") > 0);
    for (const char* ratio : {"visible", "draw", "written", "with_build", "whole"})
        CHECK(number_after(run.out, ratio, "ratio") > 0);
    CHECK(number_after(run.out, "mismatch_pixels", "mismatch_pixels") >= 0);
    CHECK(number_after(run.out, "unexplained", "mismatch") == 0);
    CHECK(run.out.find("ignore_config_files=1") != std::string::npos);
}

TEST_CASE("bench refuses what it cannot do", "[cli]") {
    const std::string folder = scratch_dir("cli_bench");
    const std::string scene = write_file(folder, "scene.json", small_scene());
    CHECK(run_trilens("bench " + scene + " --isa mmx").exit_code == 2);
    CHECK(run_trilens("bench " + scene + " --repeat 0").exit_code == 2);
    CHECK(run_trilens("bench " + folder + "/nothing.json").exit_code == 3);
}
