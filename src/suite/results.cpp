#include "suite/results.h"

#include <algorithm>

#include "base/util/format.h"
#include "report/text.h"

namespace trilens {

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

}  // namespace trilens
