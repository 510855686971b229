// What the command says of command lines that it does not take: one line in its own words, with the option
// and what it takes.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "support/test.h"

using namespace trilens_test;

namespace {

/// Exit 2, one line on stderr, and these words in it.
void check_usage(const std::string& arguments, const std::vector<std::string>& says) {
    const CommandRun run = run_trilens(arguments);
    INFO("trilens " << arguments << "\n" << run.err);
    CHECK(run.exit_code == 2);
    CHECK(run.out.empty());
    CHECK(std::count(run.err.begin(), run.err.end(), '\n') == 1);
    CHECK(run.err.rfind("trilens: error: ", 0) == 0);
    for (const std::string& words : says) {
        INFO("must say: " << words);
        CHECK(run.err.find(words) != std::string::npos);
    }
}

}  // namespace

TEST_CASE("an unknown command is refused with the nearest, even where help is asked for",
          "[cli][usage][bad-input]") {
    check_usage("rendr --help", {"\"rendr\"", "'render'"});
    check_usage("help rendr", {"\"rendr\"", "'render'"});
    check_usage("sweep rnu --help", {"\"sweep rnu\"", "'run'"});
    check_usage("-t 1 rendr", {"\"rendr\""});
    check_usage("", {"a command is required", "render"});
    check_usage("sweep", {"a command is required", "run, plan", "trilens sweep --help"});
}

TEST_CASE("help of a command is the same in both ways of asking", "[cli][usage]") {
    for (const std::string command : {"render", "sweep", "sweep run", "scene example", ""}) {
        INFO(command);
        const CommandRun asked = run_trilens("help " + command), flagged = run_trilens(command + " --help");
        CHECK(asked.exit_code == 0);
        CHECK(flagged.exit_code == 0);
        CHECK(asked.out == flagged.out);
        CHECK(asked.out.find("Usage: trilens" + (command.empty() ? "" : " " + command)) != std::string::npos);
        CHECK(asked.out.find("--verbose") != std::string::npos);
    }
    CHECK(run_trilens("render --help").out.find("trilens render scene.json -n 16") != std::string::npos);
}

TEST_CASE("every kind of bad option is told in one line with what the option takes", "[cli][usage]") {
    check_usage("render", {"needs SCENE", "scene file"});
    check_usage("sweep run a.json", {"-o/--output DIR", "folder for the results"});
    check_usage("completion", {"needs SHELL"});
    check_usage("render a.json -n many", {"-n/--resolution", "integer from 1 to 1024", "\"many\""});
    check_usage("render a.json -n 2.5", {"-n/--resolution", "integer", "\"2.5\""});
    check_usage("render a.json -n 1025", {"-n/--resolution", "from 1 to 1024", "\"1025\""});
    check_usage("render a.json -n 99999999999999999999", {"-n/--resolution"});
    check_usage("render a.json -n ''", {"-n/--resolution", "integer"});
    check_usage("render a.json -n", {"-n/--resolution", "nothing follows"});
    check_usage("render a.json -o", {"-o/--output takes OUT", "nothing follows"});
    check_usage("render a.json -n 2 -n 3", {"-n/--resolution takes one value", "2 times"});
    check_usage("render a.json -n ball=", {"-n/--resolution", "NAME=N"});
    check_usage("render a.json --engine exct",
                {"--engine takes exact, classic, envmap or planar", "'exact'"});
    check_usage("render a.json --slices 2 --tessellate 2", {"--tessellate", "--slices", "exclude"});
    check_usage("render a.json b.json", {"no further argument \"b.json\""});
    check_usage("render a.json --quiet=3", {"-q/--quiet takes no value"});
    check_usage("render a.json -q=3", {"-q/--quiet takes no value"});
    check_usage("sweep plan a.json -o --zip", {"-o", "but --zip follows it"});
    check_usage("render a.json --camera --size 3x3", {"--camera", "but --size follows it"});
    check_usage("render a.json -z", {"there is no option \"-z\"", "--help"});
    check_usage("render a.json --resolutoin=4", {"\"--resolutoin\"", "'--resolution'"});
    check_usage("compare a.exr b.exr --failpercent 101",
                {"--failpercent", "a number from 0 to 100", "\"101\""});
    check_usage("compare a.exr b.exr --fail nan", {"--fail", "a number of at least 0", "\"nan\""});
    check_usage("compare a.exr b.exr --mask-object -1", {"--mask-object", "\"-1\""});
    check_usage("compare a.exr b.exr --max rmsee=1", {"\"rmsee\"", "'rmse'"});
    check_usage("compare a.exr b.exr --max rmse", {"--max takes METRIC=VALUE", "\"rmse\""});
    check_usage("compare a.exr b.exr --max rmse=nan", {"--max", "\"rmse=nan\""});
    check_usage("compare a.exr b.exr --scale 2", {"--scale", ".png"});
    check_usage("compare a.exr b.exr --strict --ref-layer L", {"--strict", "--ref-layer"});
    check_usage("man render --all somewhere", {"--all"});
    check_usage("info --threads 5000", {"-t/--threads", "from 0 to 4096"});
    check_usage("info --progress loud", {"--progress takes auto, bar, plain, json or none"});
}

TEST_CASE("options that would do nothing are refused, each with its reason", "[cli][usage][bad-input]") {
    const std::string scene = write_file(scratch_dir("cli_usage_idle"), "room.json", small_scene());
    check_usage("trace " + scene + " -o out.exr --grid screen", {"--grid", "--surface facets"});
    check_usage("render " + scene + " -o out.exr --engine envmap --max-error 1", {"--max-error", "envmap"});
    check_usage("sweep run " + scene + " -o out --over engine=exact,planar --over max-error=0.5",
                {"max-error", "planar"});
    for (const char* ending : {"png", "svg", "obj"})
        check_usage("render " + scene + " -o out." + ending + " --aov all", {"--aov", ".exr", ending});
    for (const char* frames : {"--frames 0..2", "--turntable 3"})
        check_usage("render a.glb -o out.apng --time 1 " + std::string(frames), {"--time", "frames"});
    check_usage("project " + scene + " --point 0,0,3 --search complete --refine none",
                {"--refine none", "--search facets"});
}

TEST_CASE("project's table quotes the names of optics", "[cli]") {
    const std::string folder = scratch_dir("cli_project_names");
    const std::string scene =
        write_file(folder, "room.json", replaced(small_scene(), R"("name": "ball")", R"("name": "a,\"b\"")"));
    const CommandRun run = run_trilens("project " + scene + " --point 2,0,3");
    CHECK(run.exit_code == 0);
    CHECK(run.out.find(R"(,reflect,"a,""b""",)") != std::string::npos);
}

TEST_CASE("after -- a word is no option, whatever it begins with", "[cli][usage]") {
    const std::string folder = scratch_dir("cli_after_options");
    write_file(folder, "-n", small_scene());
    const std::string in_folder = "project --point 0,0,3 -q";
    const CommandRun named = run_trilens(in_folder + " " + folder + "/-n"),
                     after = run_trilens(in_folder + " --threads 1 -- " + folder + "/-n");
    CHECK(named.exit_code == 0);
    CHECK(after.exit_code == 0);
    CHECK(after.out == named.out);
    check_usage("render -q -- a.json -n", {"no further argument \"-n\""});
    check_usage("render -o a.exr --", {"needs SCENE"});
    const CommandRun missing = run_trilens("render -o a.exr -- --nothing.json");
    CHECK(missing.exit_code == 3);
    CHECK(missing.err.find("--nothing.json") != std::string::npos);
}

TEST_CASE("values that look like options, and groups of short ones, are read", "[cli][usage]") {
    const std::string folder = scratch_dir("cli_usage_values");
    const std::string scene = write_file(folder, "room.json", small_scene());
    CHECK(run_trilens("project " + scene + " -n 2 --point -1,2,3").exit_code == 0);
    CHECK(run_trilens("sweep plan -o " + folder + "/out " + scene + " --over resolution=1 " +
                      write_file(folder, "other.json", small_scene()))
              .exit_code == 0);
    CHECK(run_trilens("scene validate -n2 " + scene).exit_code == 0);
    CHECK(run_trilens("scene validate -qn 2 " + scene).exit_code == 0);
    CHECK(run_trilens("scene info -n 2 -n ball=5 " + scene).out.find("resolution 5") != std::string::npos);
    CHECK(run_trilens("scene info -n bal=5 " + scene).err.find("did you mean 'ball'?") != std::string::npos);
    CHECK(run_trilens("scene info --set=/film/width=16 " + scene).out.find("film 16 x 24") !=
          std::string::npos);
}

TEST_CASE("An option does not take the next one for its value", "[cli]") {
    const CommandRun run = run_trilens("sweep plan a.json -o --json");
    CHECK(run.exit_code == 2);
    CHECK(run.err.find("but --json follows it") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists("--json=-"));
}
