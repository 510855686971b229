#include "suite/suite.h"

#include <sys/utsname.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/parallel.h"
#include "report/text.h"
#include "suite/run_test.h"
#include "suite/suite_page.h"

namespace trilens {
namespace {

/// The tests, taken one after the other by a few threads.
class SuiteRun {
  public:
    SuiteRun(const SuiteRequest& request, const SuiteCallbacks& callbacks, std::vector<FoundTest> tests)
        : request_(request), callbacks_(callbacks), tests_(std::move(tests)), outcomes_(tests_.size()) {}

    void run() {
        const int wanted = request_.jobs > 0 ? request_.jobs : thread_count();
        const std::size_t jobs = std::min(tests_.size(), static_cast<std::size_t>(wanted));
        callbacks_.progress(0);
        run_on_threads(jobs, [this] { work(); });
        if (failure_) std::rethrow_exception(failure_);
    }

    bool is_whole() const { return done_ == tests_.size(); }

    /// Moves out what was found.
    SuiteResult take(std::map<std::string, std::vector<TestPictures>>& pictures) {
        SuiteResult result;
        for (std::size_t i = 0; i < tests_.size(); ++i) {
            TestOutcome outcome = outcomes_[i].value_or(not_reached(tests_[i]));
            pictures[outcome.result.name] = std::move(outcome.pictures);
            result.tests.push_back(std::move(outcome.result));
        }
        std::sort(result.tests.begin(), result.tests.end(),
                  [](const TestResult& a, const TestResult& b) { return a.name < b.name; });
        return result;
    }

  private:
    static TestOutcome not_reached(const FoundTest& test) {
        TestOutcome outcome;
        outcome.result.name = test.name;
        outcome.result.folder = test.folder;
        outcome.result.state = TestState::kSkipped;
        outcome.result.reasons = {"was not reached: interrupted"};
        return outcome;
    }

    void work() {
        try {
            for (;;) {
                const std::size_t i = next_++;
                if (i >= tests_.size() || callbacks_.progress.cancelled()) return;
                TestOutcome outcome =
                    run_test(tests_[i], callbacks_, {request_.update, !request_.html.empty()});
                const std::lock_guard lock(mutex_);
                outcomes_[i] = std::move(outcome);
                ++done_;
                if (callbacks_.on_test) callbacks_.on_test(outcomes_[i]->result);
                callbacks_.progress(static_cast<double>(done_) / static_cast<double>(tests_.size()));
            }
        } catch (const Interrupted&) {
            next_ = tests_.size();
        } catch (...) {
            const std::lock_guard lock(mutex_);
            if (!failure_) failure_ = std::current_exception();
            next_ = tests_.size();
        }
    }

    const SuiteRequest& request_;
    const SuiteCallbacks& callbacks_;
    std::vector<FoundTest> tests_;
    std::vector<std::optional<TestOutcome>> outcomes_;
    std::atomic<std::size_t> next_ = 0;
    std::size_t done_ = 0;
    std::exception_ptr failure_;
    std::mutex mutex_;
};

}  // namespace

SuiteResult run_suite(const SuiteRequest& request, const SuiteCallbacks& callbacks) {
    const Stopwatch watch;
    SuiteRun run(request, callbacks, meant_tests(request.folders, request.pattern));
    run.run();
    std::map<std::string, std::vector<TestPictures>> pictures;
    SuiteResult result = run.take(pictures);
    result.seconds = watch.seconds();
    const std::string title = request.title.empty() ? "render tests" : request.title;
    if (!request.junit.empty()) replace_text_file(request.junit, junit_xml(result, title));
    if (!request.html.empty()) replace_text_file(request.html, suite_html(result, pictures, title));
    if (!run.is_whole()) throw Interrupted();
    return result;
}

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

namespace {

std::string joined(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
    return text;
}

std::string outcome(const TestResult& test) {
    const std::string reasons = escape_markup(joined(test.reasons));
    const std::string message =
        test.reasons.empty() ? "" : " message=\"" + escape_markup(test.reasons.front()) + "\"";
    switch (test.state) {
        case TestState::kPassed:
            return "";
        case TestState::kFailed:
            return "      <failure" + message + " type=\"tolerance\">" + reasons + "</failure>\n";
        case TestState::kError:
            return "      <error" + message + " type=\"error\">" + reasons + "</error>\n";
        case TestState::kSkipped:
            return "      <skipped" + message + "/>\n";
    }
    return "";
}

std::string testcase(const TestResult& test, const std::string& title) {
    const std::size_t slash = test.name.rfind('/');
    const std::string group = slash == std::string::npos ? title : test.name.substr(0, slash);
    std::vector<std::string> said = test.notes;
    if (!test.update.empty()) said.push_back("reference " + test.update);
    std::string body = outcome(test);
    if (!said.empty()) body += "      <system-out>" + escape_markup(joined(said)) + "</system-out>\n";
    return fmt::format("    <testcase name=\"{}\" classname=\"{}\" time=\"{}\"", escape_markup(test.name),
                       escape_markup(group), fixed_text(test.seconds, 3)) +
           (body.empty() ? "/>\n" : ">\n" + body + "    </testcase>\n");
}

}  // namespace

std::string junit_xml(const SuiteResult& result, const std::string& title) {
    const std::string counts = fmt::format(
        "name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{}\"",
        escape_markup(title), result.tests.size(), result.count(TestState::kFailed),
        result.count(TestState::kError), result.count(TestState::kSkipped), fixed_text(result.seconds, 3));
    std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites " + counts +
                      ">\n  <testsuite " + counts + ">\n";
    for (const TestResult& test : result.tests) xml += testcase(test, title);
    return xml + "  </testsuite>\n</testsuites>\n";
}

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
