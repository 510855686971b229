// trilens test: regression suites against stored or fresh ray-traced pictures.
#include <trilens/suite.h>

#include <utility>

#include "cli/commands.h"
#include "terminal/format.h"

namespace trilens {
namespace {

Json metrics_json(const TestComparison& comparison) {
    Json json = Json::object();
    for (const NamedMetric& metric : comparison.metrics)
        json[metric.name] = metric.value ? json_number(*metric.value) : Json(nullptr);
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

Answer run(const SuiteRequest& request, Console& console) {
    console.files().writes(request.junit);
    console.files().writes(request.html);
    SuiteTalk talk;
    talk.progress = console.progress("tests");
    talk.on_test = [&](const TestResult& test) {
        console.note(fmt::format("{}: {} in {:.2f} s", test.name, test_state_name(test.state), test.seconds));
        for (const std::string& note : test.notes) console.note("  " + note);
    };
    return answer_of(request, run_suite(request, talk));
}

}  // namespace

Command test_command() {
    auto request = std::make_shared<SuiteRequest>();
    Command command{
        .name = "test",
        .summary =
            "regression tests against stored or fresh ray-traced images: exit 0 within tolerance, 1 beyond",
        .options =
            {{.names = "DIRS",
              .target = &request->folders,
              .help = "folders that hold tests, at any depth: a test is a folder with a test.json",
              .offer = Offer::kFolder,
              .is_required = true},
             {.names = "-k,--keyword",
              .target = &request->pattern,
              .help = "only tests with this in their name or tags; with * or ? in it, all of a name or tag",
              .value = "PATTERN"},
             {.names = "-j,--jobs",
              .target = &request->jobs,
              .help = "tests at a time; 0 means as many as there are threads",
              .range = {0, 4096}},
             {.names = "--update",
              .target = &request->update,
              .help = "make the stored images again first, and say what changes; what does not repeat is "
                      "refused"},
             {.names = "--junit",
              .target = &request->junit,
              .help = "write the results as JUnit XML",
              .value = "FILE",
              .offer = Offer::kFile},
             {.names = "--html",
              .target = &request->html,
              .help = "write one page with the pictures, failures first",
              .value = "FILE",
              .offer = Offer::kFile}},
        .schema = "test"};
    command.body = [request](Console& console) { return run(*request, console); };
    return command;
}

}  // namespace trilens
