// Light at the corners of elements: each vertex gathers by a hemicube of its own what patches send.
#pragma once

#include <array>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "radiosity/element_mesh.h"
#include "radiosity/form_factors.h"
#include "radiosity/patch_light.h"

namespace trilens {

/// What patches send: the solution, and what sees it.
struct PatchRadiosity {
    const FormFactors& factors;       // of the patches' triangles
    std::span<const Vec3> radiosity;  // of their sides
};

/// Irradiance over pi.
struct LightAtVertex {
    Vec3 direct{0}, indirect{0};
};

/// Where sides of elements meet at one place and turn at most kSmoothAngle away from one another: they have
/// one light.
struct RadiosityVertex {
    HemicubePlace place;  // a little way inside of the elements, so that it is on them for sure
    ShadedPoint point;    // the same on one of them
};

inline constexpr double kSmoothAngle = 30;  // degrees

/// Light at vertices, each computed once, however often elements are halved.
class VertexLight {
  public:
    /// All must live longer.
    VertexLight(const ElementMesh& mesh, const DirectLight& direct, const PatchRadiosity& patches)
        : mesh_(mesh), direct_(direct), patches_(patches) {}

    /// How many vertices a mesh has.
    static std::size_t count(const ElementMesh& mesh);

    /// Finds the vertices that the mesh has now, and the light at those that are new. The same for any number
    /// of threads. Throws Interrupted; `progress` says how many of the new ones are done.
    void update(const Progress& progress = {});

    /// At a corner of a side (see side_of) of an element that has an area; else none.
    LightAtVertex at(Id side, std::size_t corner) const;
    /// All of them, in an order of their own.
    const std::vector<RadiosityVertex>& vertices() const { return vertices_; }
    const std::vector<LightAtVertex>& light() const { return light_; }

  private:
    using Key = std::pair<Id, Id>;  // place, and the least of the sides of parents that meet there

    const ElementMesh& mesh_;
    const DirectLight& direct_;
    PatchRadiosity patches_;
    std::map<Key, Id> known_;
    std::vector<RadiosityVertex> vertices_;
    std::vector<LightAtVertex> light_;
    std::vector<IdTriple> vertex_of_;  // per side; kNone: no area
};

}  // namespace trilens
