// The corner rays after one event at an optic, fitted to the exact rays between them.
#pragma once

#include "base/linear_camera.h"
#include "base/ray_mesh.h"
#include "base/surface.h"
#include "paths/corner_rays.h"

namespace trilens {

/// The optic whose mesh is fitted.
struct FirstOptic {
    const Surface& surface;
    const SurfaceGrid& grid;  // of the surface
    const LinearCamera& camera;
    double ior = 1;  // of kRefract, as make_path_mesh has it
};

/// Sets the rays of a mesh of make_path_mesh to the L2 projection of the exact origins and directions onto
/// its piecewise linear functions (mathematics, section 1), measured on the screen. The exact rays are those
/// at three places of the surface inside each facet, whose own screen positions say where they count. Facets
/// with a corner turned away from the eye, or at or behind it, take no part, so the fit ends at silhouettes;
/// and it ends at creases and boundaries, where corners are not shared. A flat mirror's rays stay as they
/// are.
void fit_first_rays(const FirstOptic& optic, PathMesh& mesh);

}  // namespace trilens
