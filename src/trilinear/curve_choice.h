// How images of edges are drawn, and where they are cut (Vallance 2005, section 4.5 and chapter 5): choices
// that callers make.
#pragma once

#include <array>

#include "base/util/names.h"

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

}  // namespace trilens
