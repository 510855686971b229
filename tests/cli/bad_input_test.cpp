// Every bad input gets one clear message that names the place, the right exit code, and leaves nothing
// behind.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <unistd.h>

#include "cli/command_line.h"
#include "support/test.h"

using namespace trilens_test;
namespace fs = std::filesystem;

namespace {

/// Files in a folder, so that a test can say that nothing was left behind.
std::size_t files_in(const std::string& folder) {
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) count += entry.is_regular_file();
    return count;
}

void check_one_message(const CommandRun& run, int exit_code, const std::vector<std::string>& must_say) {
    INFO("stderr: " << run.err);
    CHECK(run.exit_code == exit_code);
    CHECK(run.out.empty());
    CHECK(run.err.find("trilens: error: ") != std::string::npos);
    std::size_t errors = 0;
    for (std::size_t at = run.err.find("error: "); at != std::string::npos;
         at = run.err.find("trilens: error: ", at + 1))
        ++errors;
    CHECK(errors == 1);
    for (const std::string& words : must_say) {
        INFO("must say: " << words);
        CHECK(run.err.find(words) != std::string::npos);
    }
}

struct BadScene {
    std::string what, replace, by;
    std::vector<std::string> says;
};

std::string film() {
    return R"("width": 32, "height": 24)";
}

std::vector<BadScene> bad_scenes() {
    return {
        {"unknown key",
         R"("radius": 1)",
         R"("radius": 1, "raduis": 2)",
         {"/meshes/0/primitive", "raduis", "radius"}},
        {"wrong type", R"("yfov": 40)", R"("yfov": "wide")", {"/cameras/0/yfov"}},
        {"index out of range", "[0,1,2,3] } ]", "[0,1,2,4] } ]", {"/meshes/1/faceVertexIndices/3", "4"}},
        {"negative index", "[0,1,2,3] } ]", "[0,1,2,-1] } ]", {"/meshes/1/faceVertexIndices/3"}},
        {"counts and indices differ",
         R"("faceVertexCounts": [4])",
         R"("faceVertexCounts": [5])",
         {"/meshes/1"}},
        {"infinite number", "[4,4,5]", "[4,1e999,5]", {"line 6", "1e999"}},
        {"absurd number", "[4,4,5]", "[4,1e300,5]", {"/meshes/1/points/2"}},
        {"NaN is no JSON", "[4,4,5]", "[4,NaN,5]", {"line"}},
        {"eye is target", R"("eye": [0,0,4])", R"("eye": [0,0,0])", {"/cameras/0"}},
        {"up along the view", R"("up": [0,1,0])", R"("up": [0,0,2])", {"/cameras/0"}},
        {"missing texture", R"("unlit": true)", R"("baseColorTexture": "no-such.png")", {"no-such.png"}},
        {"film of no size", film(), R"("width": 0, "height": 24)", {"/film/width"}},
        {"film of absurd size", film(), R"("width": 2000000000, "height": 24)", {"/film/width"}},
        {"n of zero", R"("resolution": 4)", R"("resolution": 0)", {"/meshes/0/resolution"}},
        {"unknown material",
         R"("material": "chrome")",
         R"("material": "crome")",
         {"/meshes/0/material", "crome", "chrome"}},
        {"rough mirror", R"("roughnessFactor": 0)", R"("roughnessFactor": 0.4)", {"roughness"}},
        {"missing mesh file",
         R"("points": [[-4,-4,5],[4,-4,5],[4,4,5],[-4,4,5]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3])",
         R"("file": "no-such.obj")",
         {"no-such.obj"}},
        {"duplicate key", R"("version": 1)", R"("version": 1, "version": 1)", {"version"}},
        {"no version", R"("version": 1, )", "", {"version"}},
        {"cut off", "] })", "]", {"line"}},
        {"radius of zero", R"("radius": 1)", R"("radius": 0)", {"/meshes/0/primitive/radius"}},
    };
}

}  // namespace

TEST_CASE("a scene that cannot be used: exit 3, the file and the place", "[cli][bad-input]") {
    const std::string folder = scratch_dir("bad_scenes");
    for (const BadScene& bad : bad_scenes()) {
        INFO(bad.what);
        // "cut off" drops the closing brace.
        std::string text =
            bad.what == "cut off" ? small_scene() : replaced(small_scene(), bad.replace, bad.by);
        if (bad.what == "cut off") text.pop_back();
        const std::string scene = write_file(folder, "scene.json", text);
        std::vector<std::string> says = bad.says;
        says.push_back("scene.json");
        for (const char* command : {"render ", "trace "}) {
            check_one_message(run_trilens(command + scene + " -o " + folder + "/out.exr"), 3, says);
            CHECK(files_in(folder) == 1);
        }
    }
}

TEST_CASE("a mesh, a lens or a CAD file in a scene's place is told what to do with", "[cli][bad-input]") {
    const std::string folder = scratch_dir("bad_kinds");
    const auto render = [&](const std::string& name) {
        return run_trilens("render " + write_file(folder, name, "# no scene\n") + " -o " + folder +
                           "/out.exr");
    };
    check_one_message(render("pot.obj"), 3, {"pot.obj", "is a mesh", "'file'"});
    check_one_message(render("triplet.ZMX"), 3, {"triplet.ZMX", "is a lens"});
    check_one_message(render("mount.stp"), 3, {"mount.stp", "trilens cad"});
    const std::string scene = write_file(folder, "scene.json", small_scene());
    check_one_message(run_trilens("lens " + scene), 3, {"scene.json", "/version", "is a scene", "lenses"});
}

TEST_CASE("files that cannot be read: exit 3", "[cli][bad-input]") {
    const std::string folder = scratch_dir("bad_files");
    const std::string scene = write_file(folder, "scene.json", small_scene());
    check_one_message(run_trilens("render " + folder + "/nothing.json -o " + folder + "/out.exr"), 3,
                      {"nothing.json"});
    check_one_message(run_trilens("render " + folder + " -o " + folder + "/out.exr"), 3, {"bad_files"});
    check_one_message(run_trilens("compare " + folder + "/a.exr " + folder + "/b.exr"), 3, {"a.exr"});
    check_one_message(run_trilens("project " + scene + " --points " + folder + "/no.csv"), 3, {"no.csv"});
    const std::string points = write_file(folder, "points.csv", "x,y,z\n1,2,3\n1,2\n");
    check_one_message(run_trilens("project " + scene + " --points " + points), 3, {"points.csv", "line 3"});

    // An image that ends too early.
    REQUIRE(run_trilens("render " + scene + " -o " + folder + "/whole.exr").exit_code == 0);
    const auto size = fs::file_size(folder + "/whole.exr");
    for (const auto keep : {size - 1, size / 2, size / 4, std::uintmax_t{100}, std::uintmax_t{0}}) {
        fs::copy_file(folder + "/whole.exr", folder + "/cut.exr", fs::copy_options::overwrite_existing);
        fs::resize_file(folder + "/cut.exr", keep);
        INFO("kept " << keep << " of " << size);
        check_one_message(run_trilens("compare " + folder + "/whole.exr " + folder + "/cut.exr"), 3,
                          {"cut.exr"});
    }
}

TEST_CASE("an OBJ with a face of 300 corners: exit 3 with its line", "[cli][bad-input]") {
    const std::string folder = scratch_dir("big_face");
    std::string obj = "# a disk\n", face = "f";
    for (int k = 0; k < 300; ++k) {
        obj += "v " + std::to_string(std::cos(k * 0.0209439)) + " " +
               std::to_string(std::sin(k * 0.0209439)) + " 0\n";
        face += " " + std::to_string(k + 1);
    }
    write_file(folder, "disk.obj", obj + face + "\n");
    const std::string scene = write_file(
        folder, "scene.json",
        replaced(small_scene(), R"("primitive": { "type": "sphere", "center": [0,0,0], "radius": 1 })",
                 R"("file": "disk.obj")"));
    check_one_message(run_trilens("render " + scene + " -o " + folder + "/out.exr"), 3,
                      {"disk.obj", "302", "300"});
}

TEST_CASE("a command line that makes no sense: exit 2 and the nearest word", "[cli][bad-input]") {
    const std::string folder = scratch_dir("bad_usage");
    const std::string scene = write_file(folder, "scene.json", small_scene());
    const std::string out = " -o " + folder + "/out.exr";
    check_one_message(run_trilens("rendr " + scene + out), 2, {"rendr", "render"});
    check_one_message(run_trilens("render " + scene + out + " --resolutoin 4"), 2,
                      {"--resolutoin", "--resolution"});
    check_one_message(run_trilens("render " + scene + out + " -n 0"), 2, {});
    check_one_message(run_trilens("render " + scene + out + " -n many"), 2, {});
    check_one_message(run_trilens("render " + scene + out + " --size 640"), 2, {"--size"});
    check_one_message(run_trilens("render " + scene + out + " --size 0x0"), 2, {"--size"});
    check_one_message(run_trilens("render " + scene + out + " --crop 0,0,99,99"), 2, {"--crop"});
    check_one_message(run_trilens("render " + scene + out + " --pixel 32,0"), 2, {"--pixel"});
    check_one_message(run_trilens("render " + scene + out + " --camera mian"), 2, {"mian", "main"});
    check_one_message(run_trilens("render " + scene + out + " --aov reflekt"), 2, {"reflekt", "reflect"});
    check_one_message(run_trilens("render " + scene), 2, {"-o"});
    check_one_message(run_trilens("render " + scene + " -o " + folder + "/out.jpeg"), 2, {".exr"});
    check_one_message(run_trilens("render " + scene + out + " --set film=3"), 2, {"--set"});
    check_one_message(run_trilens("project " + scene + " --point 1,2"), 2, {"--point"});
    check_one_message(run_trilens("project " + scene), 2, {"--point"});
    check_one_message(run_trilens("project " + scene + " --point 1e308,0,0"), 2, {"--point"});
    for (const char* tolerance :
         {"--fail nan", "--hardfail nan", "--warn nan", "--failrelative -1", "--failpercent 101",
          "--allowfailures -1", "--allowfailures 99999999999999999999", "--radius nan"})
        check_one_message(run_trilens(std::string("compare a.exr b.exr ") + tolerance), 2, {"--"});
    check_one_message(run_trilens("compare a.exr b.exr -o diff.jpeg"), 2, {"diff.jpeg"});
    check_one_message(run_trilens("sweep run " + scene + " --over resolution=2000" + out), 2, {"2000"});
    check_one_message(run_trilens(""), 2, {"command"});
    CHECK(files_in(folder) == 1);
}

TEST_CASE("--set and --size reach the checks of the scene: exit 3", "[cli][bad-input]") {
    const std::string folder = scratch_dir("bad_set");
    const std::string scene = write_file(folder, "scene.json", small_scene());
    const std::string out = " -o " + folder + "/out.exr";
    check_one_message(run_trilens("render " + scene + out + " --set /film/widht=3"), 3, {"/film", "widht"});
    check_one_message(run_trilens("render " + scene + out + " --set /meshes/9/resolution=3"), 3,
                      {"/meshes/9"});
    check_one_message(run_trilens("render " + scene + out + " --size 99999999x1"), 2, {"--size 99999999x1"});
    CHECK(files_in(folder) == 1);
}

TEST_CASE("output that cannot be written: exit 4, and nothing half-written", "[cli][bad-input]") {
    const std::string folder = scratch_dir("bad_output");
    const std::string scene = write_file(folder, "scene.json", small_scene());
    check_one_message(run_trilens("render " + scene + " -o " + folder + "/no/such/out.exr"), 4, {"out.exr"});
    fs::create_directories(folder + "/taken.exr");
    check_one_message(run_trilens("render " + scene + " -o " + folder + "/taken.exr"), 4, {"taken.exr"});
    CHECK(files_in(folder) == 1);
    if (geteuid() == 0) {
        note_skip("output that cannot be written: a read-only folder", "root may write everywhere");
    } else {
        fs::permissions(folder, fs::perms::owner_read | fs::perms::owner_exec);
        check_one_message(run_trilens("render " + scene + " -o " + folder + "/out.exr"), 4, {"out.exr"});
        fs::permissions(folder, fs::perms::owner_all);
    }
}

TEST_CASE("with --json a failure is one object with the same words", "[cli]") {
    const std::string folder = scratch_dir("bad_json");
    const CommandRun run = run_trilens("render " + folder + "/nothing.json -o " + folder + "/out.exr --json");
    CHECK(run.exit_code == 3);
    CHECK(run.out.find("\"schema\": \"trilens.render/1\"") != std::string::npos);
    CHECK(run.out.find("\"status\": \"error\"") != std::string::npos);
    CHECK(run.out.find("\"exit_code\": 3") != std::string::npos);
    CHECK(run.out.find("nothing.json") != std::string::npos);
    const CommandRun usage = run_trilens("render --json --no-such-option");
    CHECK(usage.exit_code == 2);
    CHECK(usage.out.find("\"exit_code\": 2") != std::string::npos);
}

TEST_CASE("A resolution for a scene without meshes is no error of the program's", "[cli]") {
    const std::string folder = scratch_dir("no_meshes"), scene = folder + "/a.json";
    std::ofstream(scene) << R"({"version": 1, "film": {"width": 32, "height": 24},
        "cameras": [{"name": "c", "lookAt": {"eye": [0, 1, 4], "at": [0, 0, 0]}}]})";
    const CommandRun run = run_trilens("render " + scene + " -n 4 -o " + folder + "/a.exr");
    INFO(run.err);
    CHECK(run.exit_code == 0);
    CHECK(fs::exists(folder + "/a.exr"));
}

TEST_CASE("Messages of libraries are told as ours, with the file", "[cli]") {
    const std::string folder = scratch_dir("library_messages");
    const auto scene_with = [&](const std::string& file) {
        const std::string scene = folder + "/s.json";
        std::ofstream(scene) << R"({"version": 1, "film": {"width": 32, "height": 24},
            "cameras": [{"name": "c", "lookAt": {"eye": [0, 1, 4], "at": [0, 0, 0]}}],
            "meshes": [{"name": "m", "role": "object", "file": ")" +
                                    file + R"("}]})";
        return "render " + scene + " -o " + folder + "/a.exr";
    };
    std::ofstream(folder + "/a.gltf") << "no glTF";
    const CommandRun gltf = run_trilens(scene_with("a.gltf"));
    check_one_message(gltf, 3, {"/meshes/0/file", "a.gltf", "not a readable glTF file", "line 1"});
    CHECK(gltf.err.find("json.exception") == std::string::npos);

    std::ofstream(folder + "/a.obj") << "mtllib .\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const CommandRun obj = run_trilens(scene_with("a.obj"));
    CHECK(obj.exit_code == 0);
    CHECK(obj.err.find("the material library '" + folder + "/.' is a folder") != std::string::npos);
}

TEST_CASE("trilens lens warns of sides that cross, in glass and in the air", "[cli][lens]") {
    const std::string folder = scratch_dir("cli_lens_crossing");
    const auto warned = [&](const std::string& surfaces, const std::string& what) {
        const std::string lens = write_file(folder, "lens.json", "{\"surfaces\": [" + surfaces + "]}");
        const CommandRun run = run_trilens("lens " + lens);
        INFO(run.err);
        CHECK(run.exit_code == 0);
        return run.err.find("warning: " + lens + ": " + what) != std::string::npos;
    };
    CHECK(
        warned(R"({"radius":20,"thickness":1,"glass":"N-BK7","aperture":15},{"radius":-20,"aperture":15})",
               "/surfaces/0: from here to the next surface is no lens: its rims have no edge between them"));
    CHECK(warned(
        R"({"radius":40,"thickness":6,"glass":"N-BK7","aperture":10},{"radius":30,"thickness":0.1,"aperture":10},
                    {"radius":60,"thickness":5,"glass":"N-SF11","aperture":10},{"radius":-60,"aperture":10})",
        "/surfaces/1: the next lens stands in this one"));
}
