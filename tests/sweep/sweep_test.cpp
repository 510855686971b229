// Sweeps find the order that was put in, write what the interface names, and fail run by run.
#include "sweep/run/sweep.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "base/description/digest.h"
#include "base/files/files.h"
#include "base/util/error.h"
#include "image/image_io.h"
#include "json/json.h"
#include "report/page.h"
#include "report/text.h"
#include "report/xml.h"
#include "support/test.h"
#include "sweep/fake_scene.h"
#include "sweep/report/sweep_report.h"

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

TEST_CASE("sweep: the order, constant and needed n of a known law are found, per optic", "[sweep]") {
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

TEST_CASE("sweep: every file of the interface is there, and the pictures are what was rendered", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_files"), {1, 2, 4});
    const std::string folder = fake.params.folder;
    const SweepSummary summary = fake.run();
    for (const char* file : {"manifest.json", "plan.jsonl", "runs.csv", "displacement.csv", "summary.json",
                             "report.html", "plots/reflect_disp_mean_px.svg", "plots/reflect_disp_p95_px.svg",
                             "plots/rgb_rmse.svg", "plots/time.svg"})
        CHECK(fs::file_size(folder + "/" + file) > 0);
    CHECK(fake.traces == 1);
    CHECK(!has_temporary_files(folder));
    CHECK(read_exr(truth_file(folder, summary.runs[0].plan.truth)).find("reflect.X")->floats() ==
          trilens_test::fake_image(0, 0).find("reflect.X")->floats());
    for (const RunRecord& run : summary.runs) {
        const std::string home = run_folder(folder, run.plan.id);
        CHECK(fs::file_size(home + "/DONE") > 0);
        const Image image = read_exr(home + "/image.exr");
        CHECK(image.find("R")->floats() == fake.render(run.plan.n()).find("R")->floats());
        CHECK(read_exr(home + "/diff.exr").find("reflect.shift.X") != nullptr);
        CHECK(run.image_hash == hash_text(read_whole_file(home + "/image.exr").value()));
    }
    for (const auto& plot : fs::directory_iterator(folder + "/plots"))
        if (plot.path().extension() == ".svg")
            CHECK_NOTHROW(trilens_test::read_xml(read_whole_file(plot.path().string()).value()));
}

TEST_CASE("sweep: runs.csv reads back to the numbers of the runs; words with commas and quotes survive",
          "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_csv"), {1, 3});
    const SweepSummary summary = fake.run();
    const auto rows = read_csv(read_whole_file(fake.params.folder + "/runs.csv").value());
    REQUIRE(rows.size() == 2);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const RunRecord& run = summary.runs[i];
        auto row = rows[i];
        CHECK(row["id"] == run.plan.id);
        CHECK(row["scene"] == fake.params.subject.scene);
        CHECK(row["n"] == std::to_string(run.plan.n()));
        CHECK(row["facets"] == std::to_string(12 * run.plan.n() * run.plan.n()));
        CHECK(row["width"] == "96");
        CHECK(row["status"] == "done");
        CHECK(row.count("seed") + row.count("isa") == 0);  // nobody has them
        CHECK(number(row["disp_coverage"]) == run.metrics.at("disp_coverage"));
        CHECK((row.count("disp_lost") == 1 && row.count("disp_missing") == 1));
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

TEST_CASE("sweep: summary.json is JSON with the fields that scripts read, and knows no bare NaN",
          "[sweep][bad-input]") {
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

TEST_CASE("sweep: identical pictures give no order, an infinite PSNR, and a report all the same", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_identical"), {1, 2});
    fake.render = [](int) { return trilens_test::fake_image(0, 0); };
    const SweepSummary summary = fake.run();
    CHECK(summary.runs[0].metrics.at("disp_mean_px") == 0);
    CHECK(std::isinf(load_sweep(fake.params.folder).runs[0].metrics.at("rgb_psnr_db")));
    CHECK(!fit_of(summary, "reflect", "all", "disp_mean_px").order);
    const std::string html = read_whole_file(fake.params.folder + "/report.html").value();
    CHECK(html.find("2 of 2") != std::string::npos);
    // A sentence, and no empty plot or black picture.
    CHECK(
        html.find("reflect: exact. In all 2 runs every displacement that was measured is zero, over 100 % of "
                  "the pixels, with 0 lost, 0 missing and 0 unmeasured") != std::string::npos);
    CHECK(html.find("<svg") == std::string::npos);
    CHECK(fs::is_empty(fake.params.folder + "/plots"));
    CHECK(html.find("difference: none") != std::string::npos);
    CHECK(html.find("displacement, reflect: zero wherever it was measured") != std::string::npos);
}

TEST_CASE(
    "sweep: optics that share a name, or are called all, are told apart; one that nobody sees is warned of",
    "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_names"), {1, 2});
    fake.optics = {{0, "all"}, {1, "all"}, {5, "hidden"}};
    const SweepSummary summary = fake.run();
    CHECK(fit_of(summary, "reflect", "all #0", "disp_mean_px").constant.value() == Approx(1.5).epsilon(1e-3));
    CHECK(fit_of(summary, "reflect", "all #1", "disp_mean_px").constant.value() == Approx(2.9).epsilon(1e-3));
    CHECK(find_fit(summary.fits, "reflect", "hidden", "disp_mean_px") == nullptr);
    REQUIRE(summary.runs[0].warnings.size() == 1);
    CHECK(summary.runs[0].warnings[0].find("hidden") != std::string::npos);
}

TEST_CASE("sweep: runs that lose many pixels take no part in a fit", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_lost"), {1, 2, 4, 8});
    // At n = 1 half of the left optic is displaced out of its reach.
    fake.render = [](int n) { return trilens_test::fake_image(n == 1 ? 24 : 1.5 / (n * n), 3.0 / (n * n)); };
    const SweepSummary summary = fake.run();
    const SweepFit left = fit_of(summary, "reflect", "left", "disp_mean_px");
    REQUIRE(left.points.size() == 4);
    CHECK(!left.points[0].used);
    CHECK(left.order.value() == Approx(2).epsilon(1e-3));
}

TEST_CASE("sweep: runs whose picture misses much of what the truth shows take no part in a fit",
          "[sweep][oracle]") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_missing"), {1, 2, 4, 8});
    // At n = 1 the left half of the left optic shows nothing; what it shows is where the law says.
    fake.render = [](int n) {
        Image image = trilens_test::fake_image(1.5 / (n * n), 2.9 / (n * n));
        for (std::size_t i = 0; i < image.pixels() && n == 1; ++i) {
            if (i % trilens_test::kFakeWidth >= trilens_test::kFakeWidth / 4) continue;
            image.find("reflect.object")->ids()[i] = kNone;
            for (const char* name : {"reflect.X", "reflect.Y", "reflect.Z"})
                image.find(name)->floats()[i] = 0;
        }
        return image;
    };
    const SweepSummary summary = fake.run();
    const SweepFit left = fit_of(summary, "reflect", "left", "disp_mean_px");
    REQUIRE(left.points.size() == 4);
    CHECK(!left.points[0].used);
    CHECK(fit_of(summary, "reflect", "right", "disp_mean_px").points[0].used);

    // The table says how much was measured.
    for (auto row : read_csv(read_whole_file(fake.params.folder + "/displacement.csv").value())) {
        if (row["optic"] == "all") continue;
        const bool is_half = row["n"] == "1" && row["optic"] == "left";
        CHECK(number(row["disp_coverage"]) == Approx(is_half ? 0.5 : 1).margin(0.1));
        if (is_half) CHECK(number(row["disp_missing"]) == Approx(24 * 40).margin(2 * 40));
        CHECK(number(row["disp_beyond_radius"]) == 0);
    }
}

TEST_CASE("sweep: the report escapes, embeds every picture, and refers to nothing outside", "[sweep]") {
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

TEST_CASE("sweep: columns that are empty in every row are left out, and come back with their first value",
          "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_columns"), {1, 2});
    const std::string file = fake.params.folder + "/runs.csv";
    fake.before_render = [](int) { throw ComputationError("none"); };
    fake.run();
    const auto failed = read_csv(read_whole_file(file).value());
    CHECK((failed[0].count("rgb_rmse") == 0 && failed[0].count("exit_code") == 1));
    fake.before_render = [](int n) {
        if (n == 2) throw ComputationError("one");
    };
    fake.run();
    auto half = read_csv(read_whole_file(file).value());
    CHECK((half[0]["rgb_rmse"] != "" && half[1].count("rgb_rmse") == 1 && half[1]["rgb_rmse"] == ""));
    for (const auto& [column, value] : half[0]) {
        INFO(column);
        CHECK((!value.empty() || !half[1][column].empty()));
    }
}

TEST_CASE("sweep: no mean of displacement stands without what was measured and lost", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_bare"), {1, 2, 4});
    // The top rows of the left optic show nothing: they are missing.
    fake.render = [](int n) {
        Image image = trilens_test::fake_image(1.5 / (n * n), 2.9 / (n * n));
        for (std::size_t i = 0; i < 2 * trilens_test::kFakeWidth; ++i) {
            image.find("reflect.object")->ids()[i] = kNone;
            for (const char* name : {"reflect.X", "reflect.Y", "reflect.Z"})
                image.find(name)->floats()[i] = 0;
        }
        return image;
    };
    const SweepSummary summary = fake.run();
    const OpticDisplacement& all = summary.runs[2].displacement[0];
    REQUIRE(all.optic == "all");
    CHECK(all.metrics.at("disp_missing") >= 96);
    CHECK(summary.runs[2].metrics.at("disp_missing") == all.metrics.at("disp_missing"));
    CHECK(summary.runs[2].metrics.at("disp_coverage") == all.metrics.at("disp_coverage"));
    const SweepFit fit = fit_of(summary, "reflect", "all", "disp_mean_px");
    double least = 1;
    for (const RunRecord& run : summary.runs)
        least = std::min(least, run.displacement[0].metrics.at("disp_coverage"));
    CHECK(fit.coverage.value() == least);
    CHECK(Json::parse(read_whole_file(fake.params.folder + "/summary.json").value())
              .at("fits")[0]
              .at("coverage") == least);

    const std::string html = read_whole_file(fake.params.folder + "/report.html").value();
    for (const char* column : {"reflect: measured", "reflect: lost", "reflect: missing", "reflect: unmeasured"})
        CHECK(html.find("<th>" + std::string(column) + "</th>") != std::string::npos);
    CHECK(html.find("<dt>reflect, left, measured</dt>") != std::string::npos);
    CHECK(html.find("of the pixels that were measured: 9") != std::string::npos);  // in the plot
    const std::string plot = read_whole_file(fake.params.folder + "/plots/reflect_disp_mean_px.svg").value();
    CHECK(plot.find("of the pixels that were measured: 9") != std::string::npos);
}

TEST_CASE("sweep: each run's difference has a factor of its own, which it states", "[sweep]") {
    FakeSweep fake(trilens_test::scratch_dir("sweep_factors"), {1, 4, 16, 64});
    const SweepSummary summary = fake.run();
    const std::string html = read_whole_file(fake.params.folder + "/report.html").value();
    double previous = 0;
    for (const RunRecord& run : summary.runs) {
        const double scale = difference_scale(run.metrics.at("rgb_p99"));
        CHECK(scale >= 4 * previous);  // errors fall by 16
        previous = scale;
        CHECK(html.find("|projected − truth| × " + shortest_text(scale) + ",") != std::string::npos);
    }
}

TEST_CASE("sweep: of many runs the page has all, folded, with their pictures loaded when they are looked at",
          "[sweep]") {
    std::vector<int> values;
    for (int n = 1; n <= 30; ++n) values.push_back(n);
    FakeSweep fake(trilens_test::scratch_dir("sweep_many"), values);
    fake.run();
    const std::string html = read_whole_file(fake.params.folder + "/report.html").value();
    const auto count = [&](const std::string& part) {
        std::size_t found = 0;
        for (std::size_t at = 0; (at = html.find(part, at + 1)) != std::string::npos;) ++found;
        return found;
    };
    CHECK(count("<td>done</td>") == 30);
    CHECK(count("<details class=\"run quiet\"") == 30);
    CHECK(count("<img ") == 30 * 4);
    CHECK(count("<img loading=\"lazy\"") == 30 * 4);
    for (const char* ends : {"<summary>n = 1</summary>", "<summary>n = 30</summary>"})
        CHECK(html.find(ends) != std::string::npos);
    CHECK(!fs::exists(fake.params.folder + "/pictures"));
}

TEST_CASE("sweep: a folder that cannot be written is an OutputError, one without a plan an InputError",
          "[sweep][bad-input]") {
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

TEST_CASE("a plot's points rise along its axis, in whatever order the runs stand", "[sweep]") {
    SweepFit fit;
    fit.points = {{8, 0.1, true}, {2, 1.6, true}, {4, 0.4, true}};
    const PlotSeries series = plot_series(fit, "mean");
    REQUIRE(series.points.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) CHECK(series.points[i].x == std::exp2(static_cast<double>(i) + 1));
    CHECK(series.points[0].y == 1.6);
}
