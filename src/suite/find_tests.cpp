#include "suite/find_tests.h"

#include <sys/utsname.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <system_error>

#include "base/util/error.h"
#include "suite/render_test.h"

namespace trilens {
namespace {

namespace fs = std::filesystem;

bool is_test(const fs::path& folder) {
    std::error_code none;
    return fs::is_regular_file(folder / "test.json", none);
}

std::vector<fs::path> tests_below(const std::string& folder) {
    std::error_code error;
    std::vector<fs::path> found;
    if (is_test(folder)) found.push_back(folder);
    fs::recursive_directory_iterator entry(folder, error), end;
    for (; !error && entry != end; entry.increment(error))
        if (entry->is_directory(error) && !entry->is_symlink(error) && is_test(entry->path()))
            found.push_back(entry->path());
    if (error) throw InputError(folder, "", "cannot be read: " + error.message());
    std::sort(found.begin(), found.end());
    return found;
}

std::string name_of(const fs::path& test, const std::string& folder, bool is_alone) {
    const fs::path below = test.lexically_relative(folder);
    const bool is_folder = below.empty() || below == ".";
    if (!is_alone)
        return (is_folder ? fs::path(folder) : fs::path(folder) / below).lexically_normal().generic_string();
    if (!is_folder) return below.generic_string();
    std::error_code none;
    return fs::weakly_canonical(test, none).filename().generic_string();
}

/// A test whose test.json is broken has none: it is run, and says what is wrong.
std::vector<std::string> tags_of(const std::string& folder) {
    try {
        return read_render_test(folder).tags;
    } catch (const InputError&) {
        return {};
    }
}

/// `*` is any text, `?` one character.
bool is_glob_of(const std::string& pattern, const std::string& text) {
    std::size_t p = 0, t = 0, star = std::string::npos, from = 0;
    while (t < text.size()) {
        if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
            ++p, ++t;
        } else if (p < pattern.size() && pattern[p] == '*') {
            star = p++, from = t;
        } else if (star != std::string::npos) {
            p = star + 1, t = ++from;
        } else {
            return false;
        }
    }
    return pattern.find_first_not_of('*', p) == std::string::npos;
}

}  // namespace

std::vector<FoundTest> find_tests(const std::vector<std::string>& folders) {
    std::vector<FoundTest> found;
    std::set<std::string> known;
    for (const std::string& given : folders) {
        std::string folder = given;
        while (folder.size() > 1 && folder.back() == '/') folder.pop_back();
        for (const fs::path& test : tests_below(folder)) {
            std::error_code none;
            if (known.insert(fs::weakly_canonical(test, none).string()).second)
                found.push_back(
                    {name_of(test, folder, folders.size() == 1), test.string(), tags_of(test.string())});
        }
    }
    if (found.empty()) {
        std::string named;
        for (const std::string& folder : folders) named += (named.empty() ? "" : ", ") + folder;
        throw InputError(named, "", "holds no test: a test is a folder with a test.json");
    }
    return found;
}

std::vector<FoundTest> meant_tests(const std::vector<std::string>& folders, const std::string& pattern) {
    std::vector<FoundTest> found = find_tests(folders);
    const std::size_t all = found.size();
    std::erase_if(found,
                  [&](const FoundTest& test) { return !matches_pattern(pattern, test.name, test.tags); });
    if (found.empty())
        throw UsageError("none of the " + std::to_string(all) + " tests has \"" + pattern +
                         "\" in its name or tags");
    return found;
}

bool matches_pattern(const std::string& pattern, const std::string& name,
                     const std::vector<std::string>& tags) {
    const bool is_glob = pattern.find_first_of("*?") != std::string::npos;
    const auto matches = [&](const std::string& text) {
        return is_glob ? is_glob_of(pattern, text) : text.find(pattern) != std::string::npos;
    };
    return matches(name) || std::any_of(tags.begin(), tags.end(), matches);
}

std::string this_platform() {
    utsname machine{};
    if (uname(&machine) != 0) return "unknown";
    std::string system = machine.sysname;
    std::transform(system.begin(), system.end(), system.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return system + "-" + machine.machine;
}

bool has_this_platform(const std::vector<std::string>& platforms) {
    const std::string here = this_platform();
    const std::size_t dash = here.find('-');
    return platforms.empty() || std::any_of(platforms.begin(), platforms.end(), [&](const std::string& one) {
               return one == here || one == here.substr(0, dash) ||
                      (dash != std::string::npos && one == here.substr(dash + 1));
           });
}

}  // namespace trilens
