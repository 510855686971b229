#include "suite/run_test.h"

#include <algorithm>
#include <filesystem>
#include <new>
#include <system_error>
#include <utility>

#include "base/util/error.h"
#include "base/util/stopwatch.h"
#include "suite/judge.h"
#include "suite/test_pictures.h"
#include "suite/update_reference.h"

namespace trilens {
namespace {

bool is_there(const std::string& file) {
    std::error_code none;
    return std::filesystem::exists(file, none);
}

/// A shell takes it as one word.
std::string quoted(const std::string& text) {
    if (text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-") ==
        std::string::npos)
        return text;
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

std::string missing_reference(const RenderTest& test) {
    const std::string what = "there is no reference " + test.reference + "; ";
    if (test.reference_maker == ReferenceMaker::kElsewhere)
        return what + "store the other program's picture there";
    return what + "make it with: trilens test " + quoted(test.folder) + " --update";
}

std::vector<TestPicture> draw(const RenderTest& test, const SuiteScene& scene) {
    std::vector<int> resolutions = test.resolutions;
    if (resolutions.empty()) resolutions.push_back(0);
    std::vector<TestPicture> pictures;
    for (const int n : resolutions) pictures.push_back({n, scene.draw(test.engine, n)});
    return pictures;
}

Image reference_of(const RenderTest& test, Against against, const SuiteScene& scene,
                   const SuiteCallbacks& callbacks) {
    if (against == Against::kGolden) return callbacks.read(test.reference);
    const int finest = test.resolutions.empty() ? 0 : test.resolutions.back();
    return against == Against::kTruth ? scene.draw("limit", 0) : scene.draw("facets", finest);
}

/// Whether every layer is judged: of a stored picture of ours, where the test names no limits.
bool judges_layers(const RenderTest& test, Against against) {
    return against == Against::kGolden && test.max.empty() &&
           test.reference_maker != ReferenceMaker::kElsewhere;
}

/// Judges the pictures against everything that the test names.
void judge_all(const RenderTest& test, const SuiteScene& scene, const SuiteCallbacks& callbacks,
               const RunTestOptions& options, TestOutcome& outcome) {
    TestResult& result = outcome.result;
    std::optional<std::vector<TestPicture>> pictures;
    for (const Against against : test.against) {
        const std::string label = test.against.size() > 1 ? against_name(against) + ": " : "";
        if (against == Against::kGolden && !is_there(test.reference)) {
            result.reasons.push_back(label + missing_reference(test));
            continue;
        }
        if (!pictures) pictures = draw(test, scene);
        const Image reference = reference_of(test, against, scene, callbacks);
        Judgement judgement = judge(test, reference, *pictures, judges_layers(test, against));
        for (const std::string& reason : judgement.reasons) result.reasons.push_back(label + reason);
        for (const std::string& note : judgement.notes) result.notes.push_back(label + note);
        result.comparisons.push_back({against_name(against), judgement.metrics});
        if (options.pictures)
            outcome.pictures.push_back(
                test_pictures(against_name(against), reference, pictures->back().image, judgement, test));
    }
    result.state = result.reasons.empty() ? TestState::kPassed : TestState::kFailed;
}

void fail(TestResult& result, const std::string& reason) {
    result.state = TestState::kError;
    result.reasons = {reason};
}

}  // namespace

TestOutcome run_test(const FoundTest& found, const SuiteCallbacks& callbacks, const RunTestOptions& options) {
    const Stopwatch watch;
    TestOutcome outcome;
    TestResult& result = outcome.result;
    result.name = found.name;
    result.folder = found.folder;
    try {
        const RenderTest test = read_render_test(found.folder);
        result.about = test.about;
        result.tags = test.tags;
        if (!has_this_platform(test.platforms)) {
            result.state = TestState::kSkipped;
            result.reasons = {"is not for " + this_platform()};
            return outcome;
        }
        if (options.update) result.update = update_reference(test, callbacks);
        // Every picture of the scene says the same.
        const auto note = [&](const std::string& message) {
            if (std::find(result.notes.begin(), result.notes.end(), message) == result.notes.end())
                result.notes.push_back(message);
        };
        judge_all(test, callbacks.open(test, note), callbacks, options, outcome);
    } catch (const Interrupted&) {
        throw;
    } catch (const Error& error) {
        fail(result, error.what());
    } catch (const std::bad_alloc&) {
        fail(result, "out of memory");
    }
    result.seconds = watch.seconds();
    return outcome;
}

}  // namespace trilens
