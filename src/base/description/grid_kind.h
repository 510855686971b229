// Where the facets of an optic lie.
#pragma once

namespace trilens {

/// kSurface: N x N per face of the surface (thesis 7.2.1). kScreen: N x N over the optic's bounds on the film
/// (thesis 7.2.2); for optics of many small faces, or none.
enum class GridKind { kSurface, kScreen };

}  // namespace trilens
