// Results of a suite of regression tests, and as JUnit XML, the way CI services read them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "measure/limits.h"

namespace trilens {

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

}  // namespace trilens
