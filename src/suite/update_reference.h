// A test's stored picture, made again.
#pragma once

#include <string>

#include "suite/suite.h"

namespace trilens {

/// Draws the stored picture of a test twice, each time from the scene's files, and stores it where it differs
/// from the one that is there; the file is written beside its name and renamed. Returns what changed:
/// "unchanged", "new", "changed: ..."; empty where the test has no stored picture, or another program makes
/// it. Throws ComputationError, and leaves the old one, where the two pictures differ in any bit; InputError;
/// OutputError.
std::string update_reference(const RenderTest& test, const SuiteCallbacks& callbacks);

}  // namespace trilens
