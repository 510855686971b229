// Laws of rays and images of points, held in both directions: what rays see `project` finds, and the reverse.
#pragma once

#include "trilens/project.h"

namespace trilens_fuzz {

/// The exact ray through each image of a point goes through the point; weights are shares of light.
void require_images(const trilens::Renderer& renderer, const trilens::Scene& scene);

/// What a ray through the film sees is found there by `searching`, which may follow shorter paths, where the
/// list of images is said to be complete.
void require_shots(const trilens::Renderer& renderer, const trilens::Scene& scene,
                   const trilens::Renderer& searching);

}  // namespace trilens_fuzz
