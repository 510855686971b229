// trilens test: regression suites against stored or fresh ray-traced pictures.
#include <trilens/suite.h>

#include <utility>

#include "cli/commands.h"
#include "cli/print/print.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

struct TestOptions {
    SuiteRequest request;
    bool schema = false;
};

Answer run(const TestOptions& options, Console& console) {
    if (options.schema)
        return Answer{.text = test_schema(), .fields = {{"schema_document", Json::parse(test_schema())}}};
    const SuiteRequest& request = options.request;
    if (request.folders.empty()) throw UsageError("test needs folders that hold tests");
    console.files().writes(request.junit);
    console.files().writes(request.html);
    SuiteObserver observer;
    // Scenes are read for their files only where one of them could be lost.
    if (console.files().has_old_outputs())
        observer.reads = [&](const std::vector<std::string>& files) { console.files().reads(files); };
    observer.progress = console.progress("tests");
    observer.on_test = [&](const TestResult& test) {
        console.note(fmt::format("{}: {} in {:.2f} s", test.name, test_state_name(test.state), test.seconds));
        for (const std::string& note : test.notes) console.note("  " + note);
    };
    return answer_of(request, run_suite(request, observer));
}

}  // namespace

Command test_command() {
    auto options = std::make_shared<TestOptions>();
    SuiteRequest* const request = &options->request;
    Command command{
        .name = "test",
        .summary =
            "regression tests against stored or fresh ray-traced images: exit 0 within tolerance, 1 beyond",
        .options =
            {{.names = "DIRS",
              .target = &request->folders,
              .help = "folders that hold tests, at any depth: a test is a folder with a test.json",
              .offer = Offer::kFolder},
             {.names = "--schema",
              .target = &options->schema,
              .help = "print the JSON Schema of test.json, and run nothing"},
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
    command.body = [options](Console& console) { return run(*options, console); };
    return command;
}

}  // namespace trilens
