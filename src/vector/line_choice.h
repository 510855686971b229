// Which lines a drawing has.
#pragma once

namespace trilens {

/// What is drawn beside the visible edges.
struct LineChoice {
    bool wire = false;   // hidden edges too
    bool folds = false;  // curves where what the optics show turns over on the film (fold_curves.h)
    // The surfaces in the world where neighbouring rays meet (caustic.h); with folds. All lines are then made
    // of rays that are exact at the facets' corners (`"rays": "interpolated"`), whatever the optics ask.
    bool caustics = false;
};

}  // namespace trilens
