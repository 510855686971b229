// One regression test: a folder with a scene, test.json and references, as data.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/util/error.h"
#include "measure/compare.h"
#include "measure/displacement/displacement.h"

namespace trilens {

/// What a picture is held against: a stored picture, or one traced anew, through the exact surfaces or
/// through the facets of the picture's own resolution.
enum class Against { kGolden, kTruth, kFacets };

/// "golden", "truth", "facets".
std::string against_name(Against against);

/// Who makes the stored picture: the engine under test itself, ray tracing as above, or another program.
enum class ReferenceMaker { kRender, kTruth, kFacets, kElsewhere };

/// A value in the scene file, set before it is read: SceneOverride's fields.
struct SceneSetting {
    std::string pointer, value;  // JSON pointer and JSON text
};

struct RenderTest {
    std::string folder;
    std::string scene, reference;  // files; the folder's name is part of them
    std::vector<Against> against;  // at least one, each once
    ReferenceMaker reference_maker = ReferenceMaker::kRender;
    std::string engine = "exact";
    std::string camera;            // empty: the scene's own
    std::vector<int> resolutions;  // rising; empty: as the scene says. The last one's picture is judged
    std::vector<SceneSetting> set;
    CompareOptions compare;  // rules that the test does not ask for are out of reach
    double radius = DisplacementOptions{}.radius;
    std::vector<MetricLimit> max;
    std::vector<std::string> platforms, tags;  // no platforms: all
    std::string about;
};

/// Reads folder/test.json: strict JSON with comments; keys under "extras" or that start with "x-" are free.
/// `against` must be there; the others have defaults:
///   scene "scene.json", reference "ref/main.exr", reference_from "render" ("truth", "facets", "elsewhere"),
///   engine "exact", camera and resolution the scene's own, set {}, layer "" (the beauty), radius 64, tags
///   [], platforms [] fail, failpercent, failrelative, hardfail, allowfailures   compare's own where neither
///   these nor `max` are given;
///     else what is given and failpercent 0, failrelative 0, allowfailures 0, and no fail (0.004 beside
///     failpercent) and no hardfail
///   max {}   where it is empty, every layer of a stored picture of ours is held against the same layer (see
///     layer_rules.h). Else limits by metric: the names of metric_names() and, with several resolutions,
///     displacement_order
///   (also
///     reflect.displacement_order and refract.displacement_order), of which more is better
/// Throws InputError with the file and the place of the first problem, and the nearest known name.
RenderTest read_render_test(const std::string& folder);

/// The JSON Schema (draft 7) of test.json, as text.
std::string test_schema();

/// What `max` may name.
std::vector<std::string> limited_names();

// Regression suites: tests found in folders, run, and reported as JUnit XML, the way CI services read them,
// and HTML.

// Results of a suite of regression tests, and as JUnit XML, the way CI services read them.

enum class TestState {
    kPassed,
    kFailed,  // a tolerance was exceeded, or the stored picture is missing
    kError,   // the test could not be run
    kSkipped  // not for this platform, or not reached before an interruption
};

/// "passed", "failed", "error", "skipped".
std::string test_state_name(TestState state);

/// The numbers of one comparison of the picture.
struct TestComparison {
    std::string against;  // "golden", "truth", "facets"
    std::vector<NamedMetric> metrics;
};

struct TestResult {
    std::string name, folder, about;
    std::vector<std::string> tags;
    TestState state = TestState::kPassed;
    std::vector<std::string>
        reasons;  // one for each threshold that was exceeded; else what went wrong, or why skipped
    std::vector<std::string> notes;  // what the scene, or a comparison of fewer channels, leaves out
    std::string update;  // what became of the stored picture: "unchanged", "new", "changed: ..."; empty: it
                         // was not asked for, or the test has none of its own
    std::vector<TestComparison> comparisons;
    double seconds = 0;
};

struct SuiteResult {
    std::vector<TestResult> tests;
    double seconds = 0;

    std::size_t count(TestState state) const;
};

/// One `testsuite` with one `testcase` per test: `failure`, `error` or `skipped` with the reasons,
/// `system-out` with notes and with what became of the reference. A class is the folder part of the name.
std::string junit_xml(const SuiteResult& result, const std::string& title);

// Regression suites: tests found in folders, run, and reported as JUnit and HTML.

/// A test's scene, ready to be drawn.
struct SuiteScene {
    /// `engine`: the test's own, or "limit" and "facets" for ray tracing. `resolution` 0: as the scene says.
    std::function<Image(const std::string& engine, int resolution)> draw;
};

/// How pictures come about; the suite knows nothing of scenes. The first two are called from several threads
/// at once.
struct SuiteCallbacks {
    std::function<SuiteScene(const RenderTest& test, const Warn& warn)> open;
    std::function<Image(const std::string& file)> read;  // a stored picture
    Progress progress = {};
    std::function<void(const TestResult& test)> on_test =
        {};  // after each, never from two threads at once; may be empty
};

/// Which tests are run, and what is written. A test is a folder with a test.json, at any depth below
/// `folders`.
struct SuiteRequest {
    std::vector<std::string> folders;
    std::string pattern;  // part of a name or tag; with * and ? in it all of one; empty: every test
    int jobs = 0;         // tests at a time; 0: as many as there are threads
    bool update = false;  // makes the stored pictures again before judging; what does not repeat is refused
    std::string junit, html;  // files to write beside the result; empty: none
    std::string title;        // of both; empty: "render tests"
};

/// Runs every test that the pattern means, in any order, and returns them in the order of their names. What
/// goes wrong in one test (a broken test.json, a scene that cannot be read) is that test's error, and the
/// others go on. Throws InputError for folders without tests, UsageError where the pattern means none,
/// OutputError where the JUnit file or the page cannot be written, and Interrupted once callbacks.progress
/// says so, after writing both with the tests that were not run as skipped.
SuiteResult run_suite(const SuiteRequest& request, const SuiteCallbacks& callbacks);

// Which tests there are below some folders, and which of them are meant.

/// A folder that holds a test.json.
struct FoundTest {
    std::string name;    // its path below the folder that was searched, with that folder where there are
                         // several; the folder's own name where it is itself a test
    std::string folder;  // as it is opened
    std::vector<std::string> tags;  // of its test.json; empty where that cannot be read
};

/// The tests of `folders` that `pattern` means. Throws as find_tests does, and UsageError where it means none
/// of them.
std::vector<FoundTest> meant_tests(const std::vector<std::string>& folders, const std::string& pattern);

/// Every folder at or below `folders`, at any depth, in the order of their names; a test found twice counts
/// once. Links to folders are not followed. Throws InputError where a folder cannot be read or none of them
/// holds a test.
std::vector<FoundTest> find_tests(const std::vector<std::string>& folders);

/// Whether the pattern is part of the name or of a tag; with * (anything) or ? (one character) in it, whether
/// it is all of one of them. The empty pattern means all.
bool matches_pattern(const std::string& pattern, const std::string& name,
                     const std::vector<std::string>& tags);

/// Whether a list of platforms ("linux", "x86_64", "linux-x86_64") has this machine's; an empty one has
/// every.
bool has_this_platform(const std::vector<std::string>& platforms);

/// "linux-x86_64".
std::string this_platform();

}  // namespace trilens
