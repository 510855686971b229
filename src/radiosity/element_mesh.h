// The triangles of a world's lit objects, divided into elements by bisections of longest edges.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "base/raymesh/triangle_scene.h"
#include "render/world/world.h"
#include "scene/data/baked_light.h"

namespace trilens {

/// A part of one of World::objects' triangles.
struct RadiosityElement {
    Id mesh = kNone, number = 0;  // its number among the mesh's triangles after the splits
    Id parent = kNone;            // index into World::objects
    Id patch = kNone;             // the element that it was, or was a part of, when patches were named
    std::array<Vec2, 3> barycentrics{Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};  // its corners', in the parent
};

/// What splits have made of a world's objects. Objects that are unlit stay whole, and are no elements, as
/// triangles that blend are none.
class ElementMesh {
  public:
    /// The world must live longer.
    explicit ElementMesh(const World& world);

    const std::vector<RadiosityElement>& elements() const { return elements_; }
    /// The elements, then what stands between them: unlit objects and the facets of mirrors.
    std::shared_ptr<const TriangleScene> triangles() const;
    /// World corners of an element.
    std::array<Vec3, 3> corners(std::size_t element) const;
    /// Of each corner of each element, a number of its place: elements meet where they have equal ones.
    const std::vector<IdTriple>& places() const { return places_; }
    double longest_edge(std::size_t element) const;
    /// Of all that are marked.
    double longest_edge(const std::vector<char>& marked) const;

    /// From now on the elements that there are now are patches.
    void name_patches();

    /// How many elements there would be if these were halved.
    std::size_t count_after(const std::vector<char>& halved) const;
    /// Halves these at their longest edges, and others until elements meet corner to corner again.
    /// Source: Rivara, Algorithms for Refining Triangular Grids Suitable for Adaptive and Multigrid
    /// Techniques, 1984.
    void halve(const std::vector<char>& halved);

    /// How a mesh's triangles came about, in order; and how many it has now.
    const std::vector<TriangleSplit>& splits(Id mesh) const { return parts_[mesh].splits; }
    std::size_t triangle_count(Id mesh) const { return parts_[mesh].object.triangles.size(); }

  private:
    struct MeshPart {
        ObjectMesh object;  // points, triangles and materials alone
        std::unique_ptr<TriangleSplitter> splitter;
        std::vector<TriangleSplit> splits;
        std::vector<Id> element;  // per triangle; kNone: it is none
    };
    using Edge = std::pair<Id, Id>;  // places, the smaller first

    Edge edge_of(std::size_t element, std::size_t k) const;
    std::size_t longest(std::size_t element) const;
    std::map<Edge, Id> marked_edges(const std::vector<char>& halved) const;
    void split(Id element, const std::map<Edge, Id>& new_places);
    Id split_once(Id element, std::size_t edge, Id new_place);

    const World& world_;
    std::vector<MeshPart> parts_;  // by mesh
    std::vector<RadiosityElement> elements_;
    std::vector<IdTriple> places_;
    Id place_count_ = 0;
};

}  // namespace trilens
