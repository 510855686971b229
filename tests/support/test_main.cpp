// The tests' main: runs them, then says how many assertions were made and how many tests were skipped.
#define CATCH_CONFIG_RUNNER
#include "support/test.h"

#include <cstdio>
#include <filesystem>
#include <map>

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

bool data_missing(const std::string& relative) {
    return data_dir().empty() || !std::filesystem::exists(data_dir() + "/" + relative);
}

std::string scratch_dir(const std::string& name) {
    const std::filesystem::path folder = std::filesystem::path(TRILENS_BUILD_DIR) / "scratch" / name;
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    return folder.string();
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

}  // namespace

CATCH_REGISTER_LISTENER(CountListener)

int main(int argc, char** argv) {
    const int result = Catch::Session().run(argc, argv);
    for (const auto& [test, why] : skips()) std::printf("skipped: %s: %s\n", test.c_str(), why.c_str());
    const std::size_t skipped = skips().size(), failed = totals().failed;
    std::printf("%zu assertions\n%zu passed, %zu failed, %zu skipped\n", totals().assertions,
                totals().tests - failed - skipped, failed, skipped);
    return result;
}
