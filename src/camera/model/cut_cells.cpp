#include "camera/model/cut_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace trilens {
namespace {

constexpr double kApart = 8;                                 // pixels between places that are asked
constexpr int kMostPlaces = 32;                              // along a side
constexpr double kStraight = 1e-3, kStraightOfFilm = 1e-7;   // pixels, or of the film: what is straight
constexpr double kLeastSide = 1. / 16, kLeastOfFilm = 1e-6;  // likewise: of cells that are divided
constexpr int kMostLevels = 24;
constexpr int kEdgeHalvings = 50;  // of an edge that the border crosses
constexpr double kNoArea = 1e-9;   // pixels^2

int places_along(double side) {
    return static_cast<int>(std::clamp(std::ceil(side / kApart), 2.0, double(kMostPlaces)));
}

class CellCutter {
  public:
    CellCutter(const FilmBlock& block, RayMesh& mesh)
        : block_(block),
          mesh_(mesh),
          straight_(std::max(kStraight, kStraightOfFilm * block.size)),
          least_side_(std::max(kLeastSide, kLeastOfFilm * block.size)) {}

    void cut(const FilmCell& cell, int level = 0) {
        const CellRays rays = rays_in(block_, cell);
        if (rays == CellRays::kNowhere) return;
        const std::array<Vec2, 4> corner{cell.low, Vec2(cell.high.x, cell.low.y), cell.high,
                                         Vec2(cell.low.x, cell.high.y)};
        if (rays == CellRays::kEverywhere) return add({corner.begin(), corner.end()});
        const Vec2 side = cell.high - cell.low;
        const bool is_least = level == kMostLevels || std::max(side.x, side.y) <= least_side_;
        const Outline outline = outline_of(corner);
        if (is_least || is_straight(outline)) return add(outline.places);
        divide(cell, side, level + 1);
    }

  private:
    /// Where the cell's edges have rays, all around, and where the border crosses them.
    struct Outline {
        std::vector<Vec2> places, crossings;
        Vec2 inside{0};  // a corner that has a ray, where there is one
    };

    bool has(const Vec2& at) const { return block_.ray(at).has_value(); }

    void divide(const FilmCell& cell, const Vec2& side, int level) {
        const Vec2 middle = 0.5 * (cell.low + cell.high);
        const bool across = side.x > 0.5 * side.y, down = side.y > 0.5 * side.x;
        for (int j = 0; j <= int(down); ++j)
            for (int i = 0; i <= int(across); ++i) {
                FilmCell part = cell;
                if (across) (i == 0 ? part.high : part.low).x = middle.x;
                if (down) (j == 0 ? part.high : part.low).y = middle.y;
                cut(part, level);
            }
    }

    /// The last place from `with`, which has a ray, toward `without` that has one.
    Vec2 border_between(Vec2 with, Vec2 without) const {
        for (int i = 0; i < kEdgeHalvings; ++i) {
            const Vec2 middle = 0.5 * (with + without);
            (has(middle) ? with : without) = middle;
        }
        return with;
    }

    Outline outline_of(const std::array<Vec2, 4>& corner) const {
        Outline outline;
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec2 &here = corner[k], &next = corner[(k + 1) % 4];
            const bool starts = has(here), ends = has(next);
            if (starts) outline.places.push_back(outline.inside = here);
            if (starts == ends) continue;
            outline.crossings.push_back(starts ? border_between(here, next) : border_between(next, here));
            outline.places.push_back(outline.crossings.back());
        }
        return outline;
    }

    /// Whether the border goes straight from one crossing to the other.
    bool is_straight(const Outline& outline) const {
        if (outline.crossings.size() != 2) return false;
        const Vec2 &from = outline.crossings[0], &to = outline.crossings[1];
        const Vec2 middle = 0.5 * (from + to), way = to - from;
        if (!(length(way) > straight_)) return true;
        Vec2 inward = Vec2(-way.y, way.x) * (straight_ / length(way));
        if (dot(inward, outline.inside - middle) < 0) inward = -inward;
        return has(middle + inward) && !has(middle - inward);
    }

    /// A convex polygon whose corners have rays.
    void add(const std::vector<Vec2>& places) {
        if (places.size() < 3) return;
        const auto first = static_cast<Id>(mesh_.rays.size());
        for (const Vec2& place : places) {
            mesh_.screen.emplace_back(place, 1);
            mesh_.rays.push_back(block_.ray(place).value());
        }
        for (Id k = 1; k + 1 < places.size(); ++k)
            if (std::fabs(cross(places[k] - places[0], places[k + 1] - places[0])) > kNoArea)
                mesh_.facets.push_back({first, first + k, first + k + 1});
    }

    const FilmBlock& block_;
    RayMesh& mesh_;
    double straight_ = 0, least_side_ = 0;
};

}  // namespace

CellRays rays_in(const FilmBlock& block, const FilmCell& cell) {
    const Vec2 side = cell.high - cell.low;
    const int columns = places_along(side.x), rows = places_along(side.y);
    bool any = false, all = true;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const Vec2 at(i == columns ? cell.high.x : cell.low.x + side.x * i / columns,
                          j == rows ? cell.high.y : cell.low.y + side.y * j / rows);
            const bool has = block.ray(at).has_value();
            any = any || has, all = all && has;
            if (any && !all) return CellRays::kPartly;
        }
    return all ? CellRays::kEverywhere : CellRays::kNowhere;
}

void add_cut_cell(const FilmBlock& block, const FilmCell& cell, RayMesh& mesh) {
    CellCutter(block, mesh).cut(cell);
}

}  // namespace trilens
