// Light baked into an object: its triangles divided by bisections of edges, and light at their corners.
#pragma once

#include <array>
#include <cstddef>
#include <map>
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
    std::size_t triangles = 0;  // of the mesh before its splits
    std::vector<TriangleSplit> splits;
    std::vector<BakedLight> light;  // per triangle after them
};

/// Light as files hold it: five digits of each number.
BakedLight rounded(const BakedLight& light);

/// The value of a mesh's key `bakedLight`; `record.light` is rounded().
Json baked_light_json(const BakedLightRecord& record);

}  // namespace trilens
