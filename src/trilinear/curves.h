// Curved edges by straight pieces, as the thesis draws them: slices and tessellation (Vallance 2005,
// section 4.5), and where images are cut (chapter 5).
#pragma once

#include <vector>

#include "base/util/enum_names.h"
#include "trilinear/facet/scene_edge.h"

namespace trilens {

/// How curved edges between projected vertices are drawn.
enum class Curves {
    kStraight,  // as straight lines
    kSlices,  // with points at further levels of t (section 4.5.2): `pieces` parts of each edge's stretch of
              // t
    kTessellate,  // the scene triangle as pieces^2 triangles, each straight (section 4.5.1)
    kArcs,        // along the exact conics, within `tolerance`
};

/// What of the image outside the facet is cut away.
enum class Clip {
    kUnclipped,  // nothing
    kScreen,     // the polygons, at the facet's edges (section 5.1)
    kScene,  // the scene's edges, where they cross the surfaces that the facet's edges sweep (section 5.2):
             // facets that share an edge share these points, so that pictures are continuous across them
};

template <>
struct EnumNames<Curves> {
    static constexpr std::array kTable{NamedValue<Curves>{Curves::kArcs, "arcs"},
                                       NamedValue<Curves>{Curves::kSlices, "slices"},
                                       NamedValue<Curves>{Curves::kTessellate, "tessellate"},
                                       NamedValue<Curves>{Curves::kStraight, "straight"}};
};
template <>
struct EnumNames<Clip> {
    static constexpr std::array kTable{NamedValue<Clip>{Clip::kScene, "scene"},
                                       NamedValue<Clip>{Clip::kScreen, "screen"},
                                       NamedValue<Clip>{Clip::kUnclipped, "none"}};
};

/// From one t to another, which may be smaller.
struct Stretch {
    double from = 0, to = 0;
};

/// The ends, on one scene edge, of the slices at the levels of t that divide the stretch into `pieces` equal
/// parts, in its order. The thesis divides what lies between the vertices of a whole shape; dividing each
/// edge's own stretch gives both triangles that share the edge the same points, bit for bit, so that no gap
/// opens between them.
std::vector<ImageVertex> slice_ends(const Coplanarity& facet, const SceneTriangle& triangle, std::size_t edge,
                                    Stretch stretch, int pieces);

/// A piece of a scene triangle: its corners, and their barycentrics in the whole.
struct TrianglePiece {
    SceneTriangle triangle;
    std::array<Vec3, 3> barycentric;
};

/// The triangle as pieces * pieces congruent ones. Points on an edge that two triangles share come out the
/// same, bit by bit, for both.
std::vector<TrianglePiece> tessellate(const SceneTriangle& triangle, int pieces);

}  // namespace trilens
