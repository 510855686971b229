// Fuzz target of regression tests: random scenes, each with a random test.json; what a suite says follows
// from its own numbers, a stored picture of ours agrees with the next one, a changed one does not, and all of
// it repeats.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

#include "fuzz/random_scene.h"
#include "fuzz/target.h"
#include "trilens/compare.h"
#include "trilens/image.h"
#include "trilens/suite.h"

using namespace trilens;
namespace fs = std::filesystem;

namespace trilens_fuzz {
namespace {

/// The choices of one test, from the first bytes.
struct AskedTest {
    std::vector<std::string> against;
    std::string maker = "render", resolution;  // JSON; empty: not given
    std::string metric;                        // empty: no limit
    double limit = 0;
    bool is_own = false;  // held against nothing but the engine's own stored picture
};

AskedTest random_test(std::string_view& bytes) {
    const auto take = [&] {
        const unsigned char byte = bytes.empty() ? 0 : static_cast<unsigned char>(bytes.front());
        bytes.remove_prefix(bytes.empty() ? 0 : 1);
        return byte;
    };
    const unsigned char which = take(), maker = take(), resolution = take(), limit = take(), value = take();
    AskedTest asked;
    const char* const names[] = {"golden", "truth", "facets"};
    for (int i = 0; i < 3; ++i)
        if (which & 1 << i) asked.against.emplace_back(names[i]);
    if (asked.against.empty()) asked.against = {"golden"};
    asked.maker = std::vector<std::string>{"render", "truth", "facets"}[maker % 3];
    asked.resolution = std::vector<std::string>{"", "1", "2", "[1, 2]"}[resolution % 4];
    std::vector<std::string> metrics = limited_names();
    if (asked.resolution != "[1, 2]")
        std::erase_if(metrics, [](const std::string& name) { return name.ends_with("_order"); });
    if (limit >= 128) asked.metric = metrics[limit % metrics.size()];
    asked.limit = std::pow(10.0, value / 32.0 - 6);
    asked.is_own = asked.against == std::vector<std::string>{"golden"} && asked.maker == "render";
    return asked;
}

std::string test_json(const AskedTest& asked) {
    std::string json = fmt::format(R"({{"against": ["{}"], "reference_from": "{}", "set": {{"/film": {}}})",
                                   fmt::join(asked.against, R"(", ")"), asked.maker,
                                   R"({"width": 8, "height": 6, "spp": 1})");
    if (!asked.resolution.empty()) json += R"(, "resolution": )" + asked.resolution;
    if (!asked.metric.empty()) json += fmt::format(R"(, "max": {{"{}": {}}})", asked.metric, asked.limit);
    return json + "}";
}

std::size_t count_of(const std::string& text, std::string_view word) {
    std::size_t count = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
    return count;
}

/// Whether the numbers of a comparison say that the limit is broken: also where there is none.
bool breaks(const TestComparison& comparison, const AskedTest& asked) {
    const auto found = std::find_if(comparison.metrics.begin(), comparison.metrics.end(),
                                    [&](const NamedMetric& one) { return one.name == asked.metric; });
    if (found == comparison.metrics.end() || !found->value) return true;
    return found->is_likeness ? !(*found->value >= asked.limit) : !(*found->value <= asked.limit);
}

void require_follows(const TestResult& result, const AskedTest& asked) {
    require(result.state != TestState::kError && result.state != TestState::kSkipped,
            "a legal test could not be run: " + fmt::format("{}", fmt::join(result.reasons, "; ")));
    require((result.state == TestState::kPassed) == result.reasons.empty(),
            "a test's verdict and its reasons are at odds");
    require(result.comparisons.size() == asked.against.size(), "a comparison that was asked for is missing");
    for (const TestComparison& comparison : result.comparisons)
        for (const NamedMetric& metric : comparison.metrics)
            require(!metric.value || !std::isnan(*metric.value),
                    "a metric that is no number: " + metric.name);
    if (asked.metric.empty()) return;
    std::size_t broken = 0, told = 0;
    for (const TestComparison& comparison : result.comparisons) broken += breaks(comparison, asked);
    for (const std::string& reason : result.reasons) {
        const std::size_t colon = asked.against.size() > 1 ? reason.find(": ") + 2 : 0;
        told += reason.compare(colon, asked.metric.size() + 1, asked.metric + " ") == 0;
    }
    require(told == broken,
            fmt::format("{} limits of {} are broken, and {} told of", broken, asked.metric, told));
}

void require_same(const TestResult& a, const TestResult& b) {
    require(a.state == b.state && a.reasons == b.reasons && a.notes == b.notes,
            "a test's verdict does not repeat");
    for (std::size_t i = 0; i < a.comparisons.size(); ++i)
        for (std::size_t k = 0; k < a.comparisons[i].metrics.size(); ++k)
            require(a.comparisons[i].metrics[k].value == b.comparisons[i].metrics[k].value,
                    "a metric does not repeat: " + a.comparisons[i].metrics[k].name);
}

void require_written(const SuiteRequest& request, const TestResult& result) {
    const std::string junit = file_text(request.junit), page = file_text(request.html);
    require(page.find("</html>") != std::string::npos, "a suite's page without an end");
    require(count_of(junit, "<testcase ") == 1 && junit.find("</testsuite") != std::string::npos,
            "JUnit's file has not the one test");
    require((count_of(junit, "<failure") > 0) == (result.state == TestState::kFailed),
            "JUnit's file and the verdict are at odds");
}

/// The stored picture with a pixel's red raised by so much.
void brighten(const std::string& file, float by) {
    Image image = read_image(file);
    for (Channel& channel : image.channels)
        if (channel.name == "R") channel.floats()[image.pixels() / 2] += by;
    write_image(file, image);
}

/// Own stored pictures: made once, the same when made again, agreed with, and no longer once a pixel is
/// another.
void require_guards(const SuiteRequest& request, const AskedTest& asked, const TestResult& first) {
    const std::string file = request.folders[0] + "/ref/main.exr", before = file_text(file);
    require(first.update == "new", "a stored picture that was not there is not new: " + first.update);
    SuiteRequest again = request;
    again.update = true;
    require(run_suite(again).tests.at(0).update == "unchanged", "a picture made again is another");
    require(file_text(file) == before, "an unchanged picture was written");
    if (!asked.metric.empty()) return;
    if (asked.is_own)
        require(first.state == TestState::kPassed,
                fmt::format("a picture is not its own reference: {}", fmt::join(first.reasons, "; ")));
    brighten(file, 0.5f);
    const TestResult changed = run_suite(request).tests.at(0);
    require(changed.state == TestState::kFailed, "a stored picture with a brighter pixel passes");
    again.update = true;
    require(run_suite(again).tests.at(0).update.starts_with("changed: "),
            "a picture that is put right is not told of");
    require(file_text(file) == before, "a picture that is put right is another");
}

}  // namespace

Answer random_suite(std::string_view bytes) {
    const AskedTest asked = random_test(bytes);
    fs::remove_all(fuzz_folder() + "/suite");
    put_file("suite/test.json", test_json(asked));
    put_file("suite/scene.json", make_random_scene(bytes).json);
    return answer([&] {
        SuiteRequest request;
        request.folders = {fuzz_folder() + "/suite"};
        request.junit = fuzz_folder() + "/suite.xml";
        request.html = fuzz_folder() + "/suite.html";
        const bool is_stored = asked.against[0] == "golden";
        request.update = is_stored;
        const SuiteResult made = on_threads(1, [&] { return run_suite(request); });
        require(made.tests.size() == 1, "a suite of one test has not one");
        require_follows(made.tests[0], asked);
        require_written(request, made.tests[0]);
        request.update = false;
        require_same(made.tests[0], on_threads(3, [&] { return run_suite(request); }).tests.at(0));
        if (is_stored) require_guards(request, asked, made.tests[0]);
    });
}

}  // namespace trilens_fuzz
