#include "suite/run_test.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <new>
#include <system_error>
#include <utility>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "image/image_io.h"
#include "suite/suite_page.h"

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

namespace {

/// The first channel that differs in a bit, and in how many pixels; empty where all is one.
std::string first_difference(const Image& a, const Image& b) {
    if (a.width != b.width || a.height != b.height || a.pixels() != b.pixels()) return "the size differs";
    if (a.channels.size() != b.channels.size()) return "the channels differ";
    for (const Channel& channel : a.channels) {
        const Channel* other = b.find(channel.name);
        if (!other || other->is_id() != channel.is_id())
            return "channel " + channel.name + " is in one alone";
        std::size_t differing = 0;
        for (std::size_t i = 0; i < a.pixels(); ++i)
            differing += channel.is_id()
                             ? channel.ids()[i] != other->ids()[i]
                             : std::memcmp(&channel.floats()[i], &other->floats()[i], sizeof(float)) != 0;
        if (differing > 0) return fmt::format("channel {} differs in {} pixels", channel.name, differing);
    }
    return "";
}

Image draw_reference(const RenderTest& test, const SuiteCallbacks& callbacks) {
    const SuiteScene scene = callbacks.open(test, {});
    const int finest = test.resolutions.empty() ? 0 : test.resolutions.back();
    Image image = test.reference_maker == ReferenceMaker::kTruth    ? scene.draw("limit", 0)
                  : test.reference_maker == ReferenceMaker::kFacets ? scene.draw("facets", finest)
                                                                    : scene.draw(test.engine, finest);
    // What depends on the machine and the day stays out of a file that a repository keeps.
    std::erase_if(image.metadata, [](const auto& entry) {
        return entry.first != "trilens:version" && entry.first != "trilens:engine" &&
               entry.first != "trilens:resolution" && entry.first != "trilens:camera";
    });
    return image;
}

std::string change_text(const RenderTest& test, const SuiteCallbacks& callbacks, const Image& image) {
    std::error_code none;
    if (!std::filesystem::exists(test.reference, none)) return "new";
    try {
        const Image old = callbacks.read(test.reference);
        const std::string difference = first_difference(old, image);
        if (difference.empty()) return "unchanged";
        RenderTest any = test;
        any.max.clear();
        const Judgement judgement = judge(any, old, {{0, image}});
        const std::string metrics = metrics_text(judgement.metrics);
        return "changed: " + difference + (metrics.empty() ? "" : "; " + metrics);
    } catch (const InputError& error) {
        return std::string("changed: the old one could not be read (") + error.what() + ")";
    }
}

}  // namespace

std::string update_reference(const RenderTest& test, const SuiteCallbacks& callbacks) {
    const bool is_stored =
        std::find(test.against.begin(), test.against.end(), Against::kGolden) != test.against.end();
    if (!is_stored || test.reference_maker == ReferenceMaker::kElsewhere) return "";
    const Image image = draw_reference(test, callbacks);
    const std::string unrepeated = first_difference(image, draw_reference(test, callbacks));
    if (!unrepeated.empty())
        throw ComputationError(test.reference + " is left as it is: two pictures of the same scene differ (" +
                               unrepeated + ")");
    const std::string change = change_text(test, callbacks, image);
    if (change == "unchanged") return change;
    make_folder(std::filesystem::path(test.reference).parent_path().string());
    write_exr(test.reference, image);
    return change;
}

}  // namespace trilens
