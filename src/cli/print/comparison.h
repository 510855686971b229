// What `trilens compare` and `trilens test` answer, as text and JSON: how two images differ; what passed,
// what failed and why, and the exit code.
#pragma once

#include <trilens/compare.h>
#include <trilens/suite.h>

#include <string>
#include <vector>

#include "terminal/command.h"

namespace trilens {

// Formats a comparison of two images as text and JSON.

struct CompareRequest {
    std::string reference, test, difference;  // files
    std::string layer_of_reference, layer_of_test;
    bool strict = false;
    std::vector<MetricLimit> limits;
    double scale = 1;  // of a difference in .png
    double radius = DisplacementOptions{}.radius;
    CompareOptions options;
    std::string display_server;  // "HOST:PORT"; empty: none
};

/// The two images with the channels that they share, and what was found.
struct ComparedInputs {
    CommonChannels images;
    Comparison comparison;
    std::vector<LayerComparison> layers;
    std::vector<float> flip;  // layer_flip of the images
};

/// The table and the verdict, and the fields of `trilens.compare/1`.
Answer compare_answer(const CompareRequest& request, const ComparedInputs& inputs);

// What `trilens test` answers: what passed, what failed and why, and the exit code.

/// A line for each test that did not pass or whose reference changed, the counts, and the fields of
/// `trilens.test/1`.
Answer answer_of(const SuiteRequest& request, const SuiteResult& result);

}  // namespace trilens
