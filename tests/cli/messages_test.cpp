// What the command says of outputs, options and images that are at fault: once, with the right name.
#include <algorithm>
#include <filesystem>
#include <string>

#include "cli/command_line.h"
#include "support/test.h"

using namespace trilens_test;
namespace fs = std::filesystem;

namespace {

std::string quoted_word(const std::string& path) {
    return "'" + path + "'";
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("one failure is told in one line", "[cli][messages]") {
    const std::string folder = scratch_dir("cli_messages_once");
    const std::string scene = write_file(folder, "room.json", small_scene());
    const CommandRun run =
        run_trilens("render " + quoted_word(scene) + " -o " + quoted_word(folder + "/x.exr") +
                    " --json=" + quoted_word(folder + "/none/x.json"));
    INFO(run.err);
    CHECK(run.exit_code == 4);
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK(has(run.err, "there is no folder"));
}

TEST_CASE("a film that --size cannot make is that option's fault", "[cli][messages]") {
    const std::string scene = write_file(scratch_dir("cli_messages_size"), "room.json", small_scene());
    for (const char* size : {"0x0", "100000x100000", "32769x1", "1x32769", "30000x30000"}) {
        const CommandRun run = run_trilens("project " + quoted_word(scene) + " --point 1,1,3 --size " + size);
        INFO(size << ": " << run.err);
        CHECK(run.exit_code == 2);
        CHECK(has(run.err, "--size " + std::string(size)));
        CHECK_FALSE(has(run.err, "room.json"));
    }
    CHECK(run_trilens("project " + quoted_word(scene) + " --point 1,1,3 --size 32768x8192").exit_code == 0);
}

TEST_CASE("compare names the images that cannot be compared", "[cli][messages][bad-input]") {
    const std::string folder = scratch_dir("cli_messages_compare");
    const std::string scene = write_file(folder, "room.json", small_scene());
    const std::string a = folder + "/a.exr", b = folder + "/b.exr", bare = folder + "/bare.exr";
    REQUIRE(run_trilens("render " + quoted_word(scene) + " -o " + quoted_word(a)).exit_code == 0);
    REQUIRE(run_trilens("render " + quoted_word(scene) + " --size 16x16 -o " + quoted_word(b)).exit_code ==
            0);
    REQUIRE(run_trilens("render " + quoted_word(scene) + " --aov Z -o " + quoted_word(bare)).exit_code == 0);
    const auto error = [&](const std::string& words, int code) {
        const CommandRun run = run_trilens("compare " + words);
        INFO(words << ": " << run.err);
        CHECK(run.exit_code == code);
        return run.err;
    };
    const std::string both = a + " and " + a;
    CHECK(has(error(quoted_word(a) + " " + quoted_word(b), 3), a + " and " + b + ": size: "));
    CHECK(has(error(quoted_word(a) + " " + quoted_word(a) + " --mask-object 77", 3),
              both + ": optic.object: no pixel shows object 77"));
    CHECK(has(error(quoted_word(a) + " " + quoted_word(bare) + " --layer reflect", 3),
              bare + ": reflect.R: there is no such channel"));
    CHECK(has(error(quoted_word(a) + " " + quoted_word(a) + " --layer nope", 3),
              a + ": nope.R: there is no such channel"));
}

TEST_CASE("scenes of one name, and standard input, are refused by what reads or writes twice",
          "[cli][messages][bad-input]") {
    const std::string folder = scratch_dir("cli_messages_names");
    for (const char* below : {"/aa", "/bb"}) {
        fs::create_directories(folder + below);
        write_file(folder + below, "scene.json", small_scene());
    }
    const std::string scenes =
        quoted_word(folder + "/aa/scene.json") + " " + quoted_word(folder + "/bb/scene.json");
    const CommandRun run = run_trilens("sweep run " + scenes + " -o " + quoted_word(folder + "/e"));
    INFO(run.err);
    CHECK(run.exit_code == 2);
    CHECK(has(run.err, "have one name"));
    CHECK_FALSE(fs::exists(folder + "/e"));
    const CommandRun stream = run_trilens("sweep run - -o " + quoted_word(folder + "/e") + " </dev/null");
    CHECK(stream.exit_code == 2);
    CHECK(has(stream.err, "standard input"));
}

TEST_CASE("points may come from standard input, where the scene does not", "[cli][messages]") {
    const std::string folder = scratch_dir("cli_messages_points");
    const std::string scene = write_file(folder, "room.json", small_scene());
    const std::string points = write_file(folder, "points.csv", "x,y,z\n1,1,3\n0.5,2,4\n");
    const CommandRun file = run_trilens("project " + quoted_word(scene) + " --points " + quoted_word(points));
    const CommandRun stream =
        run_trilens("project " + quoted_word(scene) + " --points - <" + quoted_word(points));
    CHECK(file.exit_code == 0);
    CHECK_FALSE(file.out.empty());
    CHECK(stream.out == file.out);
    const CommandRun bad =
        run_trilens("project " + quoted_word(scene) + " --points - <" + quoted_word(scene));
    CHECK(bad.exit_code == 3);
    CHECK(has(bad.err, "standard input: line 2"));
    const CommandRun both = run_trilens("project - --points - <" + quoted_word(scene));
    CHECK(both.exit_code == 2);
    CHECK(has(both.err, "both"));
    CHECK(run_trilens("project " + quoted_word(scene) + " --points - </dev/null").exit_code == 3);
}

TEST_CASE("that there are no objects is told where rays can see nothing but the background",
          "[cli][messages]") {
    const std::string folder = scratch_dir("cli_messages_objects");
    const auto told_of = [&](const std::string& more) {
        const std::string scene = write_file(folder, "room.json",
                                             R"({"version": 1, "film": {"width": 16, "height": 12},
            "cameras": [{"yfov": 45, "lookAt": {"eye": [0, 0, 5], "at": [0, 0, 0]}}],
            "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}],
            "meshes": [{"name": "ball", "role": "optic", "material": "chrome", "resolution": 4,
                        "primitive": {"type": "sphere", "center": [1, 0, 0], "radius": 0.5}})" +
                                                 more + "}");
        const CommandRun run =
            run_trilens("render " + quoted_word(scene) + " -o " + quoted_word(folder + "/x.exr"));
        INFO(run.err);
        CHECK(run.exit_code == 0);
        return has(run.err, "the scene has no objects: rays see only the background");
    };
    CHECK(told_of("]"));
    CHECK_FALSE(told_of(R"(, {"name": "wall", "role": "object", "points": [[-9,-9,-2],[9,-9,-2],[0,9,-2]],
        "faceVertexCounts": [3], "faceVertexIndices": [0, 1, 2]}])"));
    CHECK_FALSE(told_of(R"(], "points": [{"at": [[0, 0, 0]], "radius": 0.1}])"));
    CHECK_FALSE(told_of(R"(], "labels": [{"text": "here", "at": [0, 0, 0]}])"));
    CHECK_FALSE(told_of(R"(], "volumes": [{"grid": {"size": [2,2,2], "origin": [-1,-1,-1], "spacing": [1,1,1],
        "scalars": [0,1,0,1,0,1,0,1]}, "transferFunction": {"points": [
            {"value": 0, "color": [1,0,0], "extinction": 0.1}, {"value": 1, "color": [0,0,1], "extinction": 1}]}}])"));
}
