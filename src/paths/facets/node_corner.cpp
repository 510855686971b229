#include "paths/facets/node_corner.h"

#include "reflect/mirror.h"

namespace trilens {

NodeCorner first_reflection(const Look& look, const PathSegment* segment) {
    NodeCorner corner;
    corner.ray = {look.place.point, mirrored(look.incident, look.place.normal)};
    corner.screen = look.screen;
    if (segment) corner.next = segment->next / length(look.incident);
    return corner;
}

double farther(const Look& look, const PathSegment& segment, bool unfolds) {
    return unfolds ? segment.way / length(look.incident) : 1;
}

NodeCorner later_corner(const Look& look, const PathSegment& segment, double kappa, bool unfolds) {
    const double factor = farther(look, segment, unfolds);
    const double size = length(look.incident) * factor * kappa;
    return {{segment.ray.origin, size * segment.ray.direction},
            factor * look.screen,
            segment.next / size,
            segment.weight};
}

}  // namespace trilens
