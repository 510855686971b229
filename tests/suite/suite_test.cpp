// Suites with pictures made up here: what is broken, refused, skipped, and in which order it is told.
#include "suite/suite.h"

#include <atomic>
#include <filesystem>
#include <limits>

#include "base/files/files.h"
#include "base/util/error.h"
#include "image/image_io.h"
#include "support/test.h"

using namespace trilens;
namespace fs = std::filesystem;

namespace {

Image grey(float value, int width = 12, int height = 8) {
    Image image{width, height, 0,  0,
                width, height, {}, {{"trilens:version", "0"}, {"trilens:folder", "/elsewhere"}}};
    for (const char* name : {"R", "G", "B"})
        image.channels.push_back({name, std::vector<float>(image.pixels(), value)});
    return image;
}

/// Draws `picture(engine)`.
SuiteCallbacks drawing(const std::function<Image(const std::string& engine)>& picture) {
    return {[picture](const RenderTest&, const Warn&) {
                return SuiteScene{[picture](const std::string& engine, int) { return picture(engine); }};
            },
            [](const std::string& file) { return read_exr(file); }};
}

void write_test(const std::string& folder, const std::string& json) {
    make_folder(folder);
    replace_text_file(folder + "/test.json", json);
}

TestResult only(const SuiteRequest& request, const SuiteCallbacks& callbacks) {
    const SuiteResult result = run_suite(request, callbacks);
    REQUIRE(result.tests.size() == 1);
    return result.tests[0];
}

}  // namespace

TEST_CASE("what does not repeat is refused, and the stored picture stays", "[suite][bad-input]") {
    const std::string folder = trilens_test::scratch_dir("suite_repeat");
    write_test(folder, R"({ "against": "golden" })");
    std::atomic<int> calls = 0;
    const SuiteCallbacks still = drawing([](const std::string&) { return grey(0.5f); });
    const SuiteCallbacks restless =
        drawing([&](const std::string&) { return grey(0.5f + 0.001f * static_cast<float>(calls++)); });
    SuiteRequest request;
    request.folders = {folder};
    request.update = true;
    CHECK(only(request, still).update == "new");
    const std::string stored = *read_whole_file(folder + "/ref/main.exr");
    CHECK(read_exr(folder + "/ref/main.exr").metadata.count("trilens:folder") == 0);

    const TestResult refused = only(request, restless);
    CHECK(refused.state == TestState::kError);
    CHECK(refused.reasons[0].find("two pictures of the same scene differ (channel R differs in 96 pixels)") !=
          std::string::npos);
    CHECK(*read_whole_file(folder + "/ref/main.exr") == stored);
    CHECK(only(request, still).update == "unchanged");
}

TEST_CASE("NaN, a lost channel and another size are broken whatever the limits", "[suite][bad-input]") {
    const std::string folder = trilens_test::scratch_dir("suite_always");
    write_test(folder, R"({ "against": "golden", "max": { "rmse": 1000 } })");
    SuiteRequest request;
    request.folders = {folder};
    request.update = true;
    only(request, drawing([](const std::string&) { return grey(0.5f); }));
    request.update = false;
    const auto reason = [&](const Image& picture) {
        const TestResult test = only(request, drawing([&](const std::string&) { return picture; }));
        CHECK(test.state == TestState::kFailed);
        REQUIRE_FALSE(test.reasons.empty());
        return test.reasons[0];
    };
    Image odd = grey(0.5f);
    odd.find("G")->floats()[5] = std::numeric_limits<float>::quiet_NaN();
    CHECK(reason(odd) == "1 pixels hold NaN in the test");
    Image poor = grey(0.5f);
    poor.channels.pop_back();
    CHECK(reason(poor) == "the picture lacks the layer B, which the reference has (B)");
    CHECK(reason(grey(0.5f, 10)) == "the size is 10 x 8, and the reference's is 12 x 8");
}

TEST_CASE("rules that are not asked for do not count, and those that are do", "[suite]") {
    const std::string folder = trilens_test::scratch_dir("suite_rules");
    const auto state = [&](const std::string& rules) {
        write_test(folder, R"({ "against": "truth")" + rules + " }");
        SuiteRequest request;
        request.folders = {folder};
        return only(request,
                    drawing([](const std::string& engine) { return grey(engine == "limit" ? 0.5f : 0.6f); }))
            .state;
    };
    CHECK(state("") == TestState::kFailed);
    CHECK(state(R"(, "max": { "rmse": 0.2 })") == TestState::kPassed);
    CHECK(state(R"(, "max": { "rmse": 0.05 })") == TestState::kFailed);
    CHECK(state(R"(, "max": { "fail": 95 })") == TestState::kFailed);
    CHECK(state(R"(, "max": { "fail": 96 })") == TestState::kPassed);
    CHECK(state(R"(, "max": { "psnr_db": 15 })") == TestState::kPassed);
    CHECK(state(R"(, "max": { "psnr_db": 25 })") == TestState::kFailed);
    CHECK(state(R"(, "max": { "displacement_p95": 99 })") == TestState::kFailed);  // nothing was measured
    CHECK(state(R"(, "hardfail": 0.2)") == TestState::kPassed);
    CHECK(state(R"(, "hardfail": 0.05)") == TestState::kFailed);
    CHECK(state(R"(, "fail": 0.05, "failpercent": 100)") == TestState::kPassed);
    CHECK(state(R"(, "fail": 0.05, "failpercent": 99)") == TestState::kFailed);
    CHECK(state(R"(, "fail": 0.05, "allowfailures": 96)") == TestState::kPassed);
    CHECK(state(R"(, "fail": 0.05, "max": { "hard": 1 })") == TestState::kError);
}

TEST_CASE("patterns are parts of a name, or globs of all of it", "[suite]") {
    CHECK(matches_pattern("", "a", {}));
    CHECK(matches_pattern("la", "glass/ball", {}));
    CHECK(matches_pattern("mirror", "ball", {"mirrors"}));
    CHECK_FALSE(matches_pattern("mirror*", "ball of mirror", {}));
    CHECK(matches_pattern("*/b?ll", "glass/ball", {}));
    CHECK(matches_pattern("g*s/*l*l", "glass/ball", {}));
    CHECK_FALSE(matches_pattern("g?ass", "glass/ball", {}));
}

TEST_CASE("a platform is a system, a processor, or both", "[suite]") {
    const std::string here = this_platform();
    CHECK(has_this_platform({}));
    CHECK(has_this_platform({"plan9", here}));
    CHECK(has_this_platform({here.substr(0, here.find('-'))}));
    CHECK(has_this_platform({here.substr(here.find('-') + 1)}));
    CHECK_FALSE(has_this_platform({"plan9", here + "x"}));
}

TEST_CASE("JUnit holds any text", "[suite]") {
    SuiteResult result;
    result.tests.push_back(
        {"a/<b>", "", "", {}, TestState::kFailed, {"1 < 2 & \"x\"", "\x01"}, {}, "", {}, 1.5});
    const std::string xml = junit_xml(result, "t");
    CHECK(xml.find("<testcase name=\"a/&lt;b&gt;\" classname=\"a\" time=\"1.500\">") != std::string::npos);
    CHECK(xml.find("1 &lt; 2 &amp; &quot;x&quot;\n\xEF\xBF\xBD</failure>") != std::string::npos);
}

TEST_CASE("a test.json may name its schema, which has every field of it", "[suite]") {
    const std::string schema = test_schema();
    for (const char* word :
         {"trilens-test-1.schema.json", "against", "scene", "max", "failpercent", "platforms"})
        CHECK(schema.find('"' + std::string(word) + '"') != std::string::npos);
    const std::string folder = trilens_test::scratch_dir("suite_schema");
    replace_text_file(folder + "/test.json",
                      R"({"$schema": "trilens-test-1.schema.json", "against": "truth"})");
    CHECK(read_render_test(folder).against == std::vector<Against>{Against::kTruth});
}
