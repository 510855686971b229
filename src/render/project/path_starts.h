// Where Newton's method starts from for a path over several optics: exact paths at a few places of the film,
// each followed once, and what lies between them by interpolation.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "base/raymesh/surface.h"
#include "paths/trace/follow.h"
#include "specular/chain/path_chain.h"

namespace trilens {

/// An optic's surface by its number.
using SurfaceOf = std::function<const Surface&(Id optic)>;

/// The path of a place of the film.
struct KnownPath {
    std::vector<PathEvent> events;  // empty: the place has another history
    // All its faces are flat. Of the paths over their planes one alone is light's: the optical length is
    // convex in where a path meets planes.
    bool is_flat = false;

    bool is_known() const { return !events.empty(); }
};

/// The path of the middle of a part of the film, and how far those around it turn.
struct LonePath {
    KnownPath path;
    // By so much the ray at its end turns, and moves, over the part at most; infinite where that is not
    // known.
    double turn = 0, move = 0;

    /// Whether a ray of the part may come to a point that lies at this sine from the middle's ray, so far
    /// away. Generous: what is told by differences need not hold all over the part.
    bool may_reach(double sine, double distance) const;
};

/// `reach`: pixels that the part extends.
LonePath lone_path(const HistoryQuery& query, const Vec2& pixel, double reach, const SurfaceOf& surface_of);

/// Whether two paths meet the same faces, from the same sides.
bool same_faces(std::span<const PathEvent> a, std::span<const PathEvent> b);

/// The paths of one facet of the film, between those a little inside of its corners.
class FacetPaths {
  public:
    /// `corner`: homogeneous screen positions. `proven`: all rays of the facet have the history.
    FacetPaths(const HistoryQuery& query, const std::array<Vec3, 3>& corner, bool proven,
               const SurfaceOf& surface_of);

    /// Whether all of them have the history, over the same faces; nothing else may be asked then.
    bool are_known() const { return path_[0].is_known(); }
    /// The path at a place: faces, sides and, linear between the corners', where it meets them.
    PerEvent<PathEvent> at(const Vec2& pixel) const;
    /// Whether the exact ray of this place goes along these events, which are a path of light: the facet holds
    /// the place, all its rays are proven to have the history, and the events lie near where its paths do.
    bool have(const Vec2& pixel, std::span<const PathEvent> events) const;

  private:
    Vec3 weights(const Vec2& pixel) const;

    std::array<Vec2, 3> pixel_{};
    std::array<KnownPath, 3> path_{};
    bool is_proven_ = false;
};

}  // namespace trilens
