// All images of a point over a chain of reflections and refractions: branch and bound over the surfaces'
// cells.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "camera/specular_cells.h"
#include "camera/specular_point.h"
#include "camera/specular_tree.h"

namespace trilens {

/// One event of a chain, in the order from the eye.
struct ChainEvent {
    std::size_t tree = 0;      // of ChainSearch: whose surface
    bool reflects = true;      // else refracts
    bool either_side = false;  // a mirror: met from the front or from behind
    bool front = true;         // else: met from outside of the body, or from inside
    double before = 1,
           after = 1;     // refractive indices of what light runs in before and behind it, from the eye
    bool convex = false;  // of a convex body: where one chord of it ends its next does not begin
};

/// A surface with its cells; both must live longer. Cells are halved as far as anybody came: one thread each.
struct ChainSurface {
    const Surface* surface = nullptr;
    std::unique_ptr<SpecularTree> tree;
};

/// Where a path of the asked kind would run, if nothing were in its way.
struct ChainPath {
    Vec2 pixel{0};                // from the film's top left; may lie outside the film
    std::vector<Vec3> positions;  // on the surfaces, one per event
};

/// What a search found.
struct ChainPaths {
    std::vector<ChainPath> paths;
    bool complete = false;  // proven: there are no others
    std::size_t boxes = 0;  // looked at
};

/// So many events a chain has at most.
inline constexpr std::size_t kMostEvents = 5;

/// The paths of light from `point` over the events to the camera's eye, all of them if `complete`: zeros of
/// the laws of all events at once (dL/du = 0, L the optical path over points u of the surfaces; Fermat). A
/// box has a cell of each surface. One is excluded where some event's law cannot hold in it for any direction
/// between the cells, or where Krawczyk's operator leaves it (Neumaier, Interval Methods for Systems of
/// Equations, chapter 5), settled by Newton's method where that shows that it has one zero at most, and else
/// halved in one of its cells. Not complete where more than `most_boxes` are looked at, or where boxes of the
/// smallest size are undecided: near caustics, and where two events next to each other on one surface that is
/// not convex come together. Surfaces have bounds and own normals. Rounding: as SpecularSearcher has it.
ChainPaths find_chain_paths(std::span<ChainSurface> surfaces, const LinearCamera& camera,
                            std::span<const ChainEvent> events, const Vec3& point, std::size_t most_boxes);

}  // namespace trilens
