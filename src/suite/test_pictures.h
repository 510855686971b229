// What a test's comparison looks like.
#pragma once

#include <string>

#include "suite/judge.h"
#include "suite/run_test.h"

namespace trilens {

/// Reference and picture, and where they could be compared the difference of the colours, FLIP and the
/// displacement of each layer; what cannot be shown is a caption that says why.
TestPictures test_pictures(const std::string& against, const Image& reference, const Image& picture,
                           const Judgement& judgement, const RenderTest& test);

}  // namespace trilens
