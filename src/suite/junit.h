// A suite's results as JUnit XML, the way CI services read test results.
#pragma once

#include <string>

#include "suite/results.h"

namespace trilens {

/// One <testsuite> with one <testcase> per test: <failure>, <error> or <skipped> with the reasons,
/// <system-out> with notes and with what became of the reference. A class is the folder part of the name.
std::string junit_xml(const SuiteResult& result, const std::string& title);

}  // namespace trilens
