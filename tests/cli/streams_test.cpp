// Standard input as the scene, standard output for the picture, what -q and -v say, answers that never
// replace an input, and signals while a pipe is read.
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>

#include "cli/command_line.h"
#include "support/test.h"

using namespace trilens_test;
namespace fs = std::filesystem;

TEST_CASE("a scene on standard input and an image on standard output are those of files", "[cli][streams]") {
    const std::string folder = scratch_dir("cli_streams");
    const std::string scene = write_file(folder, "room.json", small_scene());
    REQUIRE(run_trilens("render " + scene + " -n 2 -o " + folder + "/file.exr").exit_code == 0);
    REQUIRE(run_trilens("render " + scene + " -n 2 -o " + folder + "/file.png").exit_code == 0);
    REQUIRE(run_trilens("render " + scene + " -o " + folder + "/file.svg").exit_code == 0);

    const CommandRun exr = run_trilens("render " + scene + " -n 2 -o -");
    CHECK(exr.exit_code == 0);
    CHECK(exr.err.empty());
    CHECK(exr.out == bytes_of(folder + "/file.exr"));
    CHECK(run_trilens("render - -n 2 --format png -o - < " + scene).out == bytes_of(folder + "/file.png"));
    CHECK(run_trilens("render - --format svg -o - < " + scene).out == bytes_of(folder + "/file.svg"));
    CHECK(run_trilens("scene validate - < " + scene).exit_code == 0);

    const CommandRun traced =
        run_trilens("trace " + scene + " --format png -o - --json=" + folder + "/a.json");
    CHECK(traced.exit_code == 0);
    CHECK(traced.out.substr(1, 3) == "PNG");
    CHECK(bytes_of(folder + "/a.json").find("\"status\": \"ok\"") != std::string::npos);
    const CommandRun both = run_trilens("render " + scene + " -o - --json");
    CHECK(both.exit_code == 2);
    CHECK(both.err.find("standard output") != std::string::npos);
    CHECK(run_trilens("render " + scene + " -o - --pixel 3,3").exit_code == 2);
}

TEST_CASE("a bad scene on standard input is told as such", "[cli][streams][bad-input]") {
    const CommandRun empty = run_trilens("render - -o - < /dev/null");
    CHECK(empty.exit_code == 3);
    CHECK(empty.err.find("standard input: is empty") != std::string::npos);
    const std::string folder = scratch_dir("cli_streams_bad");
    const std::string bad =
        write_file(folder, "bad.json", replaced(small_scene(), "\"radius\": 1", "\"radius\": 0"));
    const CommandRun run = run_trilens("render - -o - < " + bad);
    CHECK(run.exit_code == 3);
    CHECK(run.out.empty());
    CHECK(run.err.find("standard input: /meshes/0/primitive/radius") != std::string::npos);
}

TEST_CASE(
    "more facets than pixels, whatever their samples: trace is advised, and fewer facets where there can be "
    "fewer",
    "[cli][streams]") {
    const std::string folder = scratch_dir("cli_streams_facets");
    const std::string scene = write_file(folder, "room.json", small_scene());
    const std::string render = "render " + scene + " -n 128 -o " + folder + "/a.exr --size ";
    const std::string advice = "pixels: trace is exact and takes less time", fewer = "; with -n ";
    const std::string few_pixels = run_trilens(render + "4x4").err,
                      pixels = run_trilens(render + "64x48").err;
    CHECK(few_pixels.find(advice) != std::string::npos);
    CHECK(few_pixels.find(fewer) == std::string::npos);
    CHECK(pixels.find(advice + fewer) != std::string::npos);
    CHECK(run_trilens(render + "64x48 --spp 8").err.find(advice + fewer) != std::string::npos);
}

TEST_CASE("--quiet says errors only; -v says versions, what was read and the stages with seconds",
          "[cli][streams]") {
    const std::string folder = scratch_dir("cli_streams_talk");
    // An unused material is worth a warning.
    const std::string scene =
        write_file(folder, "room.json",
                   replaced(small_scene(), "\"materials\": [", "\"materials\": [ {\"name\": \"spare\"},"));
    const std::string render = "render " + scene + " -n 2 -o " + folder + "/a.exr";
    CHECK(run_trilens(render).err.find("warning: ") != std::string::npos);
    const CommandRun quiet = run_trilens(render + " -q");
    CHECK(quiet.exit_code == 0);
    CHECK(quiet.err.empty());
    CHECK(quiet.out.empty());
    const CommandRun verdict = run_trilens("compare -q " + folder + "/a.exr " + folder + "/a.exr");
    CHECK(verdict.exit_code == 0);
    CHECK((verdict.out + verdict.err).empty());
    CHECK(run_trilens("scene schema -q").out == run_trilens("scene schema").out);
    CHECK(run_trilens("render -q nothing.json -o " + folder + "/b.exr").err.find("nothing.json") !=
          std::string::npos);

    const std::string said = run_trilens(render + " -v").err;
    INFO(said);
    for (const char* words : {"OpenImageIO", "Embree", "threads", "read ", "1 optics", "film 32 x 24",
                              "drew 32 x 24", "wrote ", "a.exr", " s)"})
        CHECK(said.find(words) != std::string::npos);
    CHECK(run_trilens("compare -v " + folder + "/a.exr " + folder + "/a.exr").err.find("channels") !=
          std::string::npos);
}

TEST_CASE("no answer replaces an input, not even the one that tells of the refusal", "[cli][streams]") {
    const std::string folder = scratch_dir("cli_streams_json");
    const std::string scene = write_file(folder, "room.json", small_scene());
    const std::string points = write_file(folder, "points.csv", "0,0,2\n");
    REQUIRE(run_trilens("render " + scene + " -n 2 -o " + folder + "/a.exr").exit_code == 0);
    const std::string image = bytes_of(folder + "/a.exr");
    const auto check_refused = [&](const std::string& arguments) {
        INFO(arguments);
        const CommandRun run = run_trilens(arguments);
        CHECK(run.exit_code == 2);
        CHECK(run.err.find("trilens: error: ") == 0);
        CHECK(bytes_of(scene) == small_scene());
        CHECK(bytes_of(points) == "0,0,2\n");
        CHECK(bytes_of(folder + "/a.exr") == image);
    };
    const std::string other = " -o " + folder + "/b.exr";
    check_refused("render " + scene + other + " --json=" + scene);
    check_refused("render " + scene + other + " --json=" + folder + "/../cli_streams_json/room.json");
    check_refused("render " + scene + other + " --no-such-option --json=" + scene);
    check_refused("scene info " + scene + " --json=" + scene);
    check_refused("scene validate " + scene + " --json=" + scene);
    check_refused("sweep run " + scene + " -o " + folder + "/out --json=" + scene);
    check_refused("project " + scene + " --points " + points + " --json=" + points);
    check_refused("project " + scene + " --points=" + points + " --bad --json=" + points);
    check_refused("compare " + folder + "/a.exr " + folder + "/a.exr --json=" + folder + "/a.exr");
    check_refused("compare " + folder + "/a.exr " + folder + "/a.exr -o " + folder + "/a.exr");
    check_refused("render " + scene + other + " --json=" + folder + "/b.exr");
    CHECK(!fs::exists(folder + "/b.exr"));
}

namespace {

/// Starts `trilens render PIPE` on a pipe that nobody closes, sends the signal once it reads, and says how it
/// ended and how long that took.
struct Ended {
    int exit_code = -1;
    double seconds = 0;
};

Ended end_while_reading(const std::string& folder, int signal) {
    const std::string pipe = folder + "/endless.json";
    fs::remove(pipe);
    REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
    const std::string program = trilens_test::build_dir() + "/trilens", output = folder + "/out.exr";
    const pid_t child = fork();
    if (child == 0) {
        if (!std::freopen((folder + "/said.txt").c_str(), "w", stderr)) _exit(99);
        if (!std::freopen((folder + "/answer.json").c_str(), "w", stdout)) _exit(99);
        execl(program.c_str(), "trilens", "render", pipe.c_str(), "-o", output.c_str(), "--json", nullptr);
        _exit(99);
    }
    // Opening waits for the reader.
    std::FILE* writer = std::fopen(pipe.c_str(), "w");
    REQUIRE(writer);
    std::fputs("{ \"version\": 1,", writer);
    std::fflush(writer);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    const auto start = std::chrono::steady_clock::now();
    kill(child, signal);
    int status = 0;
    pid_t done = 0;
    for (int tries = 0; tries < 1000 && done == 0; ++tries) {
        done = waitpid(child, &status, WNOHANG);
        if (done == 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (done == 0) {
        kill(child, SIGKILL);
        waitpid(child, &status, 0);
    }
    std::fclose(writer);
    return {done != 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1, seconds};
}

}  // namespace

TEST_CASE("a signal ends the command while it reads a pipe that never ends", "[cli][streams]") {
    const std::string folder = scratch_dir("cli_streams_signal");
    for (const auto& [signal, code] : {std::pair{SIGTERM, 143}, std::pair{SIGINT, 130}}) {
        const Ended ended = end_while_reading(folder, signal);
        CHECK(ended.exit_code == code);
        CHECK(bytes_of(folder + "/said.txt") == "trilens: error: interrupted\n");
        CHECK(bytes_of(folder + "/answer.json").find("\"exit_code\": " + std::to_string(code)) !=
              std::string::npos);
        CHECK(!fs::exists(folder + "/out.exr"));
    }
}

TEST_CASE("an answer that standard output cannot take is an error, however long it is", "[cli][streams]") {
    const std::string folder = scratch_dir("cli_streams_full");
    const std::string scene = write_file(folder, "room.json", small_scene());
    std::string points;
    for (int k = 0; k < 200; ++k) points += "0.1,0.2," + std::to_string(0.01 * k) + "\n";
    const std::string many = write_file(folder, "points.csv", points);
    for (const std::string& words :
         {std::string("scene example mirror-sphere"), std::string("scene schema"), std::string("help render"),
          std::string("man render"), std::string("completion bash"),
          "project " + scene + " -q --points " + many}) {
        const std::string said = folder + "/said.txt";
        const CommandRun run = run_trilens(words + " > /dev/full 2> " + said + "; exit $?;");
        INFO(words << "\n" << bytes_of(said));
        CHECK(run.exit_code == 4);
        CHECK(bytes_of(said).find("standard output: cannot be written") != std::string::npos);
    }
}
