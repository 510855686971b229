// A sweep's folder may hold the files of others: they stay, whatever the sweep does.
#include "sweep/store/sweep_folder.h"

#include <filesystem>
#include <string>
#include <vector>

#include "base/files/files.h"
#include "base/util/error.h"
#include "report/page.h"
#include "support/test.h"
#include "sweep/fake_scene.h"
#include "sweep/report/sweep_pictures.h"
#include "sweep/run/sweep.h"

using namespace trilens;
using trilens_test::FakeSweep;
namespace fs = std::filesystem;

namespace {

/// Files that no sweep made, in the folders that a sweep writes to.
std::vector<std::string> put_files_of_others(const std::string& folder) {
    std::vector<std::string> files;
    for (const char* name :
         {"pictures/holiday.jpg", "pictures/n0001.png", "plots/figure.pdf", "plots/drawing.svg",
          "plots/chart.vl.json", "runs/notes.txt", "runs/n0001/mine.txt", "runs/holiday/image.exr",
          "truth/mine.exr", "notes.txt"}) {
        files.push_back(folder + "/" + name);
        make_folder(fs::path(files.back()).parent_path().string());
        replace_text_file(files.back(), "mine");
    }
    return files;
}

void check_untouched(const std::vector<std::string>& files) {
    for (const std::string& file : files) {
        INFO(file);
        CHECK(read_whole_file(file) == "mine");
    }
}

}  // namespace

TEST_CASE("sweep: files that it did not make stay: at the first run, at the next report, at --replace",
          "[sweep]") {
    const std::string folder = trilens_test::scratch_dir("own_files_stay");
    const std::vector<std::string> others = put_files_of_others(folder);
    FakeSweep fake(folder, {1, 2});
    fake.run();
    check_untouched(others);
    CHECK(fs::exists(folder + "/plots/time.svg"));
    report_sweep(folder);
    check_untouched(others);

    Report large;
    fill_runs(load_sweep(folder), 1000, large);
    CHECK(fs::exists(folder + "/pictures/n0001-1.png"));
    report_sweep(folder);
    CHECK_FALSE(fs::exists(folder + "/pictures/n0001-1.png"));
    check_untouched(others);

    replace_text_file(folder + "/runs/n0002/image.exr.123-4.part", "what a killed process leaves");
    clear_folder(folder);
    check_untouched(others);
    std::size_t left = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) left += entry.is_regular_file();
    CHECK(left == others.size() + 2);  // the locks
}

TEST_CASE("sweep: plots that a report no longer makes go, those of others stay", "[sweep]") {
    const std::string folder = trilens_test::scratch_dir("own_files_plots");
    FakeSweep fake(folder, {1, 2});
    fake.run();
    REQUIRE(fs::exists(folder + "/plots/reflect_disp_mean_px.svg"));
    replace_text_file(folder + "/plots/figure.svg", "mine");
    fake.render = [](int) { return trilens_test::fake_image(0, 0); };
    fake.job_key = "no errors";
    fake.run();
    CHECK_FALSE(fs::exists(folder + "/plots/reflect_disp_mean_px.svg"));
    check_untouched({folder + "/plots/figure.svg"});
}

TEST_CASE("sweep: a file in the place of one of its own is refused before work, or kept by the report",
          "[sweep][bad-input][golden]") {
    const std::string folder = trilens_test::scratch_dir("own_files_refused");
    FakeSweep fake(folder, {1, 2});
    SECTION("where the folder is no sweep's") {
        const std::string name = GENERATE("runs.csv", "summary.json", "report.html", "plan.jsonl");
        replace_text_file(folder + "/" + name, "mine");
        fake.params.replace = GENERATE(false, true);
        CHECK_THROWS_AS(fake.run(), UsageError);
        CHECK_THROWS_AS(plan_sweep(fake.params, fake.callbacks), UsageError);
        check_untouched({folder + "/" + name});
        CHECK_FALSE(fs::exists(folder + "/manifest.json"));
        CHECK(fake.renders + fake.traces == 0);
    }
    SECTION("where it is an input of the sweep, also of one that is there already") {
        if (GENERATE(false, true)) fake.run();
        fake.renders = fake.traces = 0;
        fake.params.replace = true;
        const std::string name = GENERATE("runs.csv", "manifest.json", "pictures/n0002-7.png",
                                          "truth/0123456789abcdef.exr", "runs/n0001/image.exr");
        fake.callbacks.inputs = [&] { return std::vector<std::string>{folder + "/plots/../" + name}; };
        make_folder(folder + "/plots");
        make_folder(fs::path(folder + "/" + name).parent_path().string());
        replace_text_file(folder + "/" + name, "mine");
        CHECK_THROWS_AS(fake.run(), UsageError);
        check_untouched({folder + "/" + name});
        CHECK(fake.renders + fake.traces == 0);
    }
    SECTION("where it has the name of a plot: what was computed stays, and the report follows later") {
        const std::string plot = folder + "/plots/time.svg";
        make_folder(folder + "/plots");
        replace_text_file(plot, "mine");
        CHECK_THROWS_AS(fake.run(), OutputError);
        check_untouched({plot});
        CHECK(load_sweep(folder).count(RunState::kDone) == 2);
        fs::remove(plot);
        CHECK_NOTHROW(report_sweep(folder));
        CHECK(fs::exists(plot));
    }
    SECTION("inputs beside what is written are none of its business") {
        fake.callbacks.inputs = [&] {
            return std::vector<std::string>{folder + "/scene.json", folder + "/pictures/wood.png",
                                            folder + "/../runs.csv"};
        };
        CHECK_NOTHROW(fake.run());
    }
}

TEST_CASE("sweep: a manifest of something else is replaced where that is asked for, and nothing beside it",
          "[sweep]") {
    const std::string folder = trilens_test::scratch_dir("own_files_manifest");
    const std::vector<std::string> others = put_files_of_others(folder);
    replace_text_file(folder + "/summary.json", "mine");
    replace_text_file(folder + "/manifest.json", "{}");
    clear_folder(folder);
    check_untouched(others);
    check_untouched({folder + "/summary.json"});
    CHECK_FALSE(fs::exists(folder + "/manifest.json"));
}
