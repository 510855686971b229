// What was finished is never done again, and nothing else counts as finished.
#include <atomic>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/files/files.h"
#include "base/util/error.h"
#include "support/test.h"
#include "sweep/fake_scene.h"
#include "sweep/run/sweep.h"

using namespace trilens;
using trilens_test::FakeSweep;
namespace fs = std::filesystem;

namespace {

struct Calls {
    int renders, traces;
    bool operator==(const Calls& other) const { return renders == other.renders && traces == other.traces; }
};

/// Runs again and says what was asked for this time.
Calls calls_of_run(FakeSweep& fake) {
    fake.renders = fake.traces = 0;
    fake.run();
    return {fake.renders, fake.traces};
}

void damage(const std::string& file) {
    std::string text = read_whole_file(file).value();
    text[text.size() / 2] = static_cast<char>(text[text.size() / 2] ^ 1);
    replace_text_file(file, text);
}

}  // namespace

TEST_CASE("sweep: a second run renders nothing and writes the same tables", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("resume_twice"), {1, 2, 4});
    CHECK(calls_of_run(fake) == Calls{3, 1});
    const std::string csv = read_whole_file(fake.params.folder + "/runs.csv").value();
    const std::string html = read_whole_file(fake.params.folder + "/report.html").value();
    CHECK(calls_of_run(fake) == Calls{0, 0});
    CHECK(read_whole_file(fake.params.folder + "/runs.csv") == csv);
    CHECK(read_whole_file(fake.params.folder + "/report.html") == html);
}

TEST_CASE("sweep: what changed is done again, and only that", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("resume_changed"), {1, 2, 4});
    fake.truth_key = "truth 1";
    const std::string runs = fake.params.folder + "/runs/";
    fake.run();

    SECTION("the key: every run, but not the truth that has its own") {
        fake.job_key = "scene 2";
        CHECK(calls_of_run(fake) == Calls{3, 0});
    }
    SECTION("the truth's key: everything") {
        fake.truth_key = "truth 2";
        CHECK(calls_of_run(fake) == Calls{3, 1});
    }
    SECTION("one key for both: everything") {
        fake.truth_key = "";
        CHECK(calls_of_run(fake) == Calls{3, 1});
    }
    SECTION("the optics") {
        fake.optics.pop_back();
        CHECK(calls_of_run(fake) == Calls{3, 0});
    }
    SECTION("words that change no number: nothing") {
        fake.params.subject.title = "another";
        CHECK(calls_of_run(fake) == Calls{0, 0});
    }
    SECTION("a finer axis: what is new") {
        fake.params.axes = trilens_test::resolution_axes({2, 4, 8, 16});
        CHECK(calls_of_run(fake) == Calls{2, 0});
        CHECK(load_sweep(fake.params.folder).runs.size() == 4);
    }
    SECTION("no DONE: that run") {
        fs::remove(runs + "n0002/DONE");
        CHECK(load_sweep(fake.params.folder).count(RunState::kMissing) == 1);
        CHECK(calls_of_run(fake) == Calls{1, 0});
    }
    SECTION("damaged files: those runs") {
        damage(runs + "n0001/metrics.json");
        damage(runs + "n0002/image.exr");
        fs::remove(runs + "n0004/diff.exr");
        CHECK(load_sweep(fake.params.folder).count(RunState::kDone) == 0);
        CHECK(calls_of_run(fake) == Calls{3, 0});
    }
    SECTION("DONE of another run") {
        fs::copy_file(runs + "n0001/DONE", runs + "n0002/DONE", fs::copy_options::overwrite_existing);
        CHECK(calls_of_run(fake) == Calls{1, 0});
    }
    SECTION("a truth that cannot be read, once it is needed") {
        replace_text_file(truth_file(fake.params.folder, load_sweep(fake.params.folder).runs[0].plan.truth),
                          "no image");
        CHECK(calls_of_run(fake) == Calls{0, 0});
        fs::remove(runs + "n0002/DONE");
        CHECK(calls_of_run(fake) == Calls{1, 1});
    }
    CHECK(calls_of_run(fake) == Calls{0, 0});
}

TEST_CASE(
    "sweep: a run that fails is recorded with its message and code, the others go on, and it is tried "
    "again",
    "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("resume_failing"), {1, 2, 4, 8});
    fake.before_render = [](int n) {
        if (n == 2) throw ComputationError("3 pixels <are> not finite");
        if (n == 4) throw std::bad_alloc();
    };
    const SweepSummary summary = fake.run();
    CHECK(summary.count(RunState::kDone) == 2);
    CHECK(summary.count(RunState::kFailed) == 2);
    CHECK(summary.runs[1].error == "3 pixels <are> not finite");
    CHECK(summary.runs[1].exit_code == 5);
    CHECK(summary.runs[2].error == "out of memory");
    CHECK(load_sweep(fake.params.folder).runs[1].error == summary.runs[1].error);
    CHECK(read_whole_file(fake.params.folder + "/runs.csv").value().find(",failed,5,") != std::string::npos);
    CHECK(read_whole_file(fake.params.folder + "/report.html")
              .value()
              .find("3 pixels &lt;are&gt; not finite") != std::string::npos);

    fake.before_render = [](int) {};
    CHECK(calls_of_run(fake) == Calls{2, 0});
    CHECK(load_sweep(fake.params.folder).count(RunState::kDone) == 4);
    CHECK(!fs::exists(fake.params.folder + "/runs/n0002/error.json"));
}

TEST_CASE("sweep: an image that cannot be compared is a failed run", "[sweep][bad-input]") {
    FakeSweep fake(trilens_test::scratch_dir("resume_incomparable"), {1, 2});
    const auto render = fake.render;
    fake.render = [render](int n) {
        Image image = render(n);
        if (n == 1) image.channels.pop_back();
        return image;
    };
    const SweepSummary summary = fake.run();
    CHECK(summary.runs[0].state == RunState::kFailed);
    CHECK(summary.runs[0].exit_code == 3);
    CHECK(summary.runs[1].state == RunState::kDone);
}

TEST_CASE("sweep: without a truth there is no sweep; a bug in a callback is not a failed run", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("resume_no_truth"), {1, 2});
    const auto trace = fake.trace;
    fake.trace = [](int) -> Image { throw ComputationError("no truth"); };
    CHECK_THROWS_AS(fake.run(), ComputationError);
    CHECK(fake.renders == 0);
    fake.trace = trace;
    fake.before_render = [](int) { throw std::logic_error("bug"); };
    CHECK_THROWS_AS(fake.run(), std::logic_error);
    CHECK(load_sweep(fake.params.folder).count(RunState::kMissing) == 2);
}

TEST_CASE("sweep: an interrupted sweep keeps what was finished, says so in its tables, and goes on later",
          "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("resume_interrupted"), {1, 2, 4, 8});
    std::atomic<bool> cancel{false};
    fake.params.progress.cancel = &cancel;
    const bool within = GENERATE(false, true);
    fake.before_render = [&](int n) {
        if (n != 4) return;
        cancel = true;
        if (within) throw Interrupted();
    };
    CHECK_THROWS_AS(fake.run(), Interrupted);
    const std::size_t finished = within ? 2 : 3;
    const SweepSummary partial = load_sweep(fake.params.folder);
    CHECK(partial.count(RunState::kDone) == finished);
    CHECK(partial.count(RunState::kFailed) == 0);
    const std::string csv = read_whole_file(fake.params.folder + "/runs.csv").value();
    CHECK(csv.find(",missing,") != std::string::npos);
    CHECK(fs::exists(fake.params.folder + "/summary.json"));

    cancel = false;
    fake.before_render = [](int) {};
    CHECK(calls_of_run(fake) == Calls{4 - static_cast<int>(finished), 0});
}

TEST_CASE("sweep: progress rises from 0 to 1, and every run is told once", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("resume_progress"), {1, 2, 4});
    std::vector<double> shares;
    std::vector<std::string> told;
    fake.params.progress.report = [&](double share) { shares.push_back(share); };
    fake.params.on_run = [&](const RunRecord& run) { told.push_back(run.plan.id); };
    fake.run();
    REQUIRE(shares.size() >= 4);
    CHECK((shares.front() == 0 && shares.back() == 1));
    for (std::size_t i = 1; i < shares.size(); ++i) CHECK(shares[i] >= shares[i - 1]);
    CHECK(told == std::vector<std::string>{"n0001", "n0002", "n0004"});
}

TEST_CASE("sweep: shards in one folder add up to the sweep, and a plan alone runs nothing", "[sweep]") {
    FakeSweep whole(trilens_test::scratch_dir("resume_whole"), {1, 2, 4, 8, 16});
    whole.run();
    FakeSweep fake(trilens_test::scratch_dir("resume_shards"), {1, 2, 4, 8, 16});
    plan_sweep(fake.params, fake.callbacks);
    CHECK(fake.renders + fake.traces == 0);
    CHECK(load_sweep(fake.params.folder).count(RunState::kMissing) == 5);
    for (int i = 0; i < 3; ++i) {
        fake.params.shard = {i, 3};
        fake.run();
        CHECK(!fs::exists(fake.params.folder + "/runs.csv"));
    }
    CHECK((fake.renders == 5 && fake.traces == 1));
    const SweepSummary merged = report_sweep(fake.params.folder), expected = load_sweep(whole.params.folder);
    REQUIRE(merged.fits.size() == expected.fits.size());
    for (std::size_t i = 0; i < merged.fits.size(); ++i)
        CHECK(merged.fits[i].order == expected.fits[i].order);
    CHECK(fs::exists(fake.params.folder + "/report.html"));
}
