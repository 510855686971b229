// A fit as one self-contained HTML page: parameters, correlations, and residuals over the film.
#pragma once

#include <span>
#include <string>

#include "inverse/fit/fit.h"

namespace trilens {

/// The residuals of all pairs as arrows over the film (an SVG document): from the pixel, `longer` times as
/// long as they are; outliers in another colour, lost pairs as crosses.
struct FitArrows {
    std::string svg;
    double longer = 1;
};
FitArrows residual_arrows(const Scene& scene, std::span<const Correspondence> pairs, const FitResult& result);

/// The page. `title`: of the scene.
std::string fit_html(const Scene& scene, std::span<const Correspondence> pairs, const FitResult& result);

}  // namespace trilens
