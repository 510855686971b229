// Every scene of the thesis' chapter 4 shows as many separate shapes as its configuration says.
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "cli/command_line.h"
#include "support/test.h"

using namespace trilens_test;

namespace {

/// The length of the list after `"configuration":`; 0 where there is none.
std::size_t shapes_wanted(const std::string& file) {
    std::ifstream in(file);
    std::stringstream all;
    all << in.rdbuf();
    const std::string text = all.str();
    const std::size_t at = text.find("\"configuration\": [");
    if (at == std::string::npos) return 0;
    std::size_t count = 1;
    for (std::size_t i = at; text[i] != ']'; ++i) count += text[i] == ',';
    return count;
}

/// The picture's separate shapes, as the command counts them.
std::size_t regions_in(const CommandRun& run) {
    const std::string key = "\"regions\": ";
    const std::size_t at = run.out.find(key);
    REQUIRE(at != std::string::npos);
    return std::stoul(run.out.substr(at + key.size()));
}

}  // namespace

TEST_CASE("the thesis' configurations show their shapes, projected and ray traced", "[cli][thesis][golden]") {
    const std::string folder = scratch_dir("thesis_scenes");
    std::size_t scenes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(source_dir() + "/scenes/thesis")) {
        const std::string file = entry.path().string();
        const std::size_t wanted = shapes_wanted(file);
        if (wanted == 0) continue;
        ++scenes;
        INFO(file);
        for (const std::string command : {"render ", "trace "}) {
            const CommandRun run = run_trilens(command + file + " --spp 1 --json -o " + folder + "/out.exr");
            REQUIRE(run.exit_code == 0);
            CHECK(regions_in(run) == wanted);
        }
    }
    CHECK(scenes >= 7);
}
