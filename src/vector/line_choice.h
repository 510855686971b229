// Which lines a drawing has.
#pragma once

namespace trilens {

/// What is drawn beside the visible edges.
struct LineChoice {
    bool wire = false;      // hidden edges too
    bool folds = false;     // curves where what the optics show turns over on the film (fold_curves.h)
    bool caustics = false;  // the surfaces in the world where neighbouring rays meet (caustic.h); with folds
};

}  // namespace trilens
