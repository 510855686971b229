// A picture held against a reference by the rules of a test, and what every layer keeps to where it names no
// limits.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "measure/common/comparable.h"
#include "report/page.h"
#include "suite/suite.h"

namespace trilens {

/// The picture at one resolution.
struct TestPicture {
    int resolution = 0;  // 0: as the scene says
    Image image;
};

struct Judgement {
    std::vector<std::string> reasons, notes;
    std::vector<NamedMetric> metrics;  // none where the images cannot be compared
    std::optional<CommonChannels> images;
};

/// Judges the last of the pictures; the others count for the order of the displacement alone. Broken are:
/// another size; channels of the reference that the picture lacks, where trilens wrote the reference (another
/// program's are left out, with a note); values that are not finite; the rules of test.compare; test.max.
/// `by_layer`: every layer that either image has is there in both and agrees (layer_rules.h).
Judgement judge(const RenderTest& test, const Image& reference, std::vector<TestPicture> pictures,
                bool by_layer = false);

/// "rmse 0.01, rgb_flip 0.02, displacement_p95 0.3, lost_percent 0.1": the numbers that say most.
std::string metrics_text(const std::vector<NamedMetric>& metrics);

// What every layer of a picture keeps to where a test names no limits.

/// Pixels of a layer that may be off: rounding on another machine may move an edge.
inline constexpr double kLayerPixelsOff = 0.001;  // share of all
/// By how much a value may differ before its pixel is off.
inline constexpr double kColourOff = 0.004;    // R, G, B, A
inline constexpr double kPositionOff = 1e-4;   // X, Y, Z of a point: of the layer's largest coordinate
inline constexpr double kParameterOff = 1e-4;  // U, V
inline constexpr double kOtherOff = 1e-3;  // of the value itself: depths, lengths, all others. Ids are equal

/// The rules broken by layers that both images have, one sentence for each layer: more pixels off than
/// kLayerPixelsOff. Two values that are no number count as equal.
std::vector<std::string> broken_layers(const CommonChannels& images);

/// One sentence for each layer of which only one image has channels, with their names.
std::vector<std::string> missing_layers(const CommonChannels& images);

/// "reflectP" of "reflectP.X"; a channel without a layer is its own.
std::string layer_of(const std::string& channel);

/// "reflectP (reflectP.X, reflectP.Y)" for each layer of the channels.
std::vector<std::string> layers_of(const std::vector<std::string>& channels);

// Runs one regression test: draws, updates the stored picture on request, judges.

/// What one comparison looks like.
struct TestPictures {
    std::string against;
    PagePicture reference, picture;
    std::vector<PagePicture> differences;  // colours, FLIP, displacement of each layer
};

struct TestOutcome {
    TestResult result;
    std::vector<TestPictures> pictures;  // where they were asked for
};

struct RunTestOptions {
    bool update = false, pictures = false;
};

/// Reads and runs the test of a folder. Throws Interrupted alone: everything else is the test's error.
TestOutcome run_test(const FoundTest& found, const SuiteCallbacks& callbacks, const RunTestOptions& options);

/// Draws the stored picture of a test twice, each time from the scene's files, and stores it where it differs
/// from the one that is there; the file is written beside its name and renamed. Returns what changed:
/// "unchanged", "new", "changed: ..."; empty where the test has no stored picture, or another program makes
/// it. Throws ComputationError, and leaves the old one, where the two pictures differ in any bit; InputError;
/// OutputError.
std::string update_reference(const RenderTest& test, const SuiteCallbacks& callbacks);

}  // namespace trilens
