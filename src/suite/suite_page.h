// A suite's results as one HTML page: failures first, each with its pictures.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "suite/run_test.h"

namespace trilens {

/// The largest sum of PNG bytes that a page embeds; tests that pass give up their pictures first.
inline constexpr std::size_t kMostPictureBytes = 40'000'000;

/// The page, self-contained. `pictures`: by the test's name.
std::string suite_html(const SuiteResult& result,
                       const std::map<std::string, std::vector<TestPictures>>& pictures,
                       const std::string& title);

/// Reference and picture, and where they could be compared the difference of the colours, FLIP and the
/// displacement of each layer; what cannot be shown is a caption that says why.
TestPictures test_pictures(const std::string& against, const Image& reference, const Image& picture,
                           const Judgement& judgement, const RenderTest& test);

}  // namespace trilens
