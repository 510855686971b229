// Sweeps find the order that was put in, write what the interface names, and fail run by run.
#include "sweep/sweep.h"

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/hash.h"
#include "image/image_io.h"
#include "support/test.h"
#include "sweep/fake_scene.h"
#include "sweep/files.h"
#include "sweep/fit_runs.h"
#include "sweep/json.h"
#include "sweep/xml.h"

using namespace trilens;
using trilens_test::FakeSweep;
namespace fs = std::filesystem;

namespace {

/// RFC 4180 rows, by column name.
std::vector<std::map<std::string, std::string>> read_csv(const std::string& text) {
    std::vector<std::vector<std::string>> rows(1, {""});
    bool is_quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (is_quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"')
            rows.back().back() += text[++i];
        else if (c == '"')
            is_quoted = !is_quoted;
        else if (!is_quoted && c == ',')
            rows.back().push_back("");
        else if (!is_quoted && c == '\n')
            rows.push_back({""});
        else
            rows.back().back() += c;
    }
    REQUIRE(rows.back() == std::vector<std::string>{""});
    std::vector<std::map<std::string, std::string>> table;
    for (std::size_t row = 1; row + 1 < rows.size(); ++row) {
        REQUIRE(rows[row].size() == rows[0].size());
        table.emplace_back();
        for (std::size_t column = 0; column < rows[0].size(); ++column)
            table.back()[rows[0][column]] = rows[row][column];
    }
    return table;
}

double number(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    REQUIRE((!text.empty() && *end == '\0'));
    return value;
}

const SweepFit& fit_of(const SweepSummary& summary, const std::string& layer, const std::string& optic,
                       const std::string& metric) {
    const SweepFit* const fit = find_fit(summary.fits, layer, optic, metric);
    REQUIRE(fit != nullptr);
    return *fit;
}

bool has_temporary_files(const std::string& folder) {
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file() && entry.path().filename().string().find(".part") != std::string::npos)
            return true;
    return false;
}

}  // namespace

TEST_CASE("sweep: the order, constant and needed n of a known law are found, per optic") {
    for (const double order : {1.0, 2.0, 2.7}) {
        FakeSweep fake(trilens_test::scratch_dir("sweep_order"), {1, 2, 4, 8}, order);
        const SweepSummary summary = fake.run();
        REQUIRE(summary.count(RunState::kDone) == 4);
        for (const char* metric : {"disp_mean_px", "disp_p95_px"}) {
            const SweepFit left = fit_of(summary, "reflect", "left", metric);
            const SweepFit right = fit_of(summary, "reflect", "right", metric);
            CHECK(left.order.value() == Approx(order).epsilon(1e-3));
            CHECK(left.constant.value() == Approx(trilens_test::kLeftConstant).epsilon(1e-3));
            CHECK(right.constant.value() == Approx(trilens_test::kRightConstant).epsilon(1e-3));
            CHECK(right.r2.value() == Approx(1).epsilon(1e-5));
            CHECK(left.n_for_1px.value() == std::ceil(std::pow(1.5, 1 / order)));
            CHECK(right.n_for_half_px.value() == std::ceil(std::pow(5.8, 1 / order)));
        }
        CHECK(fit_of(summary, "reflect", "all", "disp_mean_px").order.value() == Approx(order).epsilon(0.02));
        CHECK(fit_of(summary, "", "all", "rgb_rmse").order.value() == Approx(order).epsilon(0.05));
        CHECK(!fit_of(summary, "", "all", "rgb_rmse").n_for_1px);
    }
}

TEST_CASE("sweep: every file of the interface is there, and the pictures are what was rendered") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_files"), {1, 2, 4});
    const std::string folder = fake.params.folder;
    const SweepSummary summary = fake.run();
    for (const char* file : {"manifest.json", "plan.jsonl", "runs.csv", "displacement.csv", "summary.json",
                             "report.html", "plots/reflect_disp_mean_px.svg", "plots/reflect_disp_p95_px.svg",
                             "plots/rgb_rmse.svg", "plots/time.svg"})
        CHECK(fs::file_size(folder + "/" + file) > 0);
    CHECK(fake.traces == 1);
    CHECK(!has_temporary_files(folder));
    CHECK(read_exr(truth_file(folder, summary.manifest.truth_hash)).find("reflect.X")->floats() ==
          trilens_test::fake_image(0, 0).find("reflect.X")->floats());
    for (const RunRecord& run : summary.runs) {
        const std::string home = run_folder(folder, run.plan.id);
        CHECK(fs::file_size(home + "/DONE") > 0);
        const Image image = read_exr(home + "/image.exr");
        CHECK(image.find("R")->floats() == fake.callbacks.render(run.plan.n).find("R")->floats());
        CHECK(read_exr(home + "/diff.exr").find("reflect.shift.X") != nullptr);
        CHECK(run.image_hash == hash_text(read_whole_file(home + "/image.exr").value()));
    }
    for (const auto& plot : fs::directory_iterator(folder + "/plots"))
        CHECK_NOTHROW(trilens_test::read_xml(read_whole_file(plot.path().string()).value()));
}

TEST_CASE("sweep: runs.csv reads back to the numbers of the runs; words with commas and quotes survive") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_csv"), {1, 3});
    const SweepSummary summary = fake.run();
    const auto rows = read_csv(read_whole_file(fake.params.folder + "/runs.csv").value());
    REQUIRE(rows.size() == 2);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const RunRecord& run = summary.runs[i];
        auto row = rows[i];
        CHECK(row["id"] == run.plan.id);
        CHECK(row["scene"] == fake.params.subject.scene);
        CHECK(row["n"] == std::to_string(run.plan.n));
        CHECK(row["facets"] == std::to_string(12 * run.plan.n * run.plan.n));
        CHECK(row["width"] == "96");
        CHECK(row["status"] == "done");
        CHECK(row["seed"] == "");
        CHECK(row["image_fnv1a"] == run.image_hash);
        for (const char* metric :
             {"rgb_mae", "rgb_rmse", "rgb_psnr_db", "disp_mean_px", "disp_max_px", "t_total_s", "t_trace_s"})
            CHECK(number(row[metric]) == run.metrics.at(metric));
        CHECK(fs::exists(fake.params.folder + "/" + row["image"]));
    }
    const auto displacement = read_csv(read_whole_file(fake.params.folder + "/displacement.csv").value());
    CHECK(displacement.size() == 2 * 3);  // runs times all, left, right
    for (auto row : displacement)
        if (row["optic"] == "right")
            CHECK(number(row["disp_mean_px"]) == Approx(2.9 / std::pow(number(row["n"]), 2)).epsilon(1e-3));
}

TEST_CASE("sweep: summary.json is JSON with the fields that scripts read, and knows no bare NaN") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_summary"), {1, 2, 4});
    fake.run();
    const Json json = Json::parse(read_whole_file(fake.params.folder + "/summary.json").value());
    CHECK(json.at("counts").at("done") == 3);
    REQUIRE(json.at("fits").size() == 13);  // (all, left, right) x (mean, median, p95), and RGB
    for (const Json& fit : json.at("fits")) {
        for (const char* field : {"optic", "metric", "order", "constant", "r2", "n_for_1px", "n_for_half_px"})
            CHECK(fit.contains(field));
        CHECK(fit.at("points").size() == 3);
    }
    for (const double value : std::vector<double>{std::nan(""), INFINITY, -INFINITY, 0.1, -1e-300}) {
        const Json written = Json::parse(json_document(json_of_number(value)));
        const std::optional<double> back = number_of_json(written);
        CHECK((back == value || (std::isnan(value) && std::isnan(back.value()))));
    }
    CHECK(!number_of_json(Json::parse(json_document(json_of_number(std::nullopt)))));
    CHECK_THROWS(number_of_json("1"));
}

TEST_CASE("sweep: identical pictures give no order, an infinite PSNR, and a report all the same") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_identical"), {1, 2});
    fake.callbacks.render = [](int) { return trilens_test::fake_image(0, 0); };
    const SweepSummary summary = fake.run();
    CHECK(summary.runs[0].metrics.at("disp_mean_px") == 0);
    CHECK(std::isinf(load_sweep(fake.params.folder).runs[0].metrics.at("rgb_psnr_db")));
    CHECK(!fit_of(summary, "reflect", "all", "disp_mean_px").order);
    CHECK(read_whole_file(fake.params.folder + "/report.html").value().find("2 of 2") != std::string::npos);
}

TEST_CASE(
    "sweep: optics that share a name, or are called all, are told apart; one that nobody sees is warned of") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_names"), {1, 2});
    fake.params.subject.optics = {{0, "all"}, {1, "all"}, {5, "hidden"}};
    const SweepSummary summary = fake.run();
    CHECK(fit_of(summary, "reflect", "all #0", "disp_mean_px").constant.value() == Approx(1.5).epsilon(1e-3));
    CHECK(fit_of(summary, "reflect", "all #1", "disp_mean_px").constant.value() == Approx(2.9).epsilon(1e-3));
    CHECK(find_fit(summary.fits, "reflect", "hidden", "disp_mean_px") == nullptr);
    REQUIRE(summary.runs[0].warnings.size() == 1);
    CHECK(summary.runs[0].warnings[0].find("hidden") != std::string::npos);
}

TEST_CASE("sweep: runs that lose many pixels take no part in a fit") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_lost"), {1, 2, 4, 8});
    // At n = 1 half of the left optic is displaced out of its reach.
    fake.callbacks.render = [](int n) {
        return trilens_test::fake_image(n == 1 ? 24 : 1.5 / (n * n), 3.0 / (n * n));
    };
    const SweepSummary summary = fake.run();
    const SweepFit left = fit_of(summary, "reflect", "left", "disp_mean_px");
    REQUIRE(left.points.size() == 4);
    CHECK(!left.points[0].used);
    CHECK(left.order.value() == Approx(2).epsilon(1e-3));
}

TEST_CASE("sweep: the report escapes, embeds every picture, and refers to nothing outside") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_report"), {1, 2});
    fake.run();
    const std::string html = read_whole_file(fake.params.folder + "/report.html").value();
    CHECK(html.find("<test>") == std::string::npos);
    CHECK(html.find("Two mirrors &amp; a &lt;test&gt;") != std::string::npos);
    CHECK(html.find(fake.params.subject.commands[0]) != std::string::npos);
    std::size_t pictures = 0;
    for (std::size_t at = html.find("src=\""); at != std::string::npos;
         at = html.find("src=\"", at + 1), ++pictures)
        CHECK(html.compare(at + 5, 22, "data:image/png;base64,") == 0);
    CHECK(pictures == 2 * 4);
    CHECK(html.find("href=") == std::string::npos);
}

TEST_CASE("sweep: a folder that cannot be written is an OutputError, one without a plan an InputError") {
    const std::string folder = trilens_test::scratch_dir("sweep_unwritable");
    replace_text_file(folder + "/file", "in the way");
    FakeSweep fake(folder + "/file/sweep", {1});
    CHECK_THROWS_AS(fake.run(), OutputError);
    FakeSweep on_file(folder + "/file", {1});
    CHECK_THROWS_AS(on_file.run(), OutputError);
    FakeSweep taken(folder + "/taken", {1});
    fs::create_directories(folder + "/taken/runs.csv/x");
    CHECK_THROWS_AS(taken.run(), OutputError);
    CHECK(fake.renders + on_file.renders == 0);
    CHECK_THROWS_AS(load_sweep(folder), InputError);
    replace_text_file(folder + "/manifest.json", "{\"schema\": 3}");
    CHECK_THROWS_AS(report_sweep(folder), InputError);
}
