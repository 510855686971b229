// Which tests there are below some folders, and which of them are meant.
#pragma once

#include <string>
#include <vector>

namespace trilens {

/// A folder that holds a test.json.
struct FoundTest {
    std::string name;    // its path below the folder that was searched, with that folder where there are
                         // several; the folder's own name where it is itself a test
    std::string folder;  // as it is opened
    std::vector<std::string> tags;  // of its test.json; empty where that cannot be read
};

/// The tests of `folders` that `pattern` means. Throws as find_tests does, and UsageError where it means none
/// of them.
std::vector<FoundTest> meant_tests(const std::vector<std::string>& folders, const std::string& pattern);

/// Every folder at or below `folders`, at any depth, in the order of their names; a test found twice counts
/// once. Links to folders are not followed. Throws InputError where a folder cannot be read or none of them
/// holds a test.
std::vector<FoundTest> find_tests(const std::vector<std::string>& folders);

/// Whether the pattern is part of the name or of a tag; with * (anything) or ? (one character) in it, whether
/// it is all of one of them. The empty pattern means all.
bool matches_pattern(const std::string& pattern, const std::string& name,
                     const std::vector<std::string>& tags);

/// Whether a list of platforms ("linux", "x86_64", "linux-x86_64") has this machine's; an empty one has
/// every.
bool has_this_platform(const std::vector<std::string>& platforms);

/// "linux-x86_64".
std::string this_platform();

}  // namespace trilens
