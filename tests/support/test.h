// What every test includes: Catch2 of either major version, skips that are counted, and where the data lie.
#ifndef TRILENS_TESTS_SUPPORT_TEST_H
#define TRILENS_TESTS_SUPPORT_TEST_H

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;
using Catch::Matchers::ContainsSubstring;
#else
#include <catch2/catch.hpp>
#endif

#include <string>

#if !__has_include(<catch2/catch_all.hpp>)
/// As the later version calls it, where Contains asks for an element.
inline auto ContainsSubstring(const std::string& text) {
    return Catch::Matchers::Contains(text);
}
#endif

namespace trilens_test {

/// Counts and prints a skip; the run's last lines say how many there were.
void note_skip(const std::string& test, const std::string& why);

/// The project's own folder.
std::string source_dir();
/// Where it is built: the command, the public headers.
std::string build_dir();
/// Cages and models that are not part of the project, as CMake's TRILENS_DATA_DIR names them; empty or
/// missing where there are none: see data_missing.
std::string data_dir();
/// Whether data_dir()/`relative` is missing.
bool data_missing(const std::string& relative);
/// A folder under the build tree for this test's files, made empty; no other test has it.
std::string scratch_dir(const std::string& name);
/// Whether the shell finds a program of this name.
bool has_program(const std::string& name);

}  // namespace trilens_test

/// For what is said where a test does not listen.
inline void ignore(const std::string&) {}

/// Leaves the test, counted as skipped with a reason.
#define TRILENS_SKIP(why)                                                               \
    do {                                                                                \
        trilens_test::note_skip(Catch::getResultCapture().getCurrentTestName(), (why)); \
        return;                                                                         \
    } while (false)

/// Skips where a file of the outside data is missing.
#define TRILENS_NEEDS_DATA(relative)          \
    if (trilens_test::data_missing(relative)) \
    TRILENS_SKIP(std::string("needs ") + (relative) + " of TRILENS_DATA_DIR")

#endif
