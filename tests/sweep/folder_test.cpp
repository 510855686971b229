// A folder belongs to one sweep, and to as many processes of it as there are.
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "base/files/files.h"
#include "base/util/error.h"
#include "support/test.h"
#include "sweep/fake_scene.h"
#include "sweep/report/gallery.h"
#include "sweep/run/sweep.h"
#include "sweep/store/sweep_folder.h"

using namespace trilens;
using trilens_test::FakeSweep;
namespace fs = std::filesystem;

namespace {

std::string message_of(const std::function<void()>& work) {
    try {
        work();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// Every file of the folder with its bytes, but for locks.
std::vector<std::string> content_of(const std::string& folder) {
    std::vector<std::string> content;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file() && entry.path().filename().string().find("lock") == std::string::npos)
            content.push_back(entry.path().string() + read_whole_file(entry.path().string()).value());
    std::sort(content.begin(), content.end());
    return content;
}

constexpr const char* kWorker = "sweep: one process of several (started by the tests of shared folders)";

/// What a process of its own does: kWorker, below.
struct WorkerOrders {
    std::string folder;
    bool truth_per_run = false;
    int hang_at = 0;  // never returns from rendering this n; 0: none
};

/// A process of its own in which this program runs kWorker alone; its exit code is 0 where that passes.
pid_t start_worker(const WorkerOrders& orders) {
    const pid_t child = fork();
    REQUIRE(child >= 0);
    if (child > 0) return child;
    prctl(PR_SET_PDEATHSIG, SIGKILL);  // a test that ends early leaves no process behind
    setenv("TRILENS_TEST_WORKER_FOLDER", orders.folder.c_str(), 1);
    setenv("TRILENS_TEST_WORKER_TRUTH", orders.truth_per_run ? "per run" : "shared", 1);
    setenv("TRILENS_TEST_WORKER_HANG", std::to_string(orders.hang_at).c_str(), 1);
    execl("/proc/self/exe", "tests", kWorker, static_cast<char*>(nullptr));
    _exit(127);
}

/// Until the child has made it; fails where the child ends before.
void wait_for_file(const std::string& file, pid_t child) {
    while (!fs::exists(file)) {
        REQUIRE(waitpid(child, nullptr, WNOHANG) == 0);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
}

int exit_code_of(pid_t child) {
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

TEST_CASE("sweep: a folder of one sweep refuses another, names both, and stays as it is", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("folder_owner"), {1, 2});
    fake.params.subject.scene_name = "../one.json";
    fake.params.subject.scene_digest = "digest 1";
    fake.run();
    const std::vector<std::string> before = content_of(fake.params.folder);

    FakeSweep other(fake.params.folder, {1, 2});
    other.params.subject.scene_name = "../one.json";
    other.params.subject.scene_digest = "digest 2";
    std::string named;
    SECTION("another scene") {
        named = other.params.subject.scene_name = "../two.json";
    }
    SECTION("another camera") {
        named = other.params.subject.camera = "side";
    }
    SECTION("another truth") {
        named = other.params.subject.truth = "facets";
    }
    SECTION("another axis") {
        named = other.params.axes.axes[0].kind.name = "/materials/0/ior";
    }
    CHECK_THROWS_AS(other.run(), UsageError);
    CHECK_THROWS_AS(plan_sweep(other.params, other.callbacks), UsageError);
    const std::string message = message_of([&] { other.run(); });
    INFO(message);
    CHECK(contains(message, "../one.json"));
    CHECK(contains(message, named));
    CHECK(contains(message, "--replace"));
    CHECK(other.renders + other.traces == 0);
    CHECK(content_of(fake.params.folder) == before);

    other.params.replace = true;
    other.run();
    CHECK((other.renders == 2 && other.traces == 1));
    CHECK(load_sweep(fake.params.folder).manifest.subject.camera == other.params.subject.camera);
    CHECK_THROWS_AS(fake.run(), UsageError);
}

TEST_CASE("sweep: the same sweep goes on in its folder: more values, an edited scene, a moved one",
          "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("folder_same"), {1, 2});
    fake.params.subject.scene_name = "../one.json";
    fake.params.subject.scene_digest = "digest 1";
    fake.run();
    SECTION("more values") {
        fake.params.axes = trilens_test::resolution_axes({1, 2, 4});
    }
    SECTION("edited") {
        fake.params.subject.scene_digest = "digest 2";
    }
    SECTION("moved") {
        fake.params.subject.scene_name = "../../elsewhere/one.json";
    }
    CHECK_NOTHROW(fake.run());
}

TEST_CASE("sweep: replacing removes what sweeps write, all of it and nothing else", "[sweep]") {
    const std::string folder = trilens_test::scratch_dir("folder_replace");
    replace_text_file(folder + "/runs.csv", "not a sweep's");
    clear_folder(folder);  // no manifest: not a sweep's
    CHECK(fs::exists(folder + "/runs.csv"));
    fs::remove(folder + "/runs.csv");

    FakeSweep fake(folder, {1, 2});
    fake.run();
    replace_text_file(folder + "/notes.txt", "mine");
    {
        const FileLock user = FileLock::wait(folder + "/lock", LockKind::kMany, {});
        CHECK_THROWS_AS(clear_folder(folder), UsageError);
        CHECK(load_sweep(folder).count(RunState::kDone) == 2);
    }
    clear_folder(folder);
    std::vector<std::string> left;
    for (const auto& entry : fs::directory_iterator(folder)) left.push_back(entry.path().filename());
    std::sort(left.begin(), left.end());
    CHECK(left == std::vector<std::string>{"lock", "notes.txt", "plan.lock"});

    // A manifest that cannot be read is somebody's: refused, and replaced when that is asked for.
    replace_text_file(folder + "/manifest.json", "{}");
    CHECK_THROWS_AS(fake.run(), InputError);
    CHECK(contains(message_of([&] { fake.run(); }), "--replace"));
    for (const char* foreign : {"<html>", "[]", "{}", R"({"subject": 3})"}) {
        replace_text_file(folder + "/manifest.json", foreign);
        const std::string message = message_of([&] { fake.run(); });
        INFO(message);
        CHECK(contains(message, "manifest.json: is no part of a sweep's results: "));
        CHECK_FALSE(contains(message, "json.exception"));
    }
    fake.params.replace = true;
    CHECK(fake.run().count(RunState::kDone) == 2);
}

TEST_CASE("sweep: finished runs of other values stay, are counted, and are in no table", "[sweep]") {
    const std::string folder = trilens_test::scratch_dir("folder_others");
    FakeSweep fake(folder, {1, 2, 4});
    CHECK(fake.run().other_runs == 0);
    fake.params.axes = trilens_test::resolution_axes({4, 8});
    fake.renders = 0;
    const SweepSummary summary = fake.run();
    CHECK(fake.renders == 1);
    CHECK(summary.runs.size() == 2);
    CHECK(summary.other_runs == 2);
    CHECK(load_sweep(folder).other_runs == 2);
    const std::string table = read_whole_file(folder + "/runs.csv").value();
    CHECK_FALSE(contains(table, "n0002"));
    CHECK(fs::exists(folder + "/runs/n0002/DONE"));
    fs::remove(folder + "/runs/n0002/DONE");
    CHECK(load_sweep(folder).other_runs == 1);
}

TEST_CASE("sweep: while a process is at a folder, others join it with the same values only", "[sweep]") {
    const std::string folder = trilens_test::scratch_dir("folder_joined");
    FakeSweep fake(folder, {1, 2});
    fake.run();
    const std::string plan = read_whole_file(folder + "/plan.jsonl").value();
    {
        const FileLock other = FileLock::wait(folder + "/lock", LockKind::kMany, {});
        CHECK_NOTHROW(fake.run());
        fake.params.axes = trilens_test::resolution_axes({1, 2, 3});
        CHECK(contains(message_of([&] { fake.run(); }), "is being swept with other values"));
        CHECK_THROWS_AS(fake.run(), UsageError);
        CHECK(read_whole_file(folder + "/plan.jsonl") == plan);
    }
    CHECK(fake.run().runs.size() == 3);
}

TEST_CASE("sweep: a gallery's folder takes no sweep, and a sweep's folder no gallery", "[sweep]") {
    const std::string folder = trilens_test::scratch_dir("folder_gallery");
    FakeSweep below(folder + "/ball", {1});
    const SweepSummary summary = below.run();
    FakeSweep above(folder, {1});
    CHECK(contains(message_of([&] { above.run(); }), "ball"));
    CHECK_THROWS_AS(above.run(), UsageError);
    CHECK_THROWS_AS(require_no_sweep(folder + "/ball"), UsageError);
    CHECK_NOTHROW(require_no_sweep(folder));
    write_sweep_gallery(folder, std::vector<SweepSummary>{summary});
    CHECK_NOTHROW(write_sweep_gallery(folder, std::vector<SweepSummary>{summary}));
    const std::string other = trilens_test::scratch_dir("folder_own_report");
    replace_text_file(other + "/report.html", "mine");
    CHECK_THROWS_AS(require_no_sweep(other), UsageError);
    CHECK_THROWS_AS(write_sweep_gallery(folder + "/ball", std::vector<SweepSummary>{summary}), UsageError);
}

TEST_CASE("sweep: locks exclude, are shared, and end with their holder", "[sweep]") {
    const std::string file = trilens_test::scratch_dir("folder_locks") + "/lock";
    {
        const auto one = FileLock::try_lock(file, LockKind::kOne);
        REQUIRE(one);
        CHECK(!FileLock::try_lock(file, LockKind::kOne));
        CHECK(!FileLock::try_lock(file, LockKind::kMany));
        std::atomic<bool> cancel{true};
        Progress cancelled;
        cancelled.cancel = &cancel;
        CHECK_THROWS_AS(FileLock::wait(file, LockKind::kOne, cancelled), Interrupted);
    }
    {
        const auto some = FileLock::try_lock(file, LockKind::kMany);
        CHECK(FileLock::try_lock(file, LockKind::kMany));
        CHECK(!FileLock::try_lock(file, LockKind::kOne));
    }
    CHECK(FileLock::try_lock(file, LockKind::kOne));
    CHECK_THROWS_AS(FileLock::try_lock(file + "/none", LockKind::kOne), OutputError);
}

TEST_CASE("sweep: one process of several (started by the tests of shared folders)", "[.]") {
    const char* const given = std::getenv("TRILENS_TEST_WORKER_FOLDER");
    REQUIRE(given != nullptr);
    const std::string folder = given, log = folder + "/log";
    const int hang_at = std::stoi(std::getenv("TRILENS_TEST_WORKER_HANG"));
    const auto note = [&](const std::string& line) {
        const FileLock lock = FileLock::wait(log + ".lock", LockKind::kOne, {});
        replace_text_file(log, read_whole_file(log).value_or("") + line + "\n");
    };
    FakeSweep fake(folder + "/sweep", {1, 2, 4, 8, 16});
    fake.truth_per_run = std::getenv("TRILENS_TEST_WORKER_TRUTH") == std::string("per run");
    fake.before_render = [&](int n) {
        note("render " + std::to_string(n));
        if (n == hang_at) replace_text_file(folder + "/hanging", "");
        while (n == hang_at) pause();
        if (n == 4) throw ComputationError("a run that fails");
    };
    fake.trace = [&](int n) {
        note(fake.truth_per_run ? "trace " + std::to_string(n) : "trace");
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        return trilens_test::fake_image(0, 0);
    };
    const SweepSummary summary = fake.run();
    CHECK(summary.count(RunState::kDone) == 4);
    CHECK(summary.count(RunState::kFailed) == 1);
}

TEST_CASE("sweep: processes at one folder at once do every run and the truth once, and all see the end",
          "[sweep]") {
    const bool truth_per_run = GENERATE(false, true);
    const std::string folder = trilens_test::scratch_dir("folder_processes");
    std::vector<pid_t> children;
    for (int process = 0; process < 3; ++process)
        children.push_back(start_worker({folder, truth_per_run, 0}));
    for (const pid_t child : children) CHECK(exit_code_of(child) == 0);

    std::map<std::string, int> times;
    const std::string text = read_whole_file(folder + "/log").value();
    for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
        ++times[text.substr(at, text.find('\n', at) - at)];
    CHECK(times.size() == (truth_per_run ? 10u : 6u));
    for (const auto& [line, count] : times) {
        INFO(line);
        CHECK((count == 1 ||
               (line == "render 4" && count <= 3)));  // a failure is tried again by who comes later
    }
}

TEST_CASE(
    "sweep: who sums up while a failed run is tried again sees the failure, and after it what came of it",
    "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("folder_retry"), {1, 2});
    fake.before_render = [](int n) {
        if (n == 2) throw ComputationError("hard");
    };
    fake.run();
    const bool is_mended = GENERATE(false, true);
    FakeSweep again(fake.params.folder, {1, 2});
    RunRecord meanwhile;
    again.before_render = [&](int n) {
        meanwhile = load_sweep(fake.params.folder).runs[1];
        if (n == 2 && !is_mended) throw ComputationError("still hard");
    };
    const RunRecord after = again.run().runs[1];
    CHECK(again.renders == 1);
    CHECK(meanwhile.state == RunState::kFailed);
    CHECK(meanwhile.error == "hard");
    CHECK(after.state == (is_mended ? RunState::kDone : RunState::kFailed));
    CHECK(after.error == (is_mended ? "" : "still hard"));
}

TEST_CASE("sweep: what a killed process was at is done by the next, which waits for nobody", "[sweep]") {
    const std::string folder = trilens_test::scratch_dir("folder_killed");
    const pid_t child = start_worker({folder, false, 2});
    wait_for_file(folder + "/hanging", child);
    const std::string lock = run_folder(folder + "/sweep", "n0002") + "/lock";
    CHECK(!FileLock::try_lock(lock, LockKind::kOne));
    CHECK_THROWS_AS(clear_folder(folder + "/sweep"), UsageError);
    kill(child, SIGKILL);
    CHECK(exit_code_of(child) == 128 + SIGKILL);
    CHECK(FileLock::try_lock(lock, LockKind::kOne));
    FakeSweep next(folder + "/sweep", {1, 2, 4, 8, 16});
    CHECK(next.run().count(RunState::kDone) == 5);
    CHECK((next.renders == 4 && next.traces == 0));
}

TEST_CASE("sweep: a truth of each run: traced at its n, kept by itself, and a failure of its run alone",
          "[sweep][golden]") {
    FakeSweep fake(trilens_test::scratch_dir("folder_truths"), {2, 4, 8});
    fake.truth_per_run = true;
    std::vector<int> traced;
    bool is_hard = true;
    fake.trace = [&](int n) {
        traced.push_back(n);
        if (n == 4 && is_hard) throw ComputationError("no truth");
        const double fall = std::pow(n, -2);
        return trilens_test::fake_image(trilens_test::kLeftConstant * fall,
                                        trilens_test::kRightConstant * fall);
    };
    SweepSummary summary = fake.run();
    CHECK(traced == std::vector<int>{2, 4, 8});
    CHECK(summary.runs[1].state == RunState::kFailed);
    CHECK(summary.runs[1].error == "no truth");
    is_hard = false;
    summary = fake.run();
    CHECK(traced == std::vector<int>{2, 4, 8, 4});
    for (const RunRecord& run : summary.runs) {
        CHECK(run.metrics.at("disp_max_px") == 0);
        CHECK(fs::exists(truth_file(fake.params.folder, run.plan.truth)));
    }
    CHECK(summary.runs[0].plan.truth != summary.runs[1].plan.truth);

    // Shared truths are one.
    fake.truth_per_run = false;
    fake.params.replace = true;
    summary = fake.run();
    CHECK(summary.runs[0].plan.truth == summary.runs[2].plan.truth);
}
