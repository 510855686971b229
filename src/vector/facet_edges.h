// Which edges of the scene a facet's samples may show: those of the triangles that they see, and on from
// these as far as samples cannot tell.
#pragma once

#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "vector/drawing.h"

namespace trilens {

/// Indices into view.edges.edge, ascending: what `samples` of the facet and the samples beside them see, the
/// edges around it, and those of triangles beside these of which no sample tells, as at the rim of a finely
/// divided ball: nearer to what is seen than two samples in the picture. Without those of which no ray of
/// the facet sees a silhouette. All edges where `view.wire`. The facet has rays.
std::vector<Id> edges_at_samples(const VectorView& view, Id facet, std::span<const Id> samples);

}  // namespace trilens
