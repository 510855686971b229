// Regression suites: tests found in folders, run, and reported as JUnit and HTML.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/util/progress.h"
#include "suite/render_test.h"
#include "suite/results.h"

namespace trilens {

/// A test's scene, ready to be drawn.
struct SuiteScene {
    /// `engine`: the test's own, or "limit" and "facets" for ray tracing. `resolution` 0: as the scene says.
    std::function<Image(const std::string& engine, int resolution)> draw;
};

/// How pictures come about; the suite knows nothing of scenes. Both are called from several threads at once.
struct SuiteCallbacks {
    std::function<SuiteScene(const RenderTest& test, const Warn& warn)> open;
    std::function<Image(const std::string& file)> read;  // a stored picture
};

struct SuiteParams {
    std::vector<std::string> folders;
    std::string pattern;      // see matches_pattern; empty: all
    int jobs = 0;             // tests at a time; 0: as many as there are threads
    bool update = false;      // makes stored pictures again before judging; see TestResult::update
    std::string junit, html;  // files to write; empty: none
    std::string title;        // of both; empty: "render tests"
    Progress progress;
    std::function<void(const TestResult& test)>
        on_test;  // after each, never from two threads at once; may be empty
};

/// Runs every test that the pattern means, in any order, and returns them in the order of their names. What
/// goes wrong in one test (a broken test.json, a scene that cannot be read) is that test's error, and the
/// others go on. Throws InputError for folders without tests, UsageError where the pattern means none,
/// OutputError where the JUnit file or the page cannot be written, and Interrupted once params.progress says
/// so, after writing both with the tests that were not run as skipped.
SuiteResult run_suite(const SuiteParams& params, const SuiteCallbacks& callbacks);

}  // namespace trilens
