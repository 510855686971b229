// Manual pages and completion, as the tools that use them see them.
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

/// What a shell line prints, both streams.
std::string output_of(const std::string& line) {
    static const std::string folder = scratch_dir("cli_manual_lines");
    const std::string file = folder + "/said.txt";
    if (std::system(("(" + line + ") > " + file + " 2>&1").c_str()) == -1) return "the line cannot be run";
    return bytes_of(file);
}

std::vector<fs::path> written_pages(const std::string& folder) {
    REQUIRE(run_trilens("man --all " + folder).exit_code == 0);
    std::vector<fs::path> pages;
    for (const auto& entry : fs::directory_iterator(folder)) pages.push_back(entry.path());
    return pages;
}

/// The words that bash offers for the last of these.
std::string offered_by_bash(const std::string& script, const std::string& words) {
    return output_of("cd " + fs::path(script).parent_path().string() + "; bash -c '. " + script +
                     "; COMP_WORDS=(" + words +
                     "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _trilens; echo ${COMPREPLY[*]}'");
}

}  // namespace

TEST_CASE("there is a page for every command, and one command prints it", "[cli][manual]") {
    const std::string folder = scratch_dir("cli_manual_pages");
    CHECK(written_pages(folder).size() == 36);
    CHECK(bytes_of(folder + "/trilens-sweep-run.1") == run_trilens("man sweep run").out);
    const std::string page = bytes_of(folder + "/trilens-render.1");
    for (const char* words : {".TH TRILENS\\-RENDER 1", "\\fB\\-n\\fR, \\fB\\-\\-resolution\\fR \\fIN\\fR",
                              "(an integer from 1 to 1024)", ".SH EXAMPLES", ".SH EXIT STATUS"}) {
        INFO(words);
        CHECK(page.find(words) != std::string::npos);
    }
    CHECK(run_trilens("man rendr").exit_code == 2);
    CHECK(run_trilens("man render run").exit_code == 2);
}

TEST_CASE("man has nothing to warn of in any page", "[cli][manual][oracle]") {
    if (!has_program("man")) TRILENS_SKIP("needs man");
    const std::string folder = scratch_dir("cli_manual_man");
    for (const fs::path& page : written_pages(folder)) {
        INFO(page);
        CHECK(output_of("man --warnings -E UTF-8 -l -Tutf8 " + page.string() + " 2>&1 >/dev/null").empty());
        CHECK(output_of("man -l " + page.string()).find("NAME") != std::string::npos);
    }
}

TEST_CASE("mandoc has nothing to warn of in any page", "[cli][manual][oracle]") {
    if (!has_program("mandoc")) TRILENS_SKIP("needs mandoc");
    for (const fs::path& page : written_pages(scratch_dir("cli_manual_mandoc"))) {
        INFO(page);
        CHECK(output_of("mandoc -Tlint " + page.string()).empty());
    }
}

TEST_CASE("bash completes commands, options, choices, examples and files", "[cli][manual]") {
    if (!has_program("bash")) TRILENS_SKIP("needs bash");
    const std::string folder = scratch_dir("cli_manual_bash");
    const std::string script = write_file(folder, "trilens.bash", run_trilens("completion bash").out);
    for (const char* file : {"room.json", "room.exr", "notes.txt"}) write_file(folder, file, "");
    const auto offered = [&](const std::string& words) { return offered_by_bash(script, words); };
    CHECK(offered("trilens re") == "render report\n");
    CHECK(offered("trilens render --eng") == "--engine\n");
    CHECK(offered("trilens render --engine \"\"") == "exact classic envmap planar\n");
    CHECK(offered("trilens render --engine = c") == "classic\n");
    CHECK(offered("trilens -q sweep \"\"") == "run plan status report merge schema submit\n");
    CHECK(offered("trilens scene example mirror-s") == "mirror-sphere\n");
    CHECK(offered("trilens render room") == "room.json room.exr\n");
    CHECK(offered("trilens render --resolution \"\"") == "\n");
    CHECK(offered("trilens project --points n") == "notes.txt\n");
    CHECK(offered("trilens completion z") == "zsh\n");
    CHECK(offered("trilens compare a.exr b.exr --hard") == "--hardfail\n");
}

TEST_CASE("fish completes commands, options, choices and examples", "[cli][manual]") {
    if (!has_program("fish")) TRILENS_SKIP("needs fish");
    const std::string folder = scratch_dir("cli_manual_fish");
    const std::string script = write_file(folder, "trilens.fish", run_trilens("completion fish").out);
    const auto offered = [&](const std::string& line) {
        return output_of("HOME=" + folder + " fish --no-config -c 'source " + script + "; complete -C \"" +
                         line + "\"'");
    };
    CHECK(offered("trilens scene example mirror-").find("mirror-sphere") != std::string::npos);
    CHECK(offered("trilens render --engine c").find("classic") == 0);
    CHECK(offered("trilens sweep sta").find("status\t") == 0);
    CHECK(offered("trilens compare --hardf").find("--hardfail\t") == 0);
}

TEST_CASE("zsh takes its completion", "[cli][manual]") {
    if (!has_program("zsh")) TRILENS_SKIP("needs zsh");
    const std::string folder = scratch_dir("cli_manual_zsh");
    const std::string script = write_file(folder, "_trilens", run_trilens("completion zsh").out);
    CHECK(output_of("zsh -f -n " + script).empty());
    CHECK(output_of(
              "cd " + folder +
              "; zsh -f -c 'autoload -U compinit; compinit -u -D; source ./_trilens; print $_comps[trilens]; "
              "whence -w _trilens_sweep_run'") == "_trilens\n_trilens_sweep_run: function\n");
}
