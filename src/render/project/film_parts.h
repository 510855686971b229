// Adaptive subdivision of parts of the film: until the rays at a part's corners have the same histories and
// turn little from one to the other.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"
#include "paths/trace/follow.h"

namespace trilens {

/// One of the histories of a place's ray.
struct HistoryThere {
    Id last = kNone;  // of FollowedPlace::segments
    Colours colours = kAllColours;
    std::vector<Step> steps;

    bool is_like(const HistoryThere& other) const { return colours == other.colours && steps == other.steps; }
};

/// A place of the film, and all that its ray does.
struct FollowedPlace {
    Vec3 screen{0};  // homogeneous
    std::vector<PathSegment> segments;
    std::vector<HistoryThere> histories;  // of those that are asked for, each once

    /// The last segment of this history here; null where the ray has another.
    const PathSegment* segment_of(const HistoryThere& history) const;
};

/// A triangle of the film.
struct FilmPart {
    std::array<Id, 3> corner{};  // of FilmParts::places
    bool is_open = false;        // its rays ask for more than the bound of the work allows
};

/// What became of one triangle of the film.
struct FilmParts {
    Id facet = kNone;  // of the grid, that it lies on
    std::vector<FollowedPlace> places;
    std::vector<FilmPart> parts;
};

struct FilmPartsQuestion {
    Vec2 film{0};  // its size; what lies off it is not divided
    /// All that the ray of a place does that meets this facet there; nothing where it meets another place of
    /// the surface first. Called on several threads.
    std::function<std::vector<PathSegment>(Id facet, const Vec2& pixel)> follow;
    /// Whether a history counts. Called on several threads.
    std::function<bool(std::span<const Step> steps)> asks;
    std::size_t least_steps = 2;  // shorter histories do not count
    /// Longer histories are told, but nothing is divided for them.
    std::size_t most_steps = 3;
};

/// Divides triangles of the film, given by their facet and their corners' homogeneous screen positions, as
/// far as their rays need it and a bound of the work allows; the same whatever the number of threads.
struct FilmTriangle {
    Id facet = kNone;
    std::array<Vec3, 3> screen{};
};
std::vector<FilmParts> divide_film(const FilmPartsQuestion& question,
                                   std::span<const FilmTriangle> triangles);

/// Pixels: the longest side of a triangle; infinite where a corner lies behind the eye.
double longest_side(const std::array<Vec3, 3>& screen);

}  // namespace trilens
