// What `trilens test` answers: what passed, what failed and why, and the exit code.
#pragma once

#include <trilens/suite.h>

#include "terminal/command.h"

namespace trilens {

/// A line for each test that did not pass or whose reference changed, the counts, and the fields of
/// `trilens.test/1`.
Answer answer_of(const SuiteRequest& request, const SuiteResult& result);

}  // namespace trilens
