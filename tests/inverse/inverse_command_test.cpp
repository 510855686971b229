// trilens fit and trilens design as users call them.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "cli/command_line.h"
#include "fit_scenes.h"
#include "support/test.h"
#include "terminal/libraries.h"

using namespace trilens_test;
namespace fs = std::filesystem;

namespace {

std::string pairs_text(std::size_t count) {
    std::string text = "x,y,X,Y,Z\n";
    char line[200];
    for (const trilens::Correspondence& pair : make_pairs(trilens::parse_scene(ball_scene()), count, "R")) {
        std::snprintf(line, sizeof line, "%.15g,%.15g,%.15g,%.15g,%.15g\n", pair.pixel.x, pair.pixel.y,
                      pair.point.x, pair.point.y, pair.point.z);
        text += line;
    }
    return text;
}

}  // namespace

TEST_CASE("trilens fit writes the fitted scene, its answer and its page, or says why not", "[cli][inverse]") {
    const std::string folder = scratch_dir("cli_fit");
    const std::string scene = write_file(folder, "ball.json", ball_scene());
    const std::string pairs = write_file(folder, "pairs.csv", pairs_text(20));
    const std::string call = "fit " + scene + " --points " + pairs + " -o " + folder + "/fitted.json ";
    const CommandRun good =
        run_trilens(call +
                    "--free /meshes/ball/primitive/center,/meshes/ball/primitive/radius --set "
                    "/meshes/0/primitive/radius=0.95 --json --report " +
                    folder + "/fit.html");
    REQUIRE(good.exit_code == 0);
    const auto answer = trilens::Json::parse(good.out);
    CHECK(answer["schema"] == "trilens.fit/1");
    CHECK(answer["rank"] == 4);
    CHECK(std::abs(answer["parameters"][3]["value"].get<double>() - 1) < 1e-8);
    CHECK(answer["pairs"].size() == 20);
    CHECK(run_trilens("scene validate " + folder + "/fitted.json").exit_code == 0);
    CHECK(bytes_of(folder + "/fit.html").find("Correlations") != std::string::npos);

    fs::remove(folder + "/fitted.json");
    const CommandRun loose =
        run_trilens(call + "--free /meshes/0/primitive/radius --free /meshes/0/resolution");
    CHECK(loose.exit_code == 5);
    CHECK(loose.err.find("do not tell of /meshes/0/resolution") != std::string::npos);
    const std::string two = write_file(folder, "two.csv", "x,y,X,Y,Z\n400,300,0,1,3\n");
    CHECK(run_trilens("fit " + scene + " --points " + two + " -o " + folder +
                      "/fitted.json --free /meshes/0/primitive/center")
              .exit_code == 3);
    const std::string beside = write_file(folder, "beside.csv", "1,1,0,1,3\n2,2,0,1,2\n1,3,1,1,2\n");
    const CommandRun lost = run_trilens("fit " + scene + " --points " + beside + " -o " + folder +
                                        "/fitted.json --free /meshes/0/primitive/center");
    CHECK(lost.exit_code == 5);
    CHECK(lost.err.find("every pair is lost") != std::string::npos);
    const std::string free = "--free /meshes/0/primitive/radius ";
    CHECK(run_trilens(call + free + "--loss cauchy").exit_code == 2);
    CHECK(run_trilens(call + free + "--path RX").exit_code == 2);
    CHECK(run_trilens(call + free + "--prior /meshes/0/primitive/radius=1").exit_code == 2);
    CHECK(run_trilens(call + free + "--prior /cameras/0/yfov=40+-1").exit_code == 3);
    CHECK_FALSE(fs::exists(folder + "/fitted.json"));
}

TEST_CASE("a fitted scene names its files from where it lies", "[cli][inverse]") {
    const std::string folder = scratch_dir("cli_fit_elsewhere");
    fs::create_directories(folder + "/given");
    fs::create_directories(folder + "/out/deep");
    write_file(folder, "wall.obj", "v -3 0 -4\nv 3 0 -4\nv 3 3 -4\nf 1 2 3\n");
    std::string json = ball_scene();
    json.replace(json.rfind("]}"), 2, R"(, {"name": "wall", "role": "object", "file": "../wall.obj"}]})");
    const std::string scene = write_file(folder + "/given", "scene.json", json);
    const std::string pairs = write_file(folder, "pairs.csv", pairs_text(20));
    const std::string fitted = folder + "/out/deep/fitted.json";
    REQUIRE(run_trilens("fit " + scene + " --points " + pairs + " --free /meshes/ball/primitive/radius -o " +
                        fitted)
                .exit_code == 0);
    CHECK(trilens::Json::parse(bytes_of(fitted))["meshes"][1]["file"] == "../../wall.obj");
    const CommandRun loaded = run_trilens("scene validate " + fitted);
    INFO(loaded.err);
    CHECK(loaded.exit_code == 0);
}

TEST_CASE("trilens design writes a scene that draws, and a closed body", "[cli][inverse]") {
    const std::string folder = scratch_dir("cli_design");
    const std::string wish = write_file(folder, "wish.json", run_trilens("design --example").out);
    const CommandRun made = run_trilens("design " + wish + " -o " + folder + "/mirror.json --sphere " +
                                        folder + "/sphere.json --stl " + folder + "/m.stl --obj " + folder +
                                        "/m.obj --sag " + folder + "/m.csv --json");
    REQUIRE(made.exit_code == 0);
    const auto answer = trilens::Json::parse(made.out);
    CHECK(answer["error_degrees"]["mean"].get<double>() <
          answer["sphere"]["error_degrees"]["mean"].get<double>());
    for (const char* scene : {"/mirror.json", "/sphere.json"})
        CHECK(run_trilens("render " + folder + scene + " --size 64x35 --spp 1 -o " + folder + "/m.png")
                  .exit_code == 0);
    CHECK(bytes_of(folder + "/m.csv").starts_with("x,y,z,nx,ny,nz\n"));
    CHECK(run_trilens("scene validate " + folder + "/mirror.json").exit_code == 0);

    // Every edge of a closed body is run along once each way.
    const std::string stl = bytes_of(folder + "/m.stl");
    std::uint32_t count = 0;
    std::memcpy(&count, stl.data() + 80, 4);
    REQUIRE(stl.size() == 84 + 50 * std::size_t{count});
    std::map<std::pair<std::string, std::string>, int> edges;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            ++edges[{stl.substr(84 + 50 * i + 12 + 12 * k, 12),
                     stl.substr(84 + 50 * i + 12 + 12 * ((k + 1) % 3), 12)}];
    bool closed = true;
    for (const auto& [edge, times] : edges)
        closed = closed && times == 1 && edges.count({edge.second, edge.first});
    CHECK(closed);

    const std::string lens = write_file(folder, "lens.json", R"({"version": 1, "eye": [0, 0, 0.5],
  "patch": {"center": [0, 0, 0], "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [0.2, 0.16], "controls": [8, 8]},
  "lens": {"ior": 1.5, "thickness": 0.05},
  "wish": {"type": "plane", "origin": [-0.1, -0.08, -0.6], "u": [0.2, 0, 0], "v": [0, 0.16, 0]}})");
    CHECK(
        run_trilens("design " + lens + " -o " + folder + "/body.json --stl " + folder + "/b.stl").exit_code ==
        0);
    CHECK(run_trilens("trace " + folder + "/body.json --size 32x26 --spp 1 -o " + folder + "/b.png")
              .exit_code == 0);
    CHECK(run_trilens("design " + lens + " -o " + folder + "/no.json --thickness 1").exit_code == 2);

    CHECK(run_trilens("design " + wish).exit_code == 2);
    const std::string bad = write_file(folder, "bad.json", "{\"version\": 1}");
    CHECK(run_trilens("design " + bad + " -o " + folder + "/no.json").exit_code == 3);
    CHECK(run_trilens("design " + wish + " -o " + wish).exit_code == 2);
    CHECK_FALSE(fs::exists(folder + "/no.json"));
}
