// Commands that are programs of their own: found as a shell finds them.
#include <sys/wait.h>
#include <trilens/error.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/test.h"
#include "terminal/other_program.h"

using namespace trilens;
using namespace trilens_test;
namespace fs = std::filesystem;

namespace {

void write_program(const std::string& file, const std::string& text, fs::perms perms) {
    fs::create_directories(fs::path(file).parent_path());
    std::ofstream(file) << text;
    fs::permissions(file, perms);
}

/// What a process comes to that becomes `trilens-other` with this PATH: its exit code, 99 where it is said to
/// be missing, 98 where it is found and does not start.
int code_of_other(const std::string& path) {
    const pid_t child = fork();
    if (child == 0) {
        setenv("PATH", path.c_str(), 1);
        try {
            become_program("trilens-other", "it is missing", Console({}));
        } catch (const ComputationError& error) {
            _exit(std::string(error.what()) == "it is missing" ? 99 : 98);
        }
    }
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    REQUIRE(WIFEXITED(status));
    return WEXITSTATUS(status);
}

}  // namespace

TEST_CASE("a program is missing where no folder of PATH has one that may be run", "[cad]") {
    const std::string folder = scratch_dir("cad_other_program");
    fs::create_directories(folder + "/folder/trilens-other");
    write_program(folder + "/text/trilens-other", "no program", fs::perms::owner_read);
    write_program(folder + "/program/trilens-other", "#!/bin/sh\nexit 7\n", fs::perms::owner_all);
    write_program(folder + "/broken/trilens-other", "#!/no/shell\n", fs::perms::owner_all);
    const std::string unfit = folder + "/none:" + folder + "/text:" + folder + "/folder";
    CHECK(code_of_other(unfit) == 99);
    CHECK(code_of_other("") == 99);
    CHECK(code_of_other(unfit + ":" + folder + "/program") == 7);
    CHECK(code_of_other(folder + "/broken") == 98);
}
