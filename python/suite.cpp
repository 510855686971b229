// Suites of regression tests.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "bindings.h"
#include "python_call.h"

namespace trilens::python {
namespace {

using SuitePath = std::filesystem::path;

/// A folder, or several.
std::vector<std::string> folders_of(const py::object& folders) {
    std::vector<std::string> all;
    if (py::isinstance<py::str>(folders) || py::hasattr(folders, "__fspath__"))
        return {folders.cast<SuitePath>().string()};
    for (const py::handle& folder : folders) all.push_back(folder.cast<SuitePath>().string());
    return all;
}

py::dict metrics_of(const TestResult& test) {
    py::dict all;
    for (const TestComparison& comparison : test.comparisons) {
        py::dict metrics;
        for (const NamedMetric& metric : comparison.metrics)
            metrics[py::str(metric.name)] = py::cast(metric.value);
        all[py::str(comparison.against)] = metrics;
    }
    return all;
}

void bind_results(py::module_& module) {
    py::class_<TestResult>(module, "SuiteTest", "What became of one regression test.")
        .def_readonly("name", &TestResult::name, "Its path below the folder that was searched.")
        .def_readonly("folder", &TestResult::folder)
        .def_readonly("about", &TestResult::about, "What its test.json says of it.")
        .def_readonly("tags", &TestResult::tags)
        .def_property_readonly(
            "state", [](const TestResult& test) { return test_state_name(test.state); },
            "\"passed\", \"failed\", \"error\" or \"skipped\".")
        .def_readonly(
            "reasons", &TestResult::reasons,
            "One for each threshold that was exceeded; else what went wrong, or why it was skipped.")
        .def_readonly("notes", &TestResult::notes, "What the comparison leaves out.")
        .def_readonly("update", &TestResult::update,
                      "What became of the stored image: \"unchanged\", \"new\", \"changed: ...\".")
        .def_property_readonly(
            "metrics", metrics_of,
            "By \"golden\", \"truth\", \"facets\": each metric's value, None where nothing was "
            "measured.")
        .def_readonly("seconds", &TestResult::seconds)
        .def("__repr__", [](const TestResult& test) {
            return "<trilens.SuiteTest '" + test.name + "', " + test_state_name(test.state) + ">";
        });
    py::class_<SuiteResult>(module, "SuiteResult", "What became of a suite of regression tests.")
        .def_readonly("tests", &SuiteResult::tests, "In the order of their names.")
        .def_readonly("seconds", &SuiteResult::seconds)
        .def_property_readonly(
            "passed",
            [](const SuiteResult& result) {
                return result.count(TestState::kFailed) + result.count(TestState::kError) == 0;
            },
            "Whether no test failed and all could be run.")
        .def("__repr__", [](const SuiteResult& result) {
            return "<trilens.SuiteResult, " + std::to_string(result.count(TestState::kPassed)) + " of " +
                   std::to_string(result.tests.size()) + " tests passed>";
        });
}

}  // namespace

void bind_suite(py::module_& module) {
    bind_results(module);
    module.def(
        "run_suite",
        [](const py::object& folders, const std::string& pattern, int jobs, bool update,
           const std::optional<SuitePath>& junit, const std::optional<SuitePath>& html,
           const std::string& title, const py::object& progress) {
            SuiteRequest request;
            request.folders = folders_of(folders);
            request.pattern = pattern;
            request.jobs = jobs;
            request.update = update;
            request.junit = junit.value_or("").string();
            request.html = html.value_or("").string();
            request.title = title;
            PythonCall call(progress);
            return call.run([&] { return run_suite(request, {call.progress("tests"), {}, {}}); });
        },
        py::arg("folders"), py::arg("pattern") = "", py::kw_only(), py::arg("jobs") = 0,
        py::arg("update") = false, py::arg("junit") = py::none(), py::arg("html") = py::none(),
        py::arg("title") = "", py::arg("progress") = py::none(),
        "Runs regression tests: each is a folder with a test.json, at any depth below the folders.\n\n"
        "pattern: part of a name or tag; with * and ? in it all of one. jobs: tests at a time, 0 as many as "
        "there are threads.\n"
        "update: makes the stored images again first; what does not repeat is refused.\n"
        "junit, html: files to write beside the result, called title.\n"
        "progress: called as progress(done, job); returning False raises Interrupted.\n"
        "A test that cannot be run is an error of its own, and the others go on. Raises InputError for "
        "folders without\n"
        "tests, UsageError for a pattern that means none and where junit or html is a file that the tests "
        "read, OutputError.");
    module.def(
        "list_suite",
        [](const py::object& folders, const std::string& pattern) {
            std::map<std::string, std::vector<std::string>> tags;
            for (const FoundTest& test : list_suite(folders_of(folders), pattern))
                tags[test.folder] = test.tags;
            return tags;
        },
        py::arg("folders"), py::arg("pattern") = "",
        "The folders of the tests that run_suite would run, each with its tags; nothing is drawn.");
}

}  // namespace trilens::python
