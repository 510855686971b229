#include "suite/suite_page.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/util/error.h"
#include "base/util/format.h"
#include "measure/compare.h"
#include "report/page.h"
#include "report/text.h"
#include "suite/run_test.h"

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

namespace {

PagePicture picture_or_reason(const std::string& caption, const std::function<PagePicture()>& make) {
    try {
        return make();
    } catch (const InputError& error) {
        return {caption + ": " + error.what(), 0, 0, {}, {}, false};
    }
}

double value_of(const std::vector<NamedMetric>& metrics, const std::string& name) {
    for (const NamedMetric& metric : metrics)
        if (metric.name == name) return metric.value.value_or(0);
    return 0;
}

/// The layer's R, G, B as an image's own, so that it is seen as it is compared.
Image shown(const Image& image, const std::string& layer) {
    if (layer.empty()) return image;
    Image one = image;
    one.channels.clear();
    for (const char* colour : {"R", "G", "B"})
        if (const Channel* channel = image.find(layer + "." + colour))
            one.channels.push_back({colour, channel->values});
    return one;
}

PagePicture displacement_of(const Displacement& displacement, const std::string& layer, int width) {
    std::vector<float> pixels(displacement.state.size(), std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (displacement.state[i] == Shift::kFound)
            pixels[i] = std::hypot(displacement.shift_x[i], displacement.shift_y[i]);
        else if (displacement.state[i] == Shift::kLost)
            pixels[i] = std::numeric_limits<float>::infinity();
        else if (displacement.state[i] == Shift::kUnmeasured)
            pixels[i] = -std::numeric_limits<float>::infinity();
    }
    return displacement_picture(pixels, width, {}, "displacement, " + layer + displacement_colours(pixels));
}

std::vector<PagePicture> differences_of(const Judgement& judgement, const RenderTest& test) {
    const Image &reference = judgement.images->reference, &picture = judgement.images->test;
    std::vector<PagePicture> pictures;
    const double largest = value_of(judgement.metrics, "max"), flip = value_of(judgement.metrics, "rgb_flip");
    pictures.push_back(picture_or_reason("difference", [&] {
        const double scale = difference_scale(largest);
        return difference_picture(
            shown(picture, test.compare.layer), shown(reference, test.compare.layer), scale,
            "|new − reference| × " + shortest_text(scale) + ", largest " + rounded_text(largest, 2));
    }));
    pictures.push_back(picture_or_reason("FLIP", [&] {
        const Image difference =
            make_difference(reference, picture, {test.compare.layer, test.compare.mask_object});
        return share_picture(difference.find("flip.Y")->floats(), difference.data_width,
                             "FLIP, from 0 (dark) to 1 (yellow), mean " + rounded_text(flip, 3));
    }));
    for (const LayerComparison& layer :
         compare_layers(reference, picture, {test.radius, test.compare.mask_object}))
        if (layer.displacement && layer.displacement->coverage)
            pictures.push_back(displacement_of(*layer.displacement, layer.layer, picture.data_width));
    return pictures;
}

}  // namespace

TestPictures test_pictures(const std::string& against, const Image& reference, const Image& picture,
                           const Judgement& judgement, const RenderTest& test) {
    TestPictures pictures;
    pictures.against = against;
    const std::string caption = "reference (" + against + ")";
    pictures.reference = picture_or_reason(
        caption, [&] { return beauty_picture(shown(reference, test.compare.layer), caption); });
    pictures.picture =
        picture_or_reason("new", [&] { return beauty_picture(shown(picture, test.compare.layer), "new"); });
    if (!judgement.metrics.empty()) pictures.differences = differences_of(judgement, test);
    return pictures;
}

}  // namespace trilens
