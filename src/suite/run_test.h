// One test of a suite: drawn, updated where that is asked for, judged.
#pragma once

#include <vector>

#include "report/pictures.h"
#include "suite/find_tests.h"
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

}  // namespace trilens
