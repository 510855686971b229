// Light baked into an object: its triangles divided by bisections of edges, and light at their corners.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "json/json.h"
#include "scene/data/scene.h"

namespace trilens {

/// A triangle is halved by the midpoint of its edge from corner `edge` to the next: it keeps its number and
/// that corner, and the other half, with the next corner, comes after the triangles that there are.
struct TriangleSplit {
    Id triangle = 0;
    int edge = 0;  // 0, 1, 2
};

/// Halves triangles one after the other. Uvs, normals and materials go along; midpoints of one edge are one
/// point, and have the same bits wherever both ends do, so that no cracks come about.
class TriangleSplitter {
  public:
    /// `object` must live longer, and is changed. It has no baked light yet.
    explicit TriangleSplitter(ObjectMesh& object) : object_(object) {}

    /// `split`: of a triangle that there is.
    void split(const TriangleSplit& split);

  private:
    Id midpoint(Id a, Id b);

    ObjectMesh& object_;
    std::map<std::pair<Id, Id>, Id> midpoints_;
};

/// A mesh's baked light as its file has it.
struct BakedLightRecord {
    std::size_t triangles = 0;    // of the mesh before its splits
    std::optional<Vec3> corners;  // weighted_corners() of it; without it only their number tells
    std::vector<TriangleSplit> splits;
    std::vector<BakedLight> light;  // per triangle after them
};

/// Tells meshes apart: a sum over the corners of their triangles, each times a weight of its own, so that it
/// is another where points have moved or the corners come in another order. On every machine the same but for
/// rounding, which sines and decoders of pictures make differ: compare by has_corners().
Vec3 weighted_corners(const ObjectMesh& mesh);

/// Whether `corners` is weighted_corners(mesh), within what rounding makes of it.
bool has_corners(const ObjectMesh& mesh, const Vec3& corners);

/// Light as files hold it: five digits of each number.
BakedLight rounded(const BakedLight& light);

/// The value of a mesh's key `bakedLight`; `record.light` is rounded().
Json baked_light_json(const BakedLightRecord& record);

}  // namespace trilens
