// compare takes what people have: other channels, other names, parts, pictures; and limits on any metric.
#include <trilens/compare.h>
#include <trilens/error.h>
#include <trilens/image.h>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "support/test.h"

using namespace trilens_test;
using namespace trilens;

namespace {

constexpr int kWidth = 24, kHeight = 20;

Channel noise(const std::string& name, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<float> values(kWidth * kHeight);
    for (float& value : values) value = static_cast<float>(random() % 1000) / 1000;
    return {name, std::move(values)};
}

Image image_of(std::vector<Channel> channels) {
    Image image;
    image.width = image.data_width = kWidth;
    image.height = image.data_height = kHeight;
    image.channels = std::move(channels);
    return image;
}

/// PREFIX R G B, the same values for every prefix.
Image coloured(const std::string& prefix) {
    return image_of({noise(prefix + "R", 1), noise(prefix + "G", 2), noise(prefix + "B", 3)});
}

std::string write(const std::string& folder, const std::string& name, const Image& image) {
    write_image(folder + "/" + name, image);
    return folder + "/" + name;
}

void oiiotool(const std::string& folder, const std::string& arguments) {
    REQUIRE(std::system(("cd '" + folder + "' && oiiotool " + arguments + " > log.txt 2>&1").c_str()) == 0);
}

}  // namespace

TEST_CASE("channels in common are compared, and what is left out is said", "[cli][compare]") {
    const std::string folder = scratch_dir("cli_compare_common");
    Image more = coloured("");
    more.channels.push_back(noise("A", 4));
    more.channels.push_back(noise("Z", 5));
    Image other_type = coloured("");
    other_type.channels.push_back({"Z", std::vector<Id>(kWidth * kHeight, 7)});
    const std::string rgb = write(folder, "rgb.exr", coloured("")), rgba = write(folder, "rgbaz.exr", more),
                      ids = write(folder, "ids.exr", other_type);
    const CommandRun run = run_trilens("compare " + rgb + " " + rgba);
    CHECK(run.exit_code == 0);
    CHECK(run.out.find("left out      only in the test: A Z\n") == 0);
    CHECK(run_trilens("compare " + rgba + " " + ids).out.find("only in the test: Z\n") != std::string::npos);
    const std::string json = run_trilens("compare " + rgba + " " + rgb + " --json").out;
    CHECK(json.find("\"left_out\": {\n    \"ref\": [\n      \"A\",\n      \"Z\"\n    ],\n    \"test\": []") !=
          std::string::npos);

    const CommandRun strict = run_trilens("compare --strict " + rgb + " " + rgba);
    CHECK(strict.exit_code == 3);
    CHECK(strict.err.find("only the test has this channel") != std::string::npos);
    CHECK(run_trilens("compare --strict " + rgb + " " + rgb).exit_code == 0);

    // What is left out does not count, what is common does.
    more.channels[0].floats()[17] += 0.5f;
    CHECK(run_trilens("compare " + rgb + " " + write(folder, "changed.exr", more)).exit_code == 1);
}

TEST_CASE("a layer with R, G and B stands for the beauty, by itself or by name", "[cli][compare]") {
    const std::string folder = scratch_dir("cli_compare_layers");
    const std::string plain = write(folder, "plain.exr", coloured(""));
    const std::string one = write(folder, "one.exr", coloured("ViewLayer.Combined."));
    Image several = coloured("ViewLayer.Combined.");
    for (const char* channel : {"Other.R", "Other.G", "Other.B"})
        several.channels.push_back(noise(channel, 9));
    const std::string two = write(folder, "two.exr", several);

    CHECK(run_trilens("compare " + plain + " " + one).exit_code == 0);
    const CommandRun unclear = run_trilens("compare " + plain + " " + two);
    CHECK(unclear.exit_code == 3);
    CHECK(unclear.err.find("two.exr: has several layers, name one of them: ") != std::string::npos);
    CHECK(unclear.err.find("ViewLayer.Combined") != std::string::npos);
    CHECK(run_trilens("compare " + plain + " " + two + " --test-layer ViewLayer.Combined").exit_code == 0);
    CHECK(run_trilens("compare " + two + " " + plain + " --ref-layer ViewLayer.Combined").exit_code == 0);
    CHECK(run_trilens("compare " + plain + " " + two + " --test-layer Other").exit_code == 1);
    const CommandRun unknown = run_trilens("compare " + plain + " " + two + " --test-layer Comb");
    CHECK(unknown.exit_code == 3);
    CHECK(unknown.err.find("no layer \"Comb\"") != std::string::npos);
    const CommandRun none =
        run_trilens("compare " + plain + " " + write(folder, "z.exr", image_of({noise("Z", 1)})));
    CHECK(none.exit_code == 3);
    CHECK(none.err.find("no layer with channels R, G and B") != std::string::npos);
}

TEST_CASE("older and newer names of what is seen are one channel", "[cli][compare]") {
    Image older = coloured(""), newer = coloured("");
    older.channels.push_back({"reflect.object", std::vector<Id>(kWidth * kHeight, 3)});
    newer.channels.push_back({"reflectID.object", std::vector<Id>(kWidth * kHeight, 3)});
    const CommonChannels common = keep_common_channels(older, newer);
    CHECK(common.only_reference.empty());
    CHECK(common.only_test.empty());
    CHECK(compare_seen(common.reference, common.test, "reflect")->pixels == kWidth * kHeight);
}

TEST_CASE("PNG pictures are compared in linear light, with each other and with OpenEXR", "[cli][compare]") {
    const std::string folder = scratch_dir("cli_compare_png");
    const std::string exr = write(folder, "a.exr", coloured("")), png = write(folder, "a.png", coloured(""));
    // Half a step of 8-bit sRGB is at most 0.0046 of linear light, at white.
    CHECK(run_trilens("compare " + exr + " " + png + " --fail 0.005").exit_code == 0);
    CHECK(run_trilens("compare " + exr + " " + png + " --fail 0.001").exit_code == 1);
    CHECK(run_trilens("compare " + png + " " + png + " --hardfail 0").exit_code == 0);

    // The difference of all pixels is 0.02; ten times that is what the picture must show.
    Image brighter = coloured("");
    for (Channel& channel : brighter.channels)
        for (float& value : channel.floats()) value += 0.02f;
    const std::string other = write(folder, "b.exr", brighter), diff = folder + "/diff.png";
    REQUIRE(run_trilens("compare " + exr + " " + other + " -o " + diff + " --scale 10").exit_code == 1);
    const std::vector<ImagePart> shown = read_image_parts(diff);
    for (const char* colour : {"R", "G", "B"})
        for (const float value : shown.at(0).image.find(colour)->floats())
            REQUIRE(value == Approx(0.2).margin(0.004));
}

TEST_CASE("how far pictures of other formats are opaque is compared, or named where only one says it",
          "[cli][compare]") {
    if (!has_program("oiiotool")) TRILENS_SKIP("needs oiiotool");
    const std::string folder = scratch_dir("cli_compare_opacity");
    for (const std::string kind : {"png", "tif"}) {
        for (const std::string alpha : {"0.2", "0.7", "1"})
            oiiotool(folder, "--pattern constant:color=0.8,0.4,0.2," + alpha +
                                 " 8x6 4 -d uint8 --attrib oiio:UnassociatedAlpha 1 -o " + alpha + "." +
                                 kind);
        oiiotool(folder, "0.7." + kind + " --ch R,G,B -d uint8 -o none." + kind);
        const auto compared = [&](const std::string& a, const std::string& b) {
            return run_trilens("compare " + folder + "/" + a + "." + kind + " " + folder + "/" + b + "." +
                               kind);
        };
        INFO(kind);
        CHECK(compared("0.7", "0.7").exit_code == 0);
        const auto other = compared("0.7", "0.2");
        CHECK(other.exit_code == 1);
        CHECK(other.out.find("channel A: 0.2, reference 0.7") != std::string::npos);
        CHECK(compared("0.7", "1").out.find("only in the reference: A") != std::string::npos);
        CHECK(compared("1", "0.7").out.find("only in the test: A") != std::string::npos);
        CHECK(compared("1", "none").out.find("left out") == std::string::npos);
    }
}

TEST_CASE("half against float, and a part of several", "[cli][compare]") {
    if (!has_program("oiiotool")) TRILENS_SKIP("needs oiiotool");
    const std::string folder = scratch_dir("cli_compare_parts");
    write(folder, "a.exr", coloured(""));
    oiiotool(folder, "a.exr -d half -o half.exr");
    oiiotool(folder,
             "a.exr --attrib oiio:subimagename beauty a.exr --addc 0.3 --attrib oiio:subimagename sky "
             "--siappend -o parts.exr");
    const std::string a = folder + "/a.exr", parts = folder + "/parts.exr";
    CHECK(run_trilens("compare " + a + " " + folder + "/half.exr --max max=0.0005").exit_code == 0);
    CHECK(run_trilens("compare " + a + " " + folder + "/half.exr --max max=0").exit_code == 1);
    CHECK(run_trilens("compare --strict " + a + " " + parts).err.find("more than one part") !=
          std::string::npos);
    CHECK(run_trilens("compare " + a + " " + parts).err.find("beauty, sky") != std::string::npos);
    CHECK(run_trilens("compare " + a + " " + parts + " --test-layer beauty").exit_code == 0);
    CHECK(run_trilens("compare " + a + " " + parts + " --test-layer sky").exit_code == 1);
}

TEST_CASE("--max limits any metric by the name that the JSON has", "[cli][compare]") {
    const std::string folder = scratch_dir("cli_compare_max");
    const std::string scene = write_file(folder, "room.json", small_scene());
    REQUIRE(run_trilens("render " + scene + " -n 2 --facets all -o " + folder + "/mine.exr").exit_code == 0);
    REQUIRE(run_trilens("trace " + scene + " -o " + folder + "/truth.exr").exit_code == 0);
    const std::string both = "compare " + folder + "/truth.exr " + folder +
                             "/mine.exr --fail 100 --hardfail 100 "
                             "--warn 100 ";
    REQUIRE(run_trilens(both).exit_code == 0);
    CHECK(run_trilens(both + "--max rmse=0").exit_code == 1);
    CHECK(run_trilens(both + "--max rmse=10 --max displacement_p95=1000 --max ssim=-1").exit_code == 0);
    CHECK(run_trilens(both + "--max ssim=1").exit_code == 1);
    CHECK(run_trilens(both + "--max psnr_db=1000").exit_code == 1);
    CHECK(run_trilens(both + "--max displacement_p95=0").exit_code == 1);
    const CommandRun run = run_trilens(both + "--max rmse=10 --max displacement_mean=0 --max coverage=1.5");
    CHECK(run.exit_code == 1);
    CHECK(run.out.find("displacement_mean is ") != std::string::npos);
    CHECK(run.out.find("at least 1.5") != std::string::npos);
    CHECK(run.out.find("rmse is ") == std::string::npos);

    // Colours that were not asked for do not judge; one that was does.
    const std::string usual = "compare " + folder + "/truth.exr " + folder + "/mine.exr ";
    REQUIRE(run_trilens(usual).exit_code == 1);
    CHECK(run_trilens(usual + "--max displacement_p95=1000").exit_code == 0);
    CHECK(run_trilens(usual + "--max displacement_p95=1000 --failpercent 0").exit_code == 1);
    CHECK(run_trilens(usual + "--fail 9").exit_code == 0);

    // Nor do they warn, or stand in the summary; counts that are limited are counted as usual.
    const CommandRun alone = run_trilens(usual + "--max displacement_p95=1000");
    CHECK(alone.out.find("(colours are not judged)") != std::string::npos);
    CHECK(alone.out.find("PASS\n") != std::string::npos);
    const std::string said = run_trilens(usual + "--max displacement_p95=1000 --json").out;
    for (const char* colour : {"fail", "hardfail", "warn", "allowfailures"})
        CHECK(said.find("\"" + std::string(colour) + "\": null") != std::string::npos);
    CHECK(run_trilens(usual + "--max fail=0").exit_code == 1);
    CHECK(run_trilens(usual + "--max fail=100000000").out.find(" beyond fail, ") != std::string::npos);
    const CommandRun hard = run_trilens(usual + "--max displacement_p95=1000 --hardfail 1000");
    CHECK(hard.exit_code == 0);
    CHECK(hard.out.find("(0 beyond hardfail)") != std::string::npos);

    // A limit on what nothing was measured of does not hold.
    const std::string plain = write(folder, "plain.exr", coloured(""));
    const CommandRun nothing = run_trilens("compare " + plain + " " + plain + " --max lost_percent=100");
    CHECK(nothing.exit_code == 1);
    CHECK(nothing.out.find("lost_percent was not measured") != std::string::npos);
}

TEST_CASE("every metric's limit holds at its own value and breaks beyond it", "[cli][compare]") {
    Comparison comparison;
    comparison.metrics = {1, 2, 3, 4, 0.5, 6, 7, 8, 9};
    comparison.counts.fail = 10;
    comparison.counts.warn = 11;
    comparison.counts.hard = 12;
    LayerComparison layer{"reflect", SeenMismatch{100, 13, 14, 15}, Displacement{}};
    layer.displacement->summary = Summary{16, 17, 18, 19, 20};
    layer.displacement->mean_off_folds = 21;
    layer.bounds = BoundCheck{40, 27, 0.5, 1.0, 2.0};
    layer.displacement->pixels = 49;
    layer.displacement->lost = 25;
    layer.displacement->unmeasured = 26;
    layer.displacement->beyond_radius = 22;
    layer.displacement->missing = 23;
    layer.displacement->coverage = 0.24;
    const std::vector<NamedMetric> metrics = named_metrics(comparison, {layer});
    std::set<double> values;
    std::size_t whole = 0;
    for (const NamedMetric& metric : metrics) {
        INFO(metric.name);
        // A layer's own are the picture's here, where there is one layer, or nothing.
        if (metric.name.find('.') != std::string::npos) continue;
        ++whole;
        REQUIRE(metric.value);
        const double value = *metric.value, beyond = metric.is_likeness ? 1e-9 : -1e-9;
        values.insert(value);
        CHECK(broken_limits({{metric.name, value}}, metrics).empty());
        CHECK(broken_limits({{metric.name, value + beyond}}, metrics).size() == 1);
        CHECK(broken_limits({{metric.name, value - beyond}}, metrics).empty());
    }
    // The percentages are the only numbers that occur twice.
    CHECK(whole - values.size() == 5);
    CHECK(metric_names().size() == metrics.size());
    CHECK_THROWS_AS(broken_limits({{"rmsee", 1}}, metrics), UsageError);

    // Of two layers the worse one counts, and counts add up.
    LayerComparison worse = layer;
    worse.displacement->summary->mean = 160;
    worse.displacement->coverage = 0.1;
    const std::vector<NamedMetric> sums = named_metrics(comparison, {layer, worse});
    const auto value_of = [&](const std::string& name) {
        return *std::find_if(sums.begin(), sums.end(), [&](const auto& m) { return m.name == name; })->value;
    };
    CHECK(value_of("displacement_mean") == 160);
    CHECK(value_of("coverage") == 0.1);
    CHECK(value_of("lost") == 50);
    CHECK(value_of("lost_percent") == 25);
    CHECK(value_of("object_mismatch") == 28);
}
