// The window of a light divided into triangles by newest-vertex bisection until the paths at their corners
// stand for those between them.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_map>
#include <vector>

#include "base/util/error.h"
#include "caustics/beams/history_tears.h"
#include "caustics/beams/light_paths.h"

namespace trilens {

/// How finely.
struct BeamGridParams {
    int first_cells = 24;     // squares along each side of the window to begin with
    int most_levels = 11;     // bisections of one of its triangles
    int mixed_levels = 4;     // of one whose corners have different histories
    int lit_levels = 8;       // of one in which the light that comes turns, as where a cone ends
    double tolerance = 1e-3;  // how far light may fall from its place, as a share of the scene's size
    std::size_t most_triangles = 16'000;  // and a quarter more where histories hide

    /// For another tolerance: with levels and triangles as a smaller one needs them.
    static BeamGridParams within(double tolerance);
    /// For receivers that ask for exact rays: borders of histories lie, there too, where the first beams have
    /// them, so that they are for a sixteenth of the tolerance.
    static BeamGridParams truth(double tolerance);
};

/// Triangles over one window; the bases of two triangles that share one are equal, so no corner lies on
/// another's side (Mitchell, A Comparison of Adaptive Refinement Techniques for Elliptic Problems, 1989).
class BeamGrid {
  public:
    struct Triangle {
        std::array<Id, 3> corner{};  // the base runs from corner 0 to 1
        int level = 0;
    };

    /// Of the tree of bisections: a triangle, or two nodes that follow each other.
    struct Node {
        std::array<Id, 3> corner{};  // as Triangle has them
        Id triangle = kNone;         // kNone: it was bisected
        Id first_child = kNone;
    };

    BeamGrid(const LightSpace& space, const BeamSource& source, const LightWindow& window, Id first);

    /// Throws Interrupted soon after `progress` says so.
    void divide(const BeamGridParams& params, const Progress& progress);

    /// Divides some of its triangles once, and what comes of them as far as it needs; false: none may be.
    bool divide_more(std::span<const Id> triangles, const Progress& progress);

    const LightWindow& window() const { return window_; }
    const std::vector<Triangle>& triangles() const { return triangles_; }
    const std::vector<Node>& nodes() const { return nodes_; }
    /// Of nodes that nothing was bisected to: the first ones.
    Id root_count() const { return root_count_; }
    /// The corner in the middle between two others; kNone: none was looked at.
    Id middle_between(Id a, Id b) const {
        const auto at = middles_.find(edge_of(a, b));
        return at == middles_.end() ? kNone : at->second;
    }
    /// How far light may fall from its place, world units.
    double tolerance() const { return tolerance_; }
    double scene_size() const { return space_.size; }
    const Vec2& place(Id corner) const { return places_[corner]; }
    const std::vector<LightPath>& paths(Id corner) const { return paths_[corner].paths; }
    const CutPaths& cut(Id corner) const { return paths_[corner].cut; }
    std::size_t corner_count() const { return places_.size(); }
    /// A history on a triangle's side: its corners, the smaller number first, and which path it is of that.
    using SideHistory = std::tuple<Id, Id, Id>;
    /// What was found out of sides at both of whose corners a history is: its tear, or that it is whole. Of
    /// triangles that a tear goes through all such sides are known.
    const std::map<SideHistory, std::optional<HistoryTear>>& tears() const { return tears_; }
    /// Path of all: the sum of its colours.
    double brightest() const { return brightest_; }
    /// The light that comes to the first optic over the square of the scene's size: the sum of its colours.
    double mean_arriving() const;
    /// Triangles that were left too coarse, for want of levels or room.
    std::size_t coarse_count() const { return coarse_; }

    /// The paths at any place of the window; `only`: as FollowParams has it.
    LightPaths paths_at(const Vec2& place, std::span<const std::vector<Step>* const> only = {}) const;

  private:
    using Edge = std::uint64_t;
    static Edge edge_of(Id a, Id b) { return (static_cast<Edge>(std::min(a, b)) << 32) | std::max(a, b); }
    void start(int cells);
    void trace_new_corners(const Progress& progress);
    Id middle_of(Id a, Id b);
    bool is_mixed(const Triangle& triangle, double least) const;
    bool is_unevenly_lit(const Triangle& triangle) const;
    std::vector<SideHistory> sides_with(const LightPath& like, Id triangle) const;
    std::vector<SideHistory> uneven_histories(const Triangle& triangle) const;
    std::vector<char> are_too_coarse(std::span<const Id> triangles, const Progress& progress);
    void find_tears(std::vector<SideHistory> sides, const Progress& progress);
    void follow_tears(const Progress& progress);
    std::vector<Id> torn_oddly() const;
    bool has_room(Id triangle) const {
        return triangles_[triangle].level < params_.most_levels && triangles_.size() < most_triangles_;
    }
    std::vector<Id> split_marked(std::span<const Id> triangles, std::span<const char> marked);
    std::vector<Id> split_where_room(std::span<const Id> triangles);
    void divide_from(std::vector<Id> asked, const Progress& progress);
    void divide_all(std::vector<Id> asked, const Progress& progress);
    struct Corners;
    bool is_uneven(const Corners& corners, double tolerance) const;
    void link(Id triangle);
    void unlink(Id triangle);
    void split(Id triangle);
    void bisect(Id triangle, Id middle);

    LightSpace space_;
    BeamSource source_;
    LightWindow window_;
    Id first_ = kNone;
    BeamGridParams params_;
    std::vector<Vec2> places_;
    std::vector<LightPaths> paths_;  // of the first traced_ corners
    std::size_t traced_ = 0;
    std::vector<Triangle> triangles_;
    std::vector<Node> nodes_;
    std::vector<Id> node_of_;  // triangle
    Id root_count_ = 0;
    double tolerance_ = 0;
    std::size_t most_triangles_ = 0;
    std::unordered_map<Edge, std::array<Id, 2>> sides_;  // triangles on both sides
    std::unordered_map<Edge, Id> middles_;
    std::map<SideHistory, std::optional<HistoryTear>> tears_;
    double faint_ = 0;      // irradiance, the sum of its colours, that may fall beside its place
    double brightest_ = 0;  // path so far: the sum of its colours
    double most_arriving_ = 0;  // of all paths so far
    std::size_t coarse_ = 0;
};

inline double strength_of(const Vec3& light) {
    return light.x + light.y + light.z;
}

/// The path of that history; null: there is none.
inline const LightPath* find_history(const std::vector<LightPath>& paths, const LightPath& like) {
    for (const LightPath& path : paths)
        if (path.history() == like.history()) return &path;
    return nullptr;
}

}  // namespace trilens
