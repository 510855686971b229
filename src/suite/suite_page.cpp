#include "suite/suite_page.h"

#include <algorithm>

#include "base/util/format.h"
#include "report/page.h"
#include "report/text.h"
#include "suite/judge.h"

namespace trilens {
namespace {

using PicturesByName = std::map<std::string, std::vector<TestPictures>>;

std::string paragraph(const std::string& style, const std::string& text) {
    return "<p class=\"" + style + "\">" + escape_markup(text) + "</p>\n";
}

std::size_t bytes_of(const std::vector<TestPictures>& all) {
    std::size_t bytes = 0;
    for (const TestPictures& one : all) {
        bytes += one.reference.png.size() + one.picture.png.size();
        for (const PagePicture& picture : one.differences) bytes += picture.png.size();
    }
    return bytes;
}

/// What broke comes first, then errors, then what was not run, then what holds.
int rank(TestState state) {
    switch (state) {
        case TestState::kFailed:
            return 0;
        case TestState::kError:
            return 1;
        case TestState::kSkipped:
            return 2;
        case TestState::kPassed:
            return 3;
    }
    return 4;
}

std::string cards(const SuiteResult& result) {
    std::string html = "<div class=\"cards\">\n";
    for (const TestState state :
         {TestState::kFailed, TestState::kError, TestState::kPassed, TestState::kSkipped})
        html += "<div class=\"card\">" + html_text("b", std::to_string(result.count(state))) +
                html_text("span", test_state_name(state)) + "</div>\n";
    return html + "</div>\n";
}

std::string tags_text(const TestResult& test) {
    std::string text;
    for (const std::string& tag : test.tags) text += (text.empty() ? "" : ", ") + tag;
    return text;
}

std::string section(const TestResult& test, const std::vector<TestPictures>* pictures) {
    std::string html = "<section class=\"run\" id=\"" + escape_markup(test.name) + "\">\n" +
                       html_text("h3", test.name + ": " + test_state_name(test.state)) + "\n";
    if (!test.about.empty()) html += paragraph("soft", test.about);
    for (const std::string& reason : test.reasons)
        html += paragraph(test.state == TestState::kSkipped ? "soft" : "error", reason);
    for (const std::string& note : test.notes) html += paragraph("warning", note);
    if (!test.update.empty()) html += paragraph("soft", "reference " + test.update);
    for (std::size_t i = 0; pictures && i < pictures->size(); ++i)
        html += html_flip((*pictures)[i].reference, (*pictures)[i].picture, (*pictures)[i].differences);
    for (const TestComparison& comparison : test.comparisons)
        if (!comparison.metrics.empty())
            html +=
                paragraph("soft", "against " + comparison.against + ": " + metrics_text(comparison.metrics));
    return html + "</section>\n";
}

std::string table(const SuiteResult& result) {
    std::vector<std::vector<std::string>> rows;
    for (const TestResult& test : result.tests) {
        std::string numbers;
        for (const TestComparison& comparison : test.comparisons)
            if (!comparison.metrics.empty())
                numbers += (numbers.empty() ? "" : "; ") + comparison.against + ": " +
                           metrics_text(comparison.metrics);
        rows.push_back({test.name, test_state_name(test.state), fixed_text(test.seconds, 2) + " s",
                        tags_text(test), numbers});
    }
    return html_text("h2", "All tests") + html_table({"test", "state", "time", "tags", "numbers"}, rows);
}

}  // namespace

std::string suite_html(const SuiteResult& result, const PicturesByName& pictures, const std::string& title) {
    std::vector<const TestResult*> order;
    for (const TestResult& test : result.tests) order.push_back(&test);
    std::stable_sort(order.begin(), order.end(), [](const TestResult* a, const TestResult* b) {
        return rank(a->state) < rank(b->state);
    });
    std::string body =
        html_text("h1", title) + "\n" +
        paragraph("soft", fmt::format("{} tests in {} s. The new picture shows the reference under "
                                      "the pointer; the key F exchanges all of them.",
                                      result.tests.size(), fixed_text(result.seconds, 1))) +
        cards(result);
    std::size_t embedded = 0, left_out = 0;
    std::string sections;
    for (const TestResult* test : order) {
        const auto found = pictures.find(test->name);
        const std::vector<TestPictures>* shown = found == pictures.end() ? nullptr : &found->second;
        if (shown && embedded + bytes_of(*shown) > kMostPictureBytes) {
            left_out += 1;
            shown = nullptr;
        }
        if (shown) embedded += bytes_of(*shown);
        sections += section(*test, shown);
    }
    if (left_out > 0)
        body += paragraph("warning", fmt::format("{} tests are without pictures here: the page would grow "
                                                 "beyond {} MB. Run them alone with -k.",
                                                 left_out, kMostPictureBytes / 1'000'000));
    return html_page(title, body + sections + table(result));
}

}  // namespace trilens
