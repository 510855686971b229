// `trilens sweep` on real scenes: which truth each run has, and whose folder it is.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "support/test.h"

using namespace trilens_test;
namespace fs = std::filesystem;

namespace {

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    std::stringstream rest(line);
    for (std::string cell; std::getline(rest, cell, ',');) cells.push_back(cell);
    return cells;
}

/// One column of runs.csv, a value per run.
std::vector<double> column(const std::string& folder, const std::string& name) {
    std::stringstream lines(bytes_of(folder + "/runs.csv"));
    std::string line;
    std::getline(lines, line);
    const std::vector<std::string> header = cells_of(line);
    std::size_t at = 0;
    while (at < header.size() && header[at] != name) ++at;
    REQUIRE(at < header.size());
    std::vector<double> values;
    while (std::getline(lines, line)) values.push_back(std::atof(cells_of(line).at(at).c_str()));
    return values;
}

std::size_t truths_in(const std::string& folder) {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder + "/truth"))
        count += entry.path().extension() == ".exr";
    return count;
}

}  // namespace

TEST_CASE("the facets' truth is that of each run's own facets, and nothing is displaced", "[cli][sweep]") {
    const std::string folder = scratch_dir("cli_sweep_facets");
    const std::string scene = write_file(folder, "room.json", small_scene());
    const auto sweep = [&](const std::string& truth) {
        const std::string out = folder + "/" + truth;
        REQUIRE(run_trilens("sweep run " + scene + " --size 96x72 --over resolution=2,4,8 --truth " + truth +
                            " -o " + out)
                    .exit_code == 0);
        return out;
    };
    const std::string facets = sweep("facets"), limit = sweep("limit");
    CHECK(truths_in(facets) == 3);
    CHECK(truths_in(limit) == 1);
    for (const double mean : column(facets, "disp_mean_px")) CHECK(mean == 0);
    for (const double rmse : column(facets, "rgb_rmse")) CHECK(rmse < 1e-3);
    for (const double covered : column(facets, "disp_coverage")) CHECK(covered > 0.99);
    CHECK(column(limit, "disp_mean_px").front() > 0.1);
}

TEST_CASE("a script that is only shown removes no runs", "[cli][sweep][bad-input]") {
    const std::string folder = scratch_dir("cli_sweep_shown");
    const std::string scene = write_file(folder, "room.json", small_scene()), out = folder + "/out";
    const std::string words = scene + " --size 48x36 --over resolution=1,2 -o " + out;
    REQUIRE(run_trilens("sweep run " + words).exit_code == 0);
    const CommandRun refused = run_trilens("sweep submit " + words + " --print --replace");
    CHECK(refused.exit_code == 2);
    CHECK(refused.err.find("--replace would remove the runs") != std::string::npos);
    CHECK(run_trilens("sweep submit " + words + " --print").exit_code == 0);
    for (const char* run : {"n0001", "n0002"}) CHECK(fs::exists(out + "/runs/" + run + "/DONE"));
}

TEST_CASE("corner rays, grids and errors asked for are axes, against one truth", "[cli][sweep]") {
    const std::string folder = scratch_dir("cli_sweep_facet_axes");
    const std::string scene = write_file(folder, "room.json", small_scene());
    const auto means = [&](const std::string& name, const std::string& over) {
        const std::string out = folder + "/" + name;
        REQUIRE(run_trilens("sweep run " + scene + " --size 96x72 " + over + " -o " + out).exit_code == 0);
        CHECK(truths_in(out) == 1);
        return column(out, "disp_mean_px");
    };
    const std::vector<double> rays =
        means("rays", "--over rays=interpolated,fitted --over resolution=4 --set /render/maxDepth=3");
    REQUIRE(rays.size() == 2);
    CHECK(rays[1] < 0.6 * rays[0]);

    const std::vector<double> grids = means("grid", "--over grid=surface,screen --over resolution=4");
    REQUIRE(grids.size() == 2);
    CHECK((grids[0] > 0 && grids[1] > 0 && grids[0] != grids[1]));

    // Numbers stand in their order, whatever the order they were given in.
    const std::vector<double> errors = means("error", "--over max-error=4,0.25 --set /render/maxDepth=3");
    REQUIRE(errors.size() == 2);
    CHECK(errors[0] < errors[1]);
}

TEST_CASE("what a sweep sets and its scene cannot take is told as the sweep's mistake",
          "[cli][sweep][bad-input]") {
    const std::string folder = scratch_dir("cli_sweep_sets");
    const std::string scene = write_file(folder, "room.json", small_scene());
    const auto error_of = [&](const std::string& what) {
        const CommandRun run = run_trilens("sweep run " + what + " -o " + folder + "/out");
        CHECK(run.exit_code == 3);
        return run.err;
    };
    const std::string file = write_file(folder, "sweep.json", R"({ "scenes": ["room.json"],
        "over": [ {"axis": "resolution", "values": [1]} ], "set": {"/film/wdth": 64} })");
    CHECK(error_of(file).find(
              file + ": /set: /film/wdth: names nothing: unknown key 'wdth'; did you mean 'width'? (of " +
              scene + ")") != std::string::npos);
    CHECK(error_of(scene + " --over /film/width=a").find("error: --over: /film/width: expected an integer") !=
          std::string::npos);
    CHECK(error_of(scene + " --over resolution=1 --set /film/wdth=64")
              .find(scene + ": /film/wdth: names nothing") != std::string::npos);
}

TEST_CASE("a sweep's folder takes no other scene, and the same one from anywhere", "[cli][sweep]") {
    const std::string folder = scratch_dir("cli_sweep_owner");
    write_file(folder, "room.json", small_scene());
    write_file(folder, "other.json", replaced(small_scene(), "\"radius\": 1", "\"radius\": 0.8"));
    const auto sweep = [&](const std::string& scene, const std::string& options) {
        return run_trilens("sweep run " + scene + " -o " + folder + "/out " + options);
    };
    REQUIRE(sweep(folder + "/room.json", "--over resolution=1,2").exit_code == 0);
    const std::string table = bytes_of(folder + "/out/runs.csv");

    for (const std::string& other : {folder + "/other.json --over resolution=1,2",
                                     folder + "/room.json --over resolution=1,2 --size 40x30",
                                     folder + "/room.json --over resolution=1,2 --truth facets"}) {
        const CommandRun run = sweep(other, "");
        INFO(run.err);
        CHECK(run.exit_code == 2);
        CHECK(run.err.find("room.json") != std::string::npos);
        CHECK(run.err.find("--replace") != std::string::npos);
        CHECK(bytes_of(folder + "/out/runs.csv") == table);
    }
    // By another path, with another value: the same sweep.
    CHECK(sweep(folder + "/out/../room.json", "--over resolution=1,2,4").exit_code == 0);
    CHECK(column(folder + "/out", "n") == std::vector<double>{1, 2, 4});
    CHECK(sweep(folder + "/other.json", "--over resolution=1,2 --replace").exit_code == 0);
    CHECK(column(folder + "/out", "n") == std::vector<double>{1, 2});
    CHECK(sweep(folder + "/room.json", "--over resolution=1,2").exit_code == 2);
    // Several scenes make a gallery, which is no sweep.
    CHECK(sweep(folder + "/room.json " + folder + "/other.json", "--over resolution=1").exit_code == 2);
}

TEST_CASE("a camera's own facets are an axis: what it sees itself comes nearer with order 2",
          "[cli][sweep]") {
    const std::string folder = scratch_dir("cli_sweep_camera_facets");
    const auto scene_with = [&](const std::string& name, const std::string& camera) {
        return write_file(folder, name + ".json",
                          R"({ "version": 1, "film": { "width": 120, "height": 90 },
            "cameras": [ { "name": ")" +
                              name + "\", " + camera +
                              R"(, "lookAt": { "eye": [0.1, 0.2, 3], "at": [0, 0, 0] } } ],
            "materials": [ { "name": "red", "unlit": true } ],
            "meshes": [ { "name": "wall", "role": "object", "material": "red",
                "points": [[-90,-90,-1],[90,-90,-3],[90,90,-1],[-90,90,-1]],
                "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] } ] })");
    };
    const std::vector<std::pair<std::string, std::string>> cameras{
        {"fisheye", R"("type": "fisheye", "mapping": "equisolid", "fov": 150, "tolerance": 0.5)"},
        {"cylinder", R"("type": "cylindrical", "hfov": 160, "yfov": 75, "facets": 3)"},
        {"lens", R"("type": "opencv", "model": "pinhole", "fx": 110, "fy": 110, "cx": 60, "cy": 45,
                    "distortion": [-0.1, 0.02, 0, 0])"}};
    for (const auto& [name, camera] : cameras) {
        INFO(name);
        const std::string out = folder + "/" + name;
        // Along a circle's border facets are finer, however few there are, which large ones all reach.
        const std::string facets = name == "fisheye" ? "24..192:x2" : "6..48:x2";
        const CommandRun run = run_trilens("sweep run " + scene_with(name, camera) +
                                           " --over camera-facets=" + facets + " --json -o " + out);
        REQUIRE(run.exit_code == 0);
        const std::vector<double> error = column(out, "disp_mean_px");
        REQUIRE(error.size() == 4);
        REQUIRE(error.back() > 0);
        for (const double covered : column(out, "disp_coverage")) CHECK(covered > 0.9);
        CHECK(std::log2(error.front() / error.back()) / 3 >= 1.9);
        CHECK(run.out.find("\"layer\": \"direct\"") != std::string::npos);
    }
    const CommandRun linear = run_trilens("sweep run " + scene_with("plain", "\"yfov\": 40") +
                                          " --over camera-facets=4,8 -o " + folder + "/none");
    CHECK(linear.exit_code == 3);
    CHECK(linear.err.find("plain.json") != std::string::npos);
    CHECK(linear.err.find("/cameras/0: \"plain\" is perspective") != std::string::npos);
}

TEST_CASE("a sweep of many scenes does not end for one that has nothing to sweep", "[cli][sweep]") {
    const std::string folder = scratch_dir("cli_sweep_left_out"), out = folder + "/out";
    const auto scene_without_optic = [&](const std::string& name, const std::string& camera) {
        return write_file(folder, name,
                          R"({ "version": 1, "film": { "width": 64, "height": 48 },
            "cameras": [ { "name": "eye", )" +
                              camera +
                              R"(, "lookAt": { "eye": [0, 0, 3], "at": [0, 0, 0] } } ],
            "materials": [ { "name": "red", "unlit": true } ],
            "meshes": [ { "name": "wall", "role": "object", "material": "red",
                "points": [[-9,-9,-1],[9,-9,-1],[9,9,-1],[-9,9,-1]],
                "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] } ] })");
    };
    const std::string ball = write_file(folder, "ball.json", small_scene());
    const std::string plain = scene_without_optic("plain.json", R"("yfov": 40)");
    const std::string fish = scene_without_optic("fish.json", R"("type": "fisheye", "fov": 120)");
    const std::string reason = "plain.json: /meshes: a sweep needs an optic";
    const std::string left_out_line = "left out of the sweep: " + plain + ": /meshes: a sweep needs an optic";

    SECTION("scenes of a gallery: one over its camera's facets, one left out with a word in page and JSON") {
        const std::string sweep =
            "sweep run " + plain + " " + ball + " " + fish + " --over resolution=2,4 -o " + out;
        const CommandRun run = run_trilens(sweep + " --json");
        INFO(run.err);
        CHECK(run.exit_code == 0);
        CHECK(run.err.find("warning: " + left_out_line) != std::string::npos);
        CHECK(run.err.find("fish.json: has no optic: the facets of its camera \"eye\"") != std::string::npos);
        CHECK(run.out.find("\"left_out\": [") != std::string::npos);
        CHECK(run.out.find("\"reason\": \"" + plain + ": /meshes") != std::string::npos);
        CHECK(!fs::exists(out + "/plain"));
        CHECK(column(out + "/ball", "n") == std::vector<double>{2, 4});
        CHECK(column(out + "/fish", "camera-facets") == std::vector<double>{2, 4});
        CHECK(column(out + "/fish", "disp_mean_px")[1] > 0);
        CHECK(bytes_of(out + "/fish/report.html").find("camera-facets = 4") != std::string::npos);
        const std::string page = bytes_of(out + "/report.html");
        CHECK(page.find(left_out_line) != std::string::npos);
        CHECK(page.find("camera-facets = 4, camera: eye") != std::string::npos);
        // The commands of the page make what it shows.
        CHECK(page.find("-o " + out + "/fish") != std::string::npos);

        // Written again, and with nothing left out.
        REQUIRE(run_trilens("sweep report " + out).exit_code == 0);
        CHECK(bytes_of(out + "/report.html").find(left_out_line) != std::string::npos);
        CHECK(run_trilens("sweep status " + out + " --json").out.find(reason) != std::string::npos);
        REQUIRE(
            run_trilens("sweep run " + ball + " " + fish + " --over resolution=2,4 -o " + out).exit_code ==
            0);
        CHECK(bytes_of(out + "/report.html").find("left out") == std::string::npos);
        CHECK(!fs::exists(out + "/left-out.json"));
    }
    SECTION("an axis that is a place of the file") {
        const CommandRun run = run_trilens("sweep plan " + ball + " " + plain + " " + fish +
                                           " --over /meshes/0/primitive/radius=0.5,1 -o " + out);
        INFO(run.err);
        CHECK(run.exit_code == 0);
        CHECK(run.out == out + "/ball/plan.jsonl\n");
        CHECK(run.err.find("left out of the sweep: " + fish) != std::string::npos);
    }
    SECTION("scenes as an axis") {
        const std::string over = " --over resolution=2,4 -o " + out;
        const CommandRun run = run_trilens("sweep run --over scene=" + plain + "," + ball + over + " --json");
        INFO(run.err);
        CHECK(run.exit_code == 0);
        CHECK(run.err.find("warning: " + left_out_line) != std::string::npos);
        CHECK(run.out.find("\"reason\": \"" + plain + ": /meshes") != std::string::npos);
        CHECK(column(out, "n") == std::vector<double>{2, 4});
        CHECK(bytes_of(out + "/report.html").find(left_out_line) != std::string::npos);
        CHECK(bytes_of(out + "/summary.json").find(reason) != std::string::npos);
        REQUIRE(run_trilens("sweep report " + out).exit_code == 0);
        CHECK(bytes_of(out + "/report.html").find(left_out_line) != std::string::npos);
        // Side by side: its partner goes with it.
        const std::string pairs = folder + "/pairs";
        REQUIRE(run_trilens("sweep run --zip --over scene=" + plain + "," + ball +
                            " --over resolution=2,4 -o " + pairs)
                    .exit_code == 0);
        CHECK(column(pairs, "n") == std::vector<double>{4});
    }
    SECTION("nothing can be swept, or a scene cannot be read: the reason, and nothing is drawn") {
        for (const std::string& scenes :
             {plain + " ", plain + " " + scene_without_optic("dull.json", R"("yfov": 9)"),
              std::string("--over scene=") + plain}) {
            const CommandRun run = run_trilens("sweep run " + scenes + " --over resolution=2,4 -o " + out);
            INFO(run.err);
            CHECK(run.exit_code == 3);
            CHECK(run.err.find(reason) != std::string::npos);
        }
        const std::string broken = write_file(folder, "broken.json", "{ \"version\": 1, \"film\": 7 }");
        for (const std::string& scenes : {ball + " " + broken + " ", "--over scene=" + ball + "," + broken}) {
            const CommandRun run = run_trilens("sweep run " + scenes + " --over resolution=2,4 -o " + out);
            INFO(run.err);
            CHECK(run.exit_code == 3);
            CHECK(run.err.find("broken.json: a scene needs") != std::string::npos);
        }
        CHECK(!fs::exists(out));
    }
}

TEST_CASE("the samples that a sweep's runs had stand in runs.csv, also where a pointer names them",
          "[cli][sweep]") {
    const std::string folder = scratch_dir("cli_sweep_samples");
    const std::string scene = write_file(folder, "room.json", small_scene());
    const std::string out = folder + "/out";
    REQUIRE(run_trilens("sweep run " + scene + " --size 24x18 --over /film/spp=1,3 -o " + out).exit_code == 0);
    CHECK(column(out, "spp") == std::vector<double>{1, 3});
}

TEST_CASE("a sweep goes on in a folder that it made itself, by whatever name, when its scene has changed",
          "[cli][sweep]") {
    const std::string folder = scratch_dir("cli_sweep_edited");
    const fs::path home = fs::current_path();
    fs::current_path(folder);
    write_file(folder, "scene.json", small_scene());
    const CommandRun first = run_trilens("sweep run scene.json --over resolution=1,2 -o out");
    write_file(folder, "scene.json", replaced(small_scene(), "\"width\": ", "\"width\": 1"));
    const CommandRun again = run_trilens("sweep run scene.json --over resolution=1,2 -o out");
    const CommandRun named =
        run_trilens("sweep run '" + folder + "/scene.json' --over resolution=1,2 -o '" + folder + "/out'");
    fs::current_path(home);
    for (const CommandRun& run : {first, again, named}) {
        INFO(run.err);
        CHECK(run.exit_code == 0);
    }
}
