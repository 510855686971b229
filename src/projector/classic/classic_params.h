// The settings of the thesis' engine: apart from the engine, since callers choose them.
#pragma once

#include "trilinear/curve_choice.h"

namespace trilens {

/// How the classic engine draws. The defaults are exact but for `tolerance`.
struct ClassicParams {
    Curves curves = Curves::kArcs;
    Clip clip = Clip::kScene;
    int pieces = 8;            // kSlices, kTessellate: at least 1
    double tolerance = 0.001;  // kArcs: how far an outline may leave its conic, in pixels
};

}  // namespace trilens
