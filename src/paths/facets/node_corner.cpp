#include "paths/facets/node_corner.h"

#include "reflect/reflection.h"

namespace trilens {

NodeCorner first_reflection(const PathProbe& probe, const PathSegment* segment) {
    NodeCorner corner;
    corner.ray = {probe.place.point, mirrored(probe.incident, probe.place.normal)};
    corner.screen = probe.screen;
    if (segment) corner.next = segment->next / length(probe.incident);
    return corner;
}

double farther(const PathProbe& probe, const PathSegment& segment, bool unfolds) {
    return unfolds ? segment.way / length(probe.incident) : 1;
}

NodeCorner later_corner(const PathProbe& probe, const PathSegment& segment, double ray_scale, bool unfolds) {
    const double factor = farther(probe, segment, unfolds);
    const double size = length(probe.incident) * factor * ray_scale;
    return {{segment.ray.origin, size * segment.ray.direction},
            factor * probe.screen,
            segment.next / size,
            segment.weight};
}

}  // namespace trilens
