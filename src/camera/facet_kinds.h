// What the facets of a camera, or of a mirror, are among the general linear cameras.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "base/raymesh/ray_mesh.h"
#include "camera/camera.h"
#include "camera/model/general_linear.h"

namespace trilens {

/// The kind that a facet's three corner rays make between planes across `axis` (world frame, any length), or,
/// where that is zero or one of the rays does not go its way, across the mean of their unit directions. None
/// where the facet has no rays, two of them are one, or they go opposite ways. Throws
/// InputError (place "facet") for a facet that the mesh does not have, or whose corners it does not have.
std::optional<GeneralLinearKind> facet_kind(const RayMesh& mesh, std::size_t facet, const Vec3& axis = {});

/// How many facets of a mesh are of which kind. What counts them throws InputError as check_ray_mesh does.
struct FacetKinds {
    std::array<std::size_t, kGeneralLinearKindCount> of_kind{};  // by GeneralLinearKind
    std::size_t without = 0;                                     // of no kind

    std::size_t count(GeneralLinearKind kind) const { return of_kind[static_cast<std::size_t>(kind)]; }
};
FacetKinds facet_kinds(const RayMesh& mesh, const Vec3& axis = {});

/// Of a camera's own facets, across its view axis.
FacetKinds facet_kinds(const Camera& camera);

}  // namespace trilens
