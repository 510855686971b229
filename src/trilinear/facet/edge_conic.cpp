// The lines of rays that vary linearly, as quadratics (mathematics, section 2).
#include "trilinear/facet/edge_conic.h"

namespace trilens {

LineQuadratic line_quadratic(const AffineRays& rays) {
    const auto& [o, d, w] = rays;
    LineQuadratic line;
    line.direction = {w[0] * d[0], w[0] * d[1] + w[1] * d[0], w[0] * d[2] + w[2] * d[0],
                      w[1] * d[1], w[1] * d[2] + w[2] * d[1], w[2] * d[2]};
    line.moment = {
        cross(o[0], d[0]), cross(o[0], d[1]) + cross(o[1], d[0]), cross(o[0], d[2]) + cross(o[2], d[0]),
        cross(o[1], d[1]), cross(o[1], d[2]) + cross(o[2], d[1]), cross(o[2], d[2])};
    return line;
}

}  // namespace trilens
