// Where a history jumps from one part of an optic to another, as where the optic's outline lies before
// itself: bisection by exact rays.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "caustics/beams/light_paths.h"

namespace trilens {

class BeamGrid;

/// A place of the light's window, and a path of its ray there.
struct PlacedPath {
    Vec2 place{0};
    LightPath path;
};

/// One history that is at both ends of a line in the window and not whole between them: the last of it as it
/// is at the first end, and as it is at the second. What lies between them is another's, or as good as
/// nothing.
struct HistoryTear {
    std::array<PlacedPath, 2> side;
};

/// The tear between two paths of one history; none: it is whole there, or closes so steadily that it may be,
/// or is not there in a middle. It is told by the last optic's points, which come together as their places do
/// where the history is whole.
std::optional<HistoryTear> find_tear(const BeamGrid& grid, const PlacedPath& one, const PlacedPath& other);

/// Whether the middle between two rays that leave an optic at `one` and `other` is beyond a tear, told by
/// where it does.
bool is_beyond_tear(const Vec3& one, const Vec3& middle, const Vec3& other);

}  // namespace trilens
