// The commands of the README run as they are written.
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

const std::string kProgram = "$trilens ";

/// What stands behind the program's name in the README's indented lines.
std::vector<std::string> readme_commands() {
    std::vector<std::string> commands;
    std::stringstream lines(bytes_of(source_dir() + "/README.md"));
    const std::string start = "    " + kProgram;
    for (std::string line; std::getline(lines, line);)
        if (line.rfind(start, 0) == 0) commands.push_back(line.substr(start.size()));
    return commands;
}

/// The scenes' size is what takes time; one pixel of the README's must stay on the film.
void make_smaller(const std::string& file) {
    write_file(".", file,
               replaced(bytes_of(file), R"("width": 640, "height": 480)", R"("width": 324, "height": 243)"));
}

struct WorkingFolder {
    fs::path before = fs::current_path();
    explicit WorkingFolder(const std::string& folder) { fs::current_path(folder); }
    ~WorkingFolder() { fs::current_path(before); }
};

}  // namespace

TEST_CASE("the README's commands run one after the other and write what they say", "[cli][readme]") {
    const WorkingFolder here(scratch_dir("readme"));
    const std::vector<std::string> commands = readme_commands();
    REQUIRE(commands.size() >= 11);
    // What the README's other lines make, and the project's scenes, which some of its commands draw.
    fs::create_directory_symlink(source_dir() + "/scenes", "scenes");
    fs::create_directory("t");
    write_file(
        "t", "test.json",
        R"({ "scene": "../my.json", "against": "truth", "resolution": 16, "max": { "displacement_p95": 0.5 } })");
    for (const std::string& command : commands) {
        INFO(command);
        const std::size_t to_file = command.find(" > ");
        if (to_file != std::string::npos) {
            const CommandRun run = run_trilens(command.substr(0, to_file));
            CHECK(run.exit_code == 0);
            const std::string file = command.substr(to_file + 3);
            write_file(".", file, run.out);
            make_smaller(file);
            continue;
        }
        const CommandRun run = run_trilens(command);
        INFO(run.err);
        const bool is_verdict = command.rfind("compare", 0) == 0;
        CHECK((run.exit_code == 0 || (is_verdict && run.exit_code == 1)));
        const std::size_t output = command.find("-o ");
        if (output == std::string::npos || command.find("--print") != std::string::npos) {
            CHECK(!run.out.empty());
        } else {
            const std::string file = command.substr(output + 3);
            CHECK(fs::exists(file.substr(0, file.find(' '))));
        }
    }
    CHECK(run_trilens("scene validate my.json").exit_code == 0);
    CHECK(run_trilens("render my.exr -o again.exr").exit_code == 0);
}
