// The images of a grid's points over a chain of mirrors: each found from its neighbour's.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/raymesh/surface.h"
#include "paths/nested/mirror_chain.h"

namespace trilens {

/// The eye's rays over the chain in these directions, but those that miss a mirror.
std::vector<ChainRay> rays_over(const MirrorChain& chain, std::span<const Vec3> towards);

/// Per point of the grid one image, where the search finds one: first from the ray of `starts` that passes it
/// at the smallest angle, then from point to point along facets. Where a point has several images, neighbours
/// have those that belong together. Of a closed surface points all of whose facets are turned away, and that
/// stand next to none that is not, have none. The same for any number of threads.
std::vector<std::optional<ChainRay>> grid_images(const MirrorChain& chain, std::span<const ChainRay> starts,
                                                 const SurfaceGrid& grid);

}  // namespace trilens
