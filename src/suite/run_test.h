// Runs one regression test: draws, updates the stored picture on request, judges.
#pragma once

#include <string>
#include <vector>

#include "report/pictures.h"
#include "suite/suite.h"

namespace trilens {

/// What one comparison looks like.
struct TestPictures {
    std::string against;
    PagePicture reference, picture;
    std::vector<PagePicture> differences;  // colours, FLIP, displacement of each layer
};

struct TestOutcome {
    TestResult result;
    std::vector<TestPictures> pictures;  // where they were asked for
};

struct RunTestOptions {
    bool update = false, pictures = false;
};

/// Reads and runs the test of a folder. Throws Interrupted alone: everything else is the test's error.
TestOutcome run_test(const FoundTest& found, const SuiteCallbacks& callbacks, const RunTestOptions& options);

/// Draws the stored picture of a test twice, each time from the scene's files, and stores it where it differs
/// from the one that is there; the file is written beside its name and renamed. Returns what changed:
/// "unchanged", "new", "changed: ..."; empty where the test has no stored picture, or another program makes
/// it. Throws ComputationError, and leaves the old one, where the two pictures differ in any bit; InputError;
/// OutputError.
std::string update_reference(const RenderTest& test, const SuiteCallbacks& callbacks);

}  // namespace trilens
