#include "suite/results.h"

#include <algorithm>

namespace trilens {

std::string test_state_name(TestState state) {
    switch (state) {
        case TestState::kPassed:
            return "passed";
        case TestState::kFailed:
            return "failed";
        case TestState::kError:
            return "error";
        case TestState::kSkipped:
            return "skipped";
    }
    return "";
}

std::size_t SuiteResult::count(TestState state) const {
    return static_cast<std::size_t>(std::count_if(
        tests.begin(), tests.end(), [&](const TestResult& test) { return test.state == state; }));
}

}  // namespace trilens
