// Scenes for fits, and pairs made by projecting points into them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "inverse/fit/fit.h"
#include "trilens/project.h"
#include "trilens/scene.h"

namespace trilens_test {

/// A camera before a mirror ball, a glass ball, a saddle of nine faces, or a turned pawn-like body.
std::string ball_scene();
std::string glass_scene();
std::string saddle_scene();

/// `count` seeded pairs: points of a box around the optic and where the scene's camera sees them over it.
std::vector<trilens::Correspondence> make_pairs(const trilens::Scene& scene, std::size_t count,
                                                const std::string& word, unsigned seed = 1);

/// The pairs with seeded normal noise of `sigma` pixels.
std::vector<trilens::Correspondence> with_noise(std::vector<trilens::Correspondence> pairs, double sigma,
                                                unsigned seed);

}  // namespace trilens_test
