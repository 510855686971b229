// Where histories end along the sides of a light's triangles: bisection by exact rays.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "base/util/parallel.h"
#include "caustics/beams/beam_grid.h"

namespace trilens {

/// The last place at which a history is, on the way between two corners of which one has it.
struct HistoryBorder {
    Id inside = kNone, outside = kNone;
    const LightPath* like = nullptr;
    Vec2 place{0};
    LightPath path;
    bool hides = false;  // beside it lies a history that neither corner has
};

/// The histories at the corners of a divided window, by numbers, and where they end between two of them.
class GridHistories {
  public:
    /// `all`: the histories that have numbers already; those that have none are added. Both must live longer.
    GridHistories(const BeamGrid& grid, std::vector<LightHistory>& all);

    /// Finds the borders along the sides of all triangles, but those that are known, of the grid as it is
    /// now. Throws Interrupted soon after `progress` says so.
    void find_borders(const Progress& progress);
    /// The triangles on one of whose sides a history lies hidden between two others, brighter than a share of
    /// the brightest path.
    std::vector<Id> triangles_that_hide() const;
    /// Whether a triangle's corners have different histories of such as could hide.
    bool is_mixed(const BeamGrid::Triangle& triangle) const;
    /// Whether at a place in a triangle, weights of its corners, is such a history that no corner has, or one
    /// corner, and well beyond its borders.
    bool hides_at(const BeamGrid::Triangle& triangle, const Vec3& weights) const;

    /// Of a corner; null: it has not that history.
    const LightPath* path_at(Id corner, Id history) const;
    /// Whether the history is at both ends of a triangle's side and torn between them.
    bool is_torn(Id a, Id b, Id history) const {
        return border_.contains({a, b, history}) && border_.contains({b, a, history});
    }
    /// The border on a triangle's side, of which one end has the history, or between whose ends it is torn.
    const HistoryBorder& border(Id inside, Id outside, Id history) const {
        return borders_[border_.at({inside, outside, history})];
    }
    /// The border along a side that may have been divided, of which one end has the history; null: what is
    /// known of its parts leaves open where that ends.
    const HistoryBorder* border_between(Id inside, Id outside, Id history) const;

  private:
    using Key = std::tuple<Id, Id, Id>;  // inside, outside, history

    using HistoryKey = std::tuple<std::vector<std::uint64_t>, std::vector<VeilSurface>, int, Id, bool>;

    static HistoryKey key_of(const LightHistory& history);
    void number_paths();
    std::vector<Id> histories_of(const BeamGrid::Triangle& triangle) const;
    void add_tears();

    const BeamGrid& grid_;
    std::vector<LightHistory>& all_;
    std::map<HistoryKey, Id> number_;
    std::vector<std::vector<Id>> at_corner_;  // per corner and path: its history
    std::map<Key, std::size_t> border_;
    std::vector<HistoryBorder> borders_;
};

}  // namespace trilens
