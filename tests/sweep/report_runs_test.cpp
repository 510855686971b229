// Pictures of a report that would make its page too large.
#include "sweep/report/sweep_pictures.h"

#include <filesystem>

#include "base/files/files.h"
#include "base/util/error.h"
#include "fake_scene.h"
#include "report/page.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("sweep: pictures lie beside the page where they would make it too large", "[sweep]") {
    FakeSweep fake(scratch_dir("sweep_large_page"), {1, 2, 4});
    const SweepSummary summary = fake.run();
    const std::filesystem::path beside = fake.params.folder + "/pictures";

    Report within;
    fill_runs(summary, 50'000'000, within);
    REQUIRE(within.runs.size() == 3);
    CHECK_FALSE(std::filesystem::exists(beside));

    Report beyond;
    fill_runs(summary, 1000, beyond);
    std::size_t files = 0;
    for (std::size_t i = 0; i < beyond.runs.size(); ++i) {
        REQUIRE(beyond.runs[i].pictures.size() == within.runs[i].pictures.size());
        REQUIRE_FALSE(beyond.runs[i].pictures.empty());
        for (std::size_t k = 0; k < beyond.runs[i].pictures.size(); ++k) {
            const PagePicture &embedded = within.runs[i].pictures[k], &linked = beyond.runs[i].pictures[k];
            CAPTURE(embedded.caption, linked.caption);
            if (embedded.png.empty()) continue;  // nothing to show: its caption says why
            CHECK(linked.png.empty());
            CHECK(std::filesystem::file_size(fake.params.folder + "/" + linked.file) == embedded.png.size());
            ++files;
        }
    }
    CHECK(files >= 3);
    CHECK(beyond.pictures_note.find("beside this page") != std::string::npos);

    // A report that fits again leaves nothing of the larger one.
    Report again;
    fill_runs(summary, 50'000'000, again);
    CHECK_FALSE(std::filesystem::exists(beside));
}

TEST_CASE("sweep: the report at its end is the one that its files make", "[sweep]") {
    FakeSweep fake(scratch_dir("sweep_kept_pictures"), {1, 2, 4});
    fake.truth_per_run = true;
    fake.before_render = [](int n) {
        if (n == 2) throw ComputationError("no picture today");
    };
    SweepSummary at_end = fake.run();
    const std::string page = read_whole_file(fake.params.folder + "/report.html").value();
    CHECK(page.find("data:image/png") != std::string::npos);
    const SweepSummary from_files = report_sweep(fake.params.folder);
    CHECK(page == read_whole_file(fake.params.folder + "/report.html").value());
    REQUIRE(at_end.runs.size() == from_files.runs.size());
    for (std::size_t i = 0; i < at_end.runs.size(); ++i) {
        CHECK(at_end.runs[i].metrics == from_files.runs[i].metrics);
        CHECK(at_end.runs[i].image_hash == from_files.runs[i].image_hash);
        CHECK(at_end.runs[i].state == from_files.runs[i].state);
    }
}
