// How far two engines agree on one film, pixel by pixel, and whether where they do not lies on an edge.
#pragma once

#include <string>

#include "render/world/world.h"

namespace trilens_test {

/// Pixels on which the projector and Embree on the same facets' rays differ.
struct Agreement {
    std::size_t pixels = 0;        // of the film
    std::size_t optic_pixels = 0;  // that see an optic in the projector's view
    std::size_t seen = 0;          // different triangle or facet seen
    std::size_t coverage = 0;      // one sees something where the other sees nothing
    std::size_t off_edge = 0;      // of both: not within kEdgeDistance of an edge
    std::string first_off_edge;    // where, for the message
    double worst_t = 0;            // largest relative difference of t among equal hits
};

/// "On an edge": the other engine's answer appears in the projector when the film is shifted this much.
inline constexpr double kEdgeDistance = 1e-3;

/// Draws the world's first camera with both engines.
Agreement compare_engines(const trilens::World& world);

}  // namespace trilens_test
