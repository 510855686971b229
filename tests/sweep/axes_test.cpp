// Sweeps over several axes: groups, fits, plots and tables; several runs at once.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>

#include "base/description/digest.h"
#include "base/files/files.h"
#include "base/util/error.h"
#include "json/json.h"
#include "report/xml.h"
#include "support/test.h"
#include "sweep/fake_scene.h"
#include "sweep/report/gallery.h"
#include "sweep/report/sweep_report.h"
#include "sweep/run/sweep.h"
#include "sweep/store/machine.h"

using namespace trilens;
using trilens_test::FakeSweep;
namespace fs = std::filesystem;

namespace {

const AxisKind kEngine{"engine", "", "engine", ValueKind::kWord, 0, 0, false, {"exact", "classic"}};

/// The fake scene with engines: the classic one has half the order.
struct FakeEngines : FakeSweep {
    std::atomic<int> drawn = 0;

    explicit FakeEngines(const std::string& folder) : FakeSweep(folder, {1, 2, 4, 8}) {
        params.axes.axes.insert(params.axes.axes.begin(),
                                make_axis(kEngine, {"engine", {"exact", "classic"}}, "axis"));
        callbacks.render = [this](const PlannedRun& run) {
            ++drawn;
            before_render(run.n());
            const double order = find_coordinate(run.at, "engine")->text == "exact" ? 2 : 1;
            const double fall = std::pow(run.n(), -order);
            return DrawnPicture{trilens_test::fake_image(1.5 * fall, 2.9 * fall), {{"draw", 0.001}}};
        };
    }
};

}  // namespace

TEST_CASE("sweep: each group of runs has its own order, along the axis that orders", "[sweep]") {
    FakeEngines fake(trilens_test::scratch_dir("axes_groups"));
    const SweepSummary summary = fake.run();
    REQUIRE(summary.runs.size() == 8);
    CHECK(summary.runs[0].plan.id == "exact_n0001");
    for (const auto& [engine, order] : {std::pair("exact", 2.0), std::pair("classic", 1.0)}) {
        const Coordinates group = {{"engine", {engine, {}}}};
        const SweepFit* const fit = find_fit(summary.fits, "reflect", "left", "disp_mean_px", &group);
        REQUIRE(fit);
        CHECK(fit->order.value() == Approx(order).epsilon(1e-3));
        CHECK((fit->order_low.value() <= order + 1e-3 && fit->order_high.value() >= order - 1e-3));
        CHECK(fit->axis == "resolution");
    }
    const Json json = Json::parse(read_whole_file(fake.params.folder + "/summary.json").value());
    CHECK(json.at("fits")[0].at("group").at("engine") == "exact");
    CHECK(json.at("runs")[4].at("point") == Json({{"engine", "classic"}, {"resolution", 1}}));
    // What is read back is what was planned.
    const SweepSummary again = load_sweep(fake.params.folder);
    for (std::size_t i = 0; i < 8; ++i) CHECK(again.runs[i].plan.at == summary.runs[i].plan.at);
    const std::string csv = read_whole_file(fake.params.folder + "/runs.csv").value();
    CHECK(csv.find("classic_n0008,") != std::string::npos);
}

TEST_CASE("sweep: a gallery tells the order of the run that it shows, once", "[sweep]") {
    const std::string folder = trilens_test::scratch_dir("axes_gallery");
    FakeEngines fake(folder + "/two");
    write_sweep_gallery(folder, std::vector<SweepSummary>{fake.run()});
    const std::string page = read_whole_file(folder + "/report.html").value();
    const std::string words = "order of the mean displacement";
    const std::size_t at = page.find(words);
    REQUIRE(at != std::string::npos);
    CHECK(page.find(words, at + 1) == std::string::npos);
    // The first engine's.
    CHECK(page.substr(at, 60).find("2") != std::string::npos);
}

TEST_CASE("sweep: a line per group in one plot, as SVG and PDF", "[sweep]") {
    FakeEngines fake(trilens_test::scratch_dir("axes_plots"));
    fake.run();
    const std::string plots = fake.params.folder + "/plots/reflect_disp_mean_px";
    const auto svg = trilens_test::read_xml(read_whole_file(plots + ".svg").value());
    std::set<std::string> entries;
    for (const auto& element : svg)
        if (element.has_class("tp-entry")) entries.insert(element.text);
    CHECK(entries == std::set<std::string>{"exact: order 2.00", "classic: order 1.00"});
    const std::string pdf = read_whole_file(plots + ".pdf").value();
    CHECK(pdf.rfind("%PDF-1.4", 0) == 0);
    CHECK(pdf.find("(exact: order 2.00)") != std::string::npos);
    const std::string latex = read_whole_file(fake.params.folder + "/summary.tex").value();
    CHECK(latex.find("exact & reflect & left & $2.00$") != std::string::npos);
    CHECK(latex.find("\\toprule") != std::string::npos);
}

TEST_CASE("sweep: at most eight lines share a plot; two axes of numbers make a map", "[sweep]") {
    std::vector<RunGroup> groups;
    for (const char* engine : {"exact", "classic", "facets"})
        for (int spp = 1; spp <= 5; ++spp)
            groups.push_back({{{"engine", {engine, {}}}, {"spp", {std::to_string(spp), double(spp)}}}, {}});
    const std::vector<PlotGroups> plots = plot_groups(groups);
    REQUIRE(plots.size() == 3);
    CHECK(plots[1].title == "classic");
    CHECK(plots[1].groups.size() == 5);
    CHECK(plots[1].groups[2].name == "spp = 3");

    FakeSweep fake(trilens_test::scratch_dir("axes_map"), {1, 2, 4});
    fake.params.axes.axes.push_back(
        make_axis(pointer_kind("/materials/0/ior"), {"/materials/0/ior", {"1.3", "1.5"}}, "axis"));
    fake.run();
    const auto svg =
        trilens_test::read_xml(read_whole_file(fake.params.folder + "/plots/reflect_map.svg").value());
    std::size_t cells = 0;
    for (const auto& element : svg) cells += element.has_class("tp-cell");
    CHECK(cells == 6 + 48);  // and the scale
}

TEST_CASE("sweep: several runs at once give what one after the other gives, each once", "[sweep]") {
    FakeEngines one(trilens_test::scratch_dir("axes_one")), many(trilens_test::scratch_dir("axes_many"));
    one.run();
    many.params.jobs = 4;
    std::atomic<int> inside = 0, most = 0;
    many.before_render = [&](int) {
        most = std::max<int>(most, ++inside);
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
        --inside;
    };
    const SweepSummary summary = many.run();
    CHECK(most > 1);
    CHECK(many.drawn == 8);
    CHECK(many.traces == 1);
    for (std::size_t i = 0; i < 8; ++i) {
        CHECK(summary.runs[i].image_hash == load_sweep(one.params.folder).runs[i].image_hash);
        CHECK(!is_timed_alone(summary.runs[i]));
        CHECK(summary.runs[i].metrics.count("peak_rss_mb") == 0);
    }
    const std::string html = read_whole_file(many.params.folder + "/report.html").value();
    CHECK(html.find("8 of 8 runs were drawn while others of this sweep ran (-j)") != std::string::npos);
    CHECK(read_whole_file(many.params.folder + "/plots/time.svg").value().find("no measurement") !=
          std::string::npos);
}

TEST_CASE("sweep: a failure stops all workers, and is what comes out", "[sweep]") {
    FakeEngines fake(trilens_test::scratch_dir("axes_stop"));
    fake.params.jobs = 3;
    fake.before_render = [](int) { throw std::logic_error("bug"); };
    CHECK_THROWS_AS(fake.run(), std::logic_error);
}

TEST_CASE("sweep: only as many runs are at work as fit into memory", "[sweep]") {
    FakeEngines fake(trilens_test::scratch_dir("axes_memory"));
    fake.params.jobs = 4;
    fake.params.memory_limit = 100;
    fake.callbacks.memory = [](const PlannedRun&) { return 60.0; };
    std::atomic<int> inside = 0, most = 0;
    fake.before_render = [&](int) {
        most = std::max<int>(most, ++inside);
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        --inside;
    };
    fake.run();
    CHECK(most == 1);
    CHECK(available_memory().value() > 1e6);
}

TEST_CASE("sweep: repeats give a median and a spread, and leave the first drawing out", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("axes_repeats"), {1});
    fake.params.repeats = 3;
    int calls = 0;
    fake.before_render = [&](int) {
        // Slow once, and in the middle.
        std::this_thread::sleep_for(std::chrono::milliseconds(calls == 0 ? 400 : calls == 2 ? 200 : 20));
        ++calls;
    };
    const MetricValues metrics = fake.run().runs[0].metrics;
    CHECK(calls == 4);
    CHECK(metrics.at("repeats") == 3);
    CHECK(metrics.at("t_first_s") >= 0.4);
    CHECK(metrics.at("t_total_s") < 0.2);
    CHECK(metrics.at("t_spread_s") > 0.1);
    CHECK(metrics.at("threads") >= 1);
}

TEST_CASE("sweep: a truth that was damaged is traced again, one of half its bytes too",
          "[sweep][bad-input]") {
    FakeSweep fake(trilens_test::scratch_dir("axes_truth"), {1, 2});
    const SweepSummary summary = fake.run();
    const std::string file = truth_file(fake.params.folder, summary.runs[0].plan.truth);
    std::string bytes = read_whole_file(file).value();
    const bool is_half = GENERATE(false, true);
    if (is_half)
        bytes.resize(bytes.size() / 2);
    else
        bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    replace_text_file(file, bytes);
    fs::remove(fake.params.folder + "/runs/n0002/DONE");
    fake.run();
    CHECK(fake.traces == 2);
    CHECK(hash_text(read_whole_file(file).value()) != hash_text(bytes));
}

TEST_CASE("sweep: a clock that jumps changes nothing, foreign files stay where they are", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("axes_clock"), {1, 2});
    fake.before_render = [](int n) {
        if (n == 2) throw ComputationError("fails");
    };
    fake.run();
    const std::string foreign = fake.params.folder + "/runs/n0001/notes.txt";
    replace_text_file(foreign, "mine");
    fs::create_directories(fake.params.folder + "/runs/other");
    // All files as of long ago, or of years to come.
    const auto shift = std::chrono::hours(24 * 365 * GENERATE(-20, 20));
    for (const auto& entry : fs::recursive_directory_iterator(fake.params.folder))
        fs::last_write_time(entry.path(), fs::last_write_time(entry.path()) + shift);
    fake.renders = fake.traces = 0;
    const SweepSummary summary = fake.run();
    CHECK((fake.renders == 1 && fake.traces == 0));  // the failed one, once more
    CHECK(summary.runs[1].state == RunState::kFailed);
    CHECK(read_whole_file(foreign) == "mine");
}

TEST_CASE("sweep: folders of one axis, as they were once written, are read", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("axes_old"), {1, 2});
    fake.run();
    const std::string folder = fake.params.folder;
    Json manifest = Json::parse(read_whole_file(folder + "/manifest.json").value());
    manifest["schema"] = "trilens.sweep-manifest/2";
    manifest["axis"] = {{"name", "resolution"}, {"values", {1, 2}}};
    manifest.erase("axes"), manifest.erase("zip");
    replace_text_file(folder + "/manifest.json", manifest.dump());
    std::string plan;
    for (const RunRecord& run : load_sweep(folder).runs)
        plan += Json({{"id", run.plan.id},
                      {"n", run.plan.n()},
                      {"hash", run.plan.hash},
                      {"truth", run.plan.truth}})
                    .dump() +
                "\n";
    replace_text_file(folder + "/plan.jsonl", plan);
    const SweepSummary summary = report_sweep(folder);
    CHECK(summary.count(RunState::kDone) == 2);
    CHECK(find_fit(summary.fits, "reflect", "left", "disp_mean_px")->order.value() ==
          Approx(2).epsilon(1e-3));
}

TEST_CASE("sweep: no table has two columns of one name, also where the optic is swept", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_optics"), {1, 2});
    fake.params.axes.axes.push_back(
        make_axis({"optic", "", "optic", ValueKind::kText}, {"optic", {"left", "right"}}, "axis"));
    fake.run();
    for (const char* table : {"runs.csv", "displacement.csv"}) {
        const std::string text = read_whole_file(fake.params.folder + "/" + table).value();
        std::vector<std::string> columns;
        std::istringstream header(text.substr(0, text.find('\n')));
        for (std::string one; std::getline(header, one, ',');) columns.push_back(one);
        std::sort(columns.begin(), columns.end());
        CAPTURE(table);
        CHECK(std::adjacent_find(columns.begin(), columns.end()) == columns.end());
    }
    const std::string displaced = read_whole_file(fake.params.folder + "/displacement.csv").value();
    CHECK(displaced.find("id,n,swept_optic,layer,optic,") == 0);
    CHECK(std::count(displaced.begin(), displaced.end(), '\n') == 1 + 2 * 2 * 3);
}
