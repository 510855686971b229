// Suites of regression tests, each test with its scene drawn.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "suite/suite.h"

namespace trilens {

/// How a suite says what it does; all may be empty.
struct SuiteObserver {
    Progress progress;
    std::function<void(const TestResult& test)> on_test;  // after each, never from two threads at once
    // Before any test: every file that the tests read, whether it is there or not. What it throws ends the
    // suite
    std::function<void(const std::vector<std::string>& files)> reads = {};
};

/// Runs the tests and returns them in the order of their names. A test that cannot be run is an error of its
/// own (TestState::kError), and the others go on; results do not depend on `jobs`. Throws InputError for
/// folders without tests, UsageError where the pattern means none or where `junit` or `html` is a file that
/// tests below `folders` read, OutputError, Interrupted.
SuiteResult run_suite(const SuiteRequest& request, const SuiteObserver& observer = {});

/// The tests that run_suite would run, in the order in which they are found; nothing is drawn. Throws as
/// run_suite does.
std::vector<FoundTest> list_suite(const std::vector<std::string>& folders, const std::string& pattern = "");

}  // namespace trilens
