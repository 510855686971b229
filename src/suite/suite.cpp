#include "suite/suite.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "base/files/file_bytes.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "base/util/progress.h"
#include "base/util/run_on_threads.h"
#include "suite/find_tests.h"
#include "suite/results.h"
#include "suite/run_test.h"
#include "suite/suite_page.h"

namespace trilens {
namespace {

/// The tests, taken one after the other by a few threads.
class SuiteRun {
  public:
    SuiteRun(const SuiteParams& params, const SuiteCallbacks& callbacks, std::vector<FoundTest> tests)
        : params_(params), callbacks_(callbacks), tests_(std::move(tests)), outcomes_(tests_.size()) {}

    void run() {
        const int wanted = params_.jobs > 0 ? params_.jobs : thread_count();
        const std::size_t jobs = std::min(tests_.size(), static_cast<std::size_t>(wanted));
        params_.progress(0);
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
                if (i >= tests_.size() || params_.progress.cancelled()) return;
                TestOutcome outcome =
                    run_test(tests_[i], callbacks_, {params_.update, !params_.html.empty()});
                const std::lock_guard lock(mutex_);
                outcomes_[i] = std::move(outcome);
                ++done_;
                if (params_.on_test) params_.on_test(outcomes_[i]->result);
                params_.progress(static_cast<double>(done_) / static_cast<double>(tests_.size()));
            }
        } catch (const Interrupted&) {
            next_ = tests_.size();
        } catch (...) {
            const std::lock_guard lock(mutex_);
            if (!failure_) failure_ = std::current_exception();
            next_ = tests_.size();
        }
    }

    const SuiteParams& params_;
    const SuiteCallbacks& callbacks_;
    std::vector<FoundTest> tests_;
    std::vector<std::optional<TestOutcome>> outcomes_;
    std::atomic<std::size_t> next_ = 0;
    std::size_t done_ = 0;
    std::exception_ptr failure_;
    std::mutex mutex_;
};

}  // namespace

SuiteResult run_suite(const SuiteParams& params, const SuiteCallbacks& callbacks) {
    const Stopwatch watch;
    SuiteRun run(params, callbacks, meant_tests(params.folders, params.pattern));
    run.run();
    std::map<std::string, std::vector<TestPictures>> pictures;
    SuiteResult result = run.take(pictures);
    result.seconds = watch.seconds();
    const std::string title = params.title.empty() ? "render tests" : params.title;
    if (!params.junit.empty()) replace_text_file(params.junit, junit_xml(result, title));
    if (!params.html.empty()) replace_text_file(params.html, suite_html(result, pictures, title));
    if (!run.is_whole()) throw Interrupted();
    return result;
}

}  // namespace trilens
