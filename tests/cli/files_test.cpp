// What the command does with files: outputs are never inputs nor devices, images carry their scene, and
// sweeps know when what they read has changed.
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <sys/stat.h>

#include "cli/command_line.h"
#include "support/test.h"

using namespace trilens_test;
namespace fs = std::filesystem;

namespace {

std::string quoted(const std::string& path) {
    return "'" + path + "'";
}

/// The small scene with a second camera, which comes first.
std::string two_cameras() {
    return replaced(small_scene(), "\"cameras\": [",
                    R"("cameras": [ {"name": "side", "type": "perspective", "yfov": 50,
                        "lookAt": {"eye": [1, 1, 5], "at": [0, 0, 0], "up": [0, 1, 0]}},)");
}

}  // namespace

TEST_CASE("an output that is an input, a pipe or behind a link", "[cli][files]") {
    const std::string folder = scratch_dir("cli_files_output");
    const std::string scene = write_file(folder, "room.json", small_scene());
    const std::string before = bytes_of(scene);
    const CommandRun onto_itself =
        run_trilens("render " + quoted(scene) + " --format png -o " + quoted(scene));
    CHECK(onto_itself.exit_code == 2);
    CHECK(onto_itself.err.find("is the input") != std::string::npos);
    CHECK(bytes_of(scene) == before);

    const std::string pipe = folder + "/pipe.exr";
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    CHECK(run_trilens("render " + quoted(scene) + " -o " + quoted(pipe)).exit_code == 4);
    CHECK(fs::is_fifo(pipe));

    fs::create_symlink("real.exr", folder + "/link.exr");
    CHECK(run_trilens("render " + quoted(scene) + " -n 2 -o " + quoted(folder + "/link.exr")).exit_code == 0);
    CHECK(fs::is_symlink(folder + "/link.exr"));
    CHECK(fs::is_regular_file(folder + "/real.exr"));
    CHECK(run_trilens("compare " + quoted(folder + "/real.exr") + " " + quoted(folder + "/real.exr") +
                      " -o " + quoted(folder + "/link.exr"))
              .exit_code == 2);
}

TEST_CASE("file names may end in capitals, and a scene's name ends as one", "[cli][files]") {
    const std::string folder = scratch_dir("cli_files_endings");
    const std::string scene = write_file(folder, "room.json", small_scene());
    for (const char* name : {"A.EXR", "B.PNG", "C.SVG"})
        CHECK(run_trilens("render " + quoted(scene) + " -n 2 -o " + quoted(folder + "/" + name)).exit_code ==
              0);
    CHECK(bytes_of(folder + "/B.PNG").rfind("\x89PNG", 0) == 0);
    CHECK(bytes_of(folder + "/C.SVG").find("<svg") != std::string::npos);
    const std::string exr = quoted(folder + "/A.EXR");
    CHECK(run_trilens("compare " + exr + " " + exr + " -o " + quoted(folder + "/D.PNG")).exit_code == 0);
    CHECK(bytes_of(folder + "/D.PNG").rfind("\x89PNG", 0) == 0);
    CHECK(run_trilens("render " + exr + " -o " + quoted(folder + "/E.exr")).exit_code == 0);
    for (const std::string name : {"x.PLY", "x.txt", "x.json.bak"}) {
        const CommandRun wrong =
            run_trilens("scene convert " + quoted(scene) + " -o " + quoted(folder + "/" + name));
        INFO(name);
        CHECK(wrong.exit_code == 2);
        CHECK(wrong.err.find("ends in .json") != std::string::npos);
        CHECK(!fs::exists(folder + "/" + name));
    }
}

TEST_CASE("an image renders again through its own camera, and finds its scene's files from anywhere",
          "[cli][files]") {
    const std::string folder = scratch_dir("cli_files_again");
    fs::create_directories(folder + "/scene");
    fs::create_directories(folder + "/images");
    const std::string wall =
        write_file(folder + "/scene", "wall.obj", "v -4 -4 -3\nv 4 -4 -3\nv 4 4 -3\nv -4 4 -3\nf 1 2 3 4\n");
    const std::string text =
        replaced(two_cameras(), "\"meshes\": [",
                 R"("meshes": [ {"name": "far", "role": "object", "file": "wall.obj"},)");
    const std::string scene = write_file(folder + "/scene", "room.json", text);
    const std::string first = folder + "/images/first.exr", second = folder + "/images/second.exr";
    REQUIRE(run_trilens("render " + quoted(scene) + " --camera main -n 3 -o " + quoted(first)).exit_code ==
            0);
    REQUIRE(run_trilens("render " + quoted(first) + " -o " + quoted(second)).exit_code == 0);
    CHECK(bytes_of(first) == bytes_of(second));
    REQUIRE(run_trilens("render " + quoted(first) + " --camera side -o " + quoted(second)).exit_code == 0);
    CHECK(bytes_of(first) != bytes_of(second));

    // What the image was drawn with is not what stands there now: said, and drawn.
    write_file(folder + "/scene", "wall.obj", "v -4 -4 -2\nv 4 -4 -2\nv 4 4 -2\nv -4 4 -2\nf 1 2 3 4\n");
    const auto again = run_trilens("render " + quoted(first) + " -o " + quoted(second));
    CHECK(again.exit_code == 0);
    CHECK(again.err.find("wall.obj has changed since the image was drawn") != std::string::npos);
}

TEST_CASE("no output is a file that the scene read", "[cli][files]") {
    const std::string folder = scratch_dir("cli_files_inputs");
    const std::string wall =
        write_file(folder, "wall.obj", "v -4 -4 -3\nv 4 -4 -3\nv 4 4 -3\nv -4 4 -3\nf 1 2 3 4\n");
    const std::string text =
        replaced(two_cameras(), "\"meshes\": [",
                 R"("meshes": [ {"name": "far", "role": "object", "file": "wall.obj"},)");
    const std::string scene = write_file(folder, "room.json", text);
    for (const std::string& input : {scene, wall}) {
        const std::string before = bytes_of(input);
        CHECK(run_trilens("render " + quoted(scene) + " --format png -o " + quoted(input)).exit_code == 2);
        CHECK(run_trilens("render " + quoted(scene) + " -o " + quoted(folder + "/x.png") +
                          " --json=" + quoted(input))
                  .exit_code == 2);
        CHECK(bytes_of(input) == before);
    }
}

TEST_CASE("a sweep runs again when a file that its scene names has changed, and only then", "[cli][files]") {
    const std::string folder = scratch_dir("cli_files_sweep");
    const std::string wall = "v -4 -4 -3\nv 4 -4 -3\nv 4 4 -3\nv -4 4 -3\nf 1 2 3 4\n";
    write_file(folder, "wall.obj", wall);
    const std::string text =
        replaced(small_scene(), "\"meshes\": [",
                 R"("meshes": [ {"name": "far", "role": "object", "file": "wall.obj"},)");
    const std::string scene = write_file(folder, "room.json", text);
    const std::string sweep =
        "sweep run " + quoted(scene) + " --over resolution=1,2 -o " + quoted(folder + "/out");
    const auto plan = [&] {
        REQUIRE(run_trilens(sweep).exit_code == 0);
        return bytes_of(folder + "/out/plan.jsonl");
    };
    const std::string first = plan();
    CHECK(plan() == first);
    write_file(folder, "wall.obj", replaced(wall, "4 4 -3", "4 4 -2"));
    CHECK(plan() != first);
}

TEST_CASE("scenes of one name are not swept into one folder", "[cli][files]") {
    const std::string folder = scratch_dir("cli_files_names");
    for (const char* place : {"/a", "/b"}) {
        fs::create_directories(folder + place);
        write_file(folder + place, "room.json", small_scene());
    }
    const CommandRun run = run_trilens("sweep run " + quoted(folder + "/a/room.json") + " " +
                                       quoted(folder + "/b/room.json") + " -o " + quoted(folder + "/out"));
    CHECK(run.exit_code == 2);
    CHECK(!fs::exists(folder + "/out"));
}

TEST_CASE("points: a byte order mark is none of them, a first line with numbers is no header",
          "[cli][files]") {
    const std::string folder = scratch_dir("cli_files_points");
    const std::string scene = write_file(folder, "room.json", small_scene());
    const auto project = [&](const std::string& text) {
        return run_trilens("project " + quoted(scene) + " -n 2 --points " +
                           quoted(write_file(folder, "points.csv", text)));
    };
    CHECK(project("\xef\xbb\xbf"
                  "0,0,2\n0,1,2\n")
              .out == project("x, \"y\", z\n0,0,2\n0,1,2\n").out);
    for (const char* bad :
         {"nan,0,3\n0,0,2\n", "\"1\",\"2\",\"3\"\n0,0,2\n", "1e308,0,0\n", "0,0,2\nx,y,z\n"}) {
        INFO(bad);
        CHECK(project(bad).exit_code == 3);
    }
}

TEST_CASE("frames are traced as they are drawn, and a number of facets is told to be none of exact surfaces'",
          "[cli][files]") {
    const std::string folder = scratch_dir("cli_files_frames");
    const std::string scene = quoted(write_file(folder, "room.json", small_scene()));
    CHECK(run_trilens("trace " + scene + " --turntable 4 --frames 0..1 -o " + quoted(folder + "/f.##.png"))
              .exit_code == 0);
    const CommandRun still = run_trilens("trace " + scene + " -n 3 -o " + quoted(folder + "/still.png"));
    CHECK(still.exit_code == 0);
    CHECK(still.err.find("-n is about facets") != std::string::npos);
    CHECK(bytes_of(folder + "/f.00.png") == bytes_of(folder + "/still.png"));
    CHECK(bytes_of(folder + "/f.01.png") != bytes_of(folder + "/still.png"));
    const CommandRun facets =
        run_trilens("trace " + scene + " -n 3 --surface facets -o " + quoted(folder + "/facets.png"));
    CHECK(facets.exit_code == 0);
    CHECK(facets.err.empty());
}

TEST_CASE("common options stand before the command or behind it", "[cli][files]") {
    const CommandRun before = run_trilens("--json -t 1 info"), behind = run_trilens("info --json -t 1");
    CHECK(before.exit_code == 0);
    CHECK(before.out == behind.out);
    CHECK(run_trilens("--version").exit_code == 0);
    CHECK(run_trilens("--json").exit_code == 2);
}
