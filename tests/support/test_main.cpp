// The tests' main: runs them, then says how many assertions were made and how many tests were skipped. With
// --write-ctest FILE it writes each test case, with its labels, as CTest reads them.
#define CATCH_CONFIG_RUNNER
#include "support/test.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <vector>

namespace {

std::map<std::string, std::string>& skips() {
    static std::map<std::string, std::string> by_test;
    return by_test;
}

}  // namespace

namespace trilens_test {

void note_skip(const std::string& test, const std::string& why) {
    skips()[test] = why;
}

std::string source_dir() {
    return TRILENS_SOURCE_DIR;
}

std::string build_dir() {
    return TRILENS_BUILD_DIR;
}

std::string data_dir() {
    return TRILENS_DATA_DIR;
}

bool data_missing(const std::string& relative) {
    return data_dir().empty() || !std::filesystem::exists(data_dir() + "/" + relative);
}

std::string scratch_dir(const std::string& name) {
    // Tests run side by side, each in a process of its own.
    const std::size_t test = std::hash<std::string>()(Catch::getResultCapture().getCurrentTestName());
    char number[2 * sizeof(test) + 1];
    std::snprintf(number, sizeof(number), "%zx", test);
    const std::filesystem::path folder = std::filesystem::path(build_dir()) / "scratch" / number / name;
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder.string();
}

bool has_program(const std::string& name) {
    return std::system(("command -v " + name + " > /dev/null 2>&1").c_str()) == 0;
}

}  // namespace trilens_test

namespace {

struct Totals {
    std::size_t assertions = 0, tests = 0, failed = 0;
};
Totals& totals() {
    static Totals value;
    return value;
}

#if __has_include(<catch2/catch_all.hpp>)
using ListenerBase = Catch::EventListenerBase;
#else
using ListenerBase = Catch::TestEventListenerBase;
#endif

struct CountListener : ListenerBase {
    using ListenerBase::ListenerBase;
    void testCaseEnded(const Catch::TestCaseStats& stats) override {
        totals().assertions += stats.totals.assertions.total();
        totals().tests += 1;
        totals().failed += stats.totals.assertions.allOk() ? 0 : 1;
    }
};

struct Case {
    std::string name;
    std::vector<std::string> tags;
};

std::vector<Case> all_cases() {
    std::vector<Case> cases;
    const auto& registry = Catch::getRegistryHub().getTestCaseRegistry();
#if __has_include(<catch2/catch_all.hpp>)
    for (const Catch::TestCaseInfo* info : registry.getAllInfos()) {
        cases.push_back({info->name, {}});
        for (const Catch::Tag& tag : info->tags) cases.back().tags.emplace_back(tag.original);
    }
#else
    for (const Catch::TestCase& info : registry.getAllTests()) cases.push_back({info.name, info.tags});
#endif
    return cases;
}

/// The name as a test spec that only it matches.
std::string as_spec(const std::string& name) {
    std::string spec = name[0] == '-' ? "*" : "";  // else it were an option
    for (const char c : name) {
        if (std::strchr("\\,[]\"", c)) spec += '\\';
        spec += c;
    }
    return spec;
}

/// A test's labels are its tags. What is hidden for another reason than its length (a test's helper) is no
/// test of CTest's. Names are written as bracket arguments, which CMake does not look into.
int write_ctest(const char* program, const char* file) {
    std::ofstream out(file);
    std::set<std::string> names;
    for (const auto& [name, tags] : all_cases()) {
        const std::set<std::string> labels(tags.begin(), tags.end());
        if (labels.count(".") && !labels.count("long")) continue;
        if (!names.insert(name).second) {
            std::fprintf(stderr, "two tests have the name \"%s\"\n", name.c_str());
            return 1;
        }
        out << "add_test([==[" << name << "]==] [==[" << program << "]==] [==[" << as_spec(name) << "]==])\n"
            << "set_tests_properties([==[" << name << "]==] PROPERTIES LABELS \"";
        const char* separator = "";
        for (const std::string& label : labels) {
            if (label == ".") continue;
            out << separator << label;
            separator = ";";
        }
        out << "\")\n";
    }
    return out.flush() ? 0 : 1;
}

}  // namespace

CATCH_REGISTER_LISTENER(CountListener)

int main(int argc, char** argv) {
    if (argc == 3 && std::strcmp(argv[1], "--write-ctest") == 0)
        return write_ctest(std::filesystem::canonical(argv[0]).c_str(), argv[2]);
    std::set<std::string> names;
    for (const auto& [name, tags] : all_cases()) names.insert(name);
    const int result = Catch::Session().run(argc, argv);
    for (const auto& [test, why] : skips()) std::printf("skipped: %s: %s\n", test.c_str(), why.c_str());
    // A skip is of a whole test, by its name, or of a part of one that else went on.
    const std::size_t skipped = skips().size(), failed = totals().failed, rest = totals().tests - failed;
    const auto whole = static_cast<std::size_t>(std::count_if(
        skips().begin(), skips().end(), [&](const auto& skip) { return names.count(skip.first) > 0; }));
    std::printf("%zu assertions\n%zu passed, %zu failed, %zu skipped\n", totals().assertions,
                rest - std::min(rest, whole), failed, skipped);
    return result;
}
