// A place of a surface that receives light.
#pragma once

#include <array>
#include <atomic>
#include <span>

#include "base/math/vec.h"
#include "base/util/ids.h"

namespace trilens {

struct Receiver {
    Vec3 point{0};           // world
    Vec3 normal{0};          // of the plane there; unit, on the side that receives
    Vec3 shading_normal{0};  // unit; whose cosine counts
    Vec3 lifted{0};          // where shadow rays end: off the surface, on its side
    // Sides of the parallelogram around the point over which light is averaged; zero: the point alone.
    std::array<Vec3, 2> sides{};
    // Of that parallelogram only this convex part, in its sides from the point (the whole is from -1/2 to 1/2
    // along each), counterclockwise, of at most 7 corners; empty: all of it. What is pointed to must live
    // longer.
    std::span<const Vec2> outline{};
    bool keeps_sides = false;  // however long they are; else they end at a share of the scene
    Vec3 seen_along{0};        // the direction in which it is looked at, of any length; zero: not told
    double slack = 0;          // what lies nearer than this on the way to the light hides nothing
    Id triangle = kNone;  // it lies on, of those that the light knows; kNone: on none of them
    bool exact = false;   // as traced pictures want it, however long it takes
    const std::atomic<bool>* cancel = nullptr;  // set: who asked wants it no more, Interrupted is thrown
};

}  // namespace trilens
