// trilens test and the files of its tests: none is written over, references may lie anywhere.
#include <filesystem>
#include <string>

#include "cli/command_line.h"
#include "support/test.h"

using namespace trilens_test;
namespace fs = std::filesystem;

TEST_CASE("outputs of trilens test are never what its tests read", "[cli][files]") {
    const std::string folder = scratch_dir("cli_suite_inputs"), test = folder + "/a";
    fs::create_directories(test);
    const std::string name = GENERATE("test.json", "scene.json", "ref.exr", "wall.obj", "other/test.json");
    const std::string option = GENERATE("--html ", "--junit ", "--json=");
    fs::create_directories(test + "/other");
    write_file(test, "other/test.json", R"({ "against": "truth" })");
    write_file(test, "wall.obj", "v -4 -4 -3\nv 4 -4 -3\nv 4 4 -3\nv -4 4 -3\nf 1 2 3 4\n");
    write_file(test, "scene.json",
               replaced(small_scene(), "\"meshes\": [",
                        R"("meshes": [ {"name": "far", "role": "object", "file": "wall.obj"},)"));
    write_file(test, "test.json", R"({ "against": "golden", "reference": "ref.exr" })");
    write_file(test, "ref.exr", "no picture");
    const std::string before = bytes_of(test + "/" + name);
    INFO(option << name);
    const CommandRun run =
        run_trilens("test '" + folder + "' -k a " + option + "'" + test + "/" + name + "'");
    CHECK(run.exit_code == 2);
    CHECK(run.err.find("is the input") != std::string::npos);
    CHECK(bytes_of(test + "/" + name) == before);
}

TEST_CASE("a reference may lie beside test.json; a wrong camera is that file's", "[cli][suite][golden]") {
    const std::string folder = scratch_dir("cli_suite_beside");
    write_file(folder, "scene.json", small_scene());
    write_file(folder, "test.json", R"({ "against": "golden", "reference": "main.exr", "resolution": 2 })");
    const fs::path home = fs::current_path();
    fs::current_path(folder);
    const CommandRun update = run_trilens("test . --update");
    fs::current_path(home);
    INFO(update.out << update.err);
    CHECK(update.exit_code == 0);
    CHECK(fs::exists(folder + "/main.exr"));
    write_file(folder, "test.json", R"({ "against": "truth", "camera": "nope" })");
    const CommandRun wrong = run_trilens("test '" + folder + "'");
    CHECK(wrong.exit_code == 6);
    CHECK(wrong.out.find("test.json: /camera: there is no camera \"nope\"") != std::string::npos);
    write_file(folder, "test.json", R"({ "against": "truth", "scene": "gone.json" })");
    const CommandRun gone = run_trilens("test '" + folder + "'");
    CHECK(gone.exit_code == 6);
    CHECK(gone.out.find("test.json: /scene: there is no scene '") != std::string::npos);
    // A value that it sets in the scene is its mistake, not the scene's.
    const auto setting = [&](const std::string& set) {
        write_file(folder, "test.json", R"({ "against": "truth", "set": )" + set + " }");
        return run_trilens("test '" + folder + "'").out;
    };
    const std::string scene = " (of " + folder + "/scene.json)";
    CHECK(setting(R"({"/film/wdth": 3})")
              .find("test.json: /set: /film/wdth: names nothing: unknown key 'wdth'; did you mean 'width'?" +
                    scene) != std::string::npos);
    CHECK(setting(R"({"/film/width": "a"})")
              .find("test.json: /set: /film/width: expected an integer, found the string \"a\"" + scene) !=
          std::string::npos);
    CHECK(setting(R"({"/film": {"width": 0}})").find("test.json: /set: /film/width: 0 is out of range") !=
          std::string::npos);
    write_file(folder, "test.json", R"({ "against": "truth", "layer": "nope" })");
    const CommandRun layer = run_trilens("test '" + folder + "'");
    INFO(layer.out);
    CHECK(layer.exit_code == 1);
    CHECK(layer.out.find("test.json: /layer: nope.R: there is no such channel") != std::string::npos);
}
