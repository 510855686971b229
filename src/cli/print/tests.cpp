#include "cli/print/tests.h"

#include "cli/print/values.h"
#include "terminal/format.h"

namespace trilens {
namespace {

Json metrics_json(const TestComparison& comparison) {
    Json json = Json::object();
    for (const NamedMetric& metric : comparison.metrics) json[metric.name] = optional_json(metric.value);
    return json;
}

Json test_json(const TestResult& test) {
    Json json{{"name", test.name},       {"folder", test.folder},    {"state", test_state_name(test.state)},
              {"reasons", test.reasons}, {"notes", test.notes},      {"tags", test.tags},
              {"seconds", test.seconds}, {"metrics", Json::object()}};
    json["update"] = test.update.empty() ? Json(nullptr) : Json(test.update);
    for (const TestComparison& comparison : test.comparisons)
        json["metrics"][comparison.against] = metrics_json(comparison);
    return json;
}

std::string test_text(const TestResult& test) {
    std::string text;
    if (!test.update.empty() && test.update != "unchanged")
        text += test.name + ": reference " + test.update + "\n";
    if (test.state == TestState::kPassed) return text;
    text += test.name + ": " + test_state_name(test.state) + "\n";
    for (const std::string& reason : test.reasons) text += "  " + reason + "\n";
    return text;
}

ExitCode exit_code(const SuiteResult& result) {
    if (result.count(TestState::kError) > 0) return ExitCode::kSomeJobsFailed;
    if (result.count(TestState::kFailed) > 0) return ExitCode::kExceeded;
    return result.count(TestState::kSkipped) == result.tests.size() ? ExitCode::kSkipped : ExitCode::kDone;
}

}  // namespace

Answer answer_of(const SuiteRequest& request, const SuiteResult& result) {
    Answer answer;
    answer.is_report = true;
    answer.code = exit_code(result);
    answer.fields["tests"] = Json::array();
    for (const TestResult& test : result.tests) {
        answer.fields["tests"].push_back(test_json(test));
        answer.text += test_text(test);
        if (test.state == TestState::kError)
            for (const std::string& reason : test.reasons) answer.errors.push_back(test.name + ": " + reason);
    }
    Json counts = Json::object();
    std::string line;
    for (const TestState state :
         {TestState::kPassed, TestState::kFailed, TestState::kError, TestState::kSkipped}) {
        counts[test_state_name(state)] = result.count(state);
        line += fmt::format("{}{} {}", line.empty() ? "" : ", ", result.count(state), test_state_name(state));
    }
    answer.fields["counts"] = counts;
    answer.fields["seconds"] = result.seconds;
    answer.text += fmt::format("{} in {:.1f} s\n", line, result.seconds);
    if (!request.html.empty()) answer.text += request.html + "\n";
    return answer;
}

}  // namespace trilens
