// How many facets a grid has, without making it.
#include <unordered_set>

#include "surfaces/surfaces.h"

namespace trilens {

std::size_t count_facets(const Surface& surface, int n) {
    const std::size_t side_squares = static_cast<std::size_t>(n);
    const Id faces = static_cast<Id>(surface.face_count());
    std::unordered_set<Id> split;  // edges that one of their faces sees as halves
    for (Id face = 0; face < faces; ++face)
        for (const FaceSide& side : surface.border(face).sides)
            if (side.edge != kNone && side.part != FaceSide::Part::kWhole) split.insert(side.edge);

    std::size_t count = 0;
    for (Id face = 0; face < faces; ++face) {
        if (surface.domain(face) == FaceDomain::kTriangle) {
            count += side_squares * side_squares;
            continue;
        }
        count += 2 * side_squares * side_squares;
        // Each square along a whole side of a split edge has one corner more, hence one facet more.
        for (const FaceSide& side : surface.border(face).sides)
            if (side.part == FaceSide::Part::kWhole && split.contains(side.edge)) count += side_squares;
    }
    return count;
}

int resolution_within(const Surface& surface, int n, std::size_t most_facets) {
    while (n > 1 && count_facets(surface, n) > most_facets) --n;
    return n;
}

}  // namespace trilens
