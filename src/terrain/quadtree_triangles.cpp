#include "terrain/quadtree_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace trilens {
namespace {

struct Sample {
    int x = 0, y = 0;
};
using SampleTriangle = std::array<Sample, 3>;

/// A quadtree's square by its middle.
struct Cell {
    int x = 0, y = 0, half = 0;
};

/// Walks the squares in order and hands on the triangles of each, fronts upwards.
class QuadtreeWalk {
  public:
    using Emit = std::function<void(const SampleTriangle&)>;

    QuadtreeWalk(const HeightSquare& heights, const KeptSample& is_kept, const Emit& emit)
        : heights_(heights), is_kept_(is_kept), emit_(emit) {}

    void all() const {
        const int last = heights_.side() - 1;
        if (heights_.levels() == 0)
            whole({0, 0}, {last, last}, true);
        else
            cell({last / 2, last / 2, last / 2});
    }

  private:
    bool is_outside(const Cell& c) const {
        return c.x - c.half >= heights_.last_column() || c.y - c.half >= heights_.last_row();
    }

    /// Two triangles, along the diagonal that falls to the right or that which rises.
    void whole(const Sample& low, const Sample& high, bool falls) const {
        const Sample right{high.x, low.y}, below{low.x, high.y};
        if (falls) {
            emit_({low, below, high});
            emit_({low, high, right});
        } else {
            emit_({below, right, low});
            emit_({below, high, right});
        }
    }

    /// The quarter of a cell towards (dx, dy), each -1 or 1.
    bool has_own_middle(const Cell& c, int dx, int dy) const {
        if (c.half < 2) return false;
        const int quarter = c.half / 2;
        return is_kept_(c.x + dx * quarter, c.y + dy * quarter);
    }

    void cell(const Cell& c) const {
        if (is_outside(c)) return;
        const int h = c.half;
        if (!is_kept_(c.x, c.y)) {
            whole({c.x - h, c.y - h}, {c.x + h, c.y + h}, diagonal_falls(c.x, c.y, h));
            return;
        }
        // The corners against the clock on the picture, so that fronts are upwards, and a quarter at each.
        static constexpr std::array<std::array<int, 2>, 4> kCorners{{{-1, -1}, {-1, 1}, {1, 1}, {1, -1}}};
        const Sample middle{c.x, c.y};
        for (std::size_t k = 0; k < 4; ++k) {
            const auto& [ax, ay] = kCorners[k];
            const auto& [bx, by] = kCorners[(k + 1) % 4];
            const Sample a{c.x + ax * h, c.y + ay * h}, b{c.x + bx * h, c.y + by * h};
            const Sample side{(a.x + b.x) / 2, (a.y + b.y) / 2};
            if (!is_kept_(side.x, side.y)) {
                emit_({middle, a, b});
                continue;
            }
            if (!has_own_middle(c, ax, ay)) emit_({middle, a, side});
            if (!has_own_middle(c, bx, by)) emit_({middle, side, b});
        }
        for (const auto& [dx, dy] : kCorners)
            if (has_own_middle(c, dx, dy)) cell({c.x + dx * (h / 2), c.y + dy * (h / 2), h / 2});
    }

    const HeightSquare& heights_;
    const KeptSample& is_kept_;
    const Emit& emit_;
};

/// Gathers triangles; those that reach beyond the grid are cut.
class Gatherer {
  public:
    explicit Gatherer(const HeightSquare& heights) : heights_(heights) {
        ids_.assign(static_cast<std::size_t>(heights.last_column() + 1) *
                        static_cast<std::size_t>(heights.last_row() + 1),
                    kNone);
    }

    void add(const SampleTriangle& triangle) {
        bool inside = true;
        for (const Sample& sample : triangle) {
            if (heights_.is_missing(sample.x, sample.y)) return;
            inside = inside && heights_.is_inside(sample.x, sample.y);
        }
        if (!inside) return add_cut(triangle);
        made_.triangles.push_back({id_of(triangle[0]), id_of(triangle[1]), id_of(triangle[2])});
    }

    GridTriangles take() { return std::move(made_); }

  private:
    using Polygon = std::vector<GridPlace>;

    GridPlace place_of(const Sample& sample) const {
        return {static_cast<double>(sample.x), static_cast<double>(sample.y),
                heights_.at(sample.x, sample.y)};
    }
    Id id_of(const Sample& sample) {
        Id& id =
            ids_[static_cast<std::size_t>(sample.y) * static_cast<std::size_t>(heights_.last_column() + 1) +
                 static_cast<std::size_t>(sample.x)];
        if (id == kNone) {
            id = static_cast<Id>(made_.places.size());
            made_.places.push_back(place_of(sample));
        }
        return id;
    }
    Id id_of(const GridPlace& place) {
        const Sample sample{static_cast<int>(place.column), static_cast<int>(place.row)};
        if (sample.x == place.column && sample.y == place.row &&
            heights_.at(sample.x, sample.y) == place.height)
            return id_of(sample);
        const auto [found, is_new] =
            crossings_.try_emplace({place.column, place.row}, static_cast<Id>(made_.places.size()));
        if (is_new) made_.places.push_back(place);
        return found->second;
    }

    /// The part where `coordinate` is at most `most`. A side is cut from its lower end, so that both its
    /// triangles have the same corner there. Sides run along rows, columns and diagonals, so that they cross
    /// the last column and row at samples' places: rounded, to lie exactly there.
    static Polygon cut(const Polygon& polygon, double GridPlace::*coordinate, double most) {
        Polygon kept;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const GridPlace &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
            if (a.*coordinate <= most) kept.push_back(a);
            if ((a.*coordinate <= most) == (b.*coordinate <= most)) continue;
            const GridPlace &low = a.*coordinate < b.*coordinate ? a : b,
                            &high = a.*coordinate < b.*coordinate ? b : a;
            if (low.*coordinate == most) continue;  // that end is kept
            const double t = (most - low.*coordinate) / (high.*coordinate - low.*coordinate);
            kept.push_back({std::round(low.column + t * (high.column - low.column)),
                            std::round(low.row + t * (high.row - low.row)),
                            low.height + t * (high.height - low.height)});
        }
        return kept;
    }

    void add_cut(const SampleTriangle& triangle) {
        Polygon polygon{place_of(triangle[0]), place_of(triangle[1]), place_of(triangle[2])};
        polygon = cut(polygon, &GridPlace::column, heights_.last_column());
        polygon = cut(polygon, &GridPlace::row, heights_.last_row());
        // A corner at which both cuts meet comes twice.
        const auto same = [](const GridPlace& a, const GridPlace& b) {
            return a.column == b.column && a.row == b.row;
        };
        polygon.erase(std::unique(polygon.begin(), polygon.end(), same), polygon.end());
        while (polygon.size() > 1 && same(polygon.front(), polygon.back())) polygon.pop_back();
        if (polygon.size() < 3) return;
        std::vector<Id> ids;
        for (const GridPlace& place : polygon) ids.push_back(id_of(place));
        for (std::size_t i = 2; i < ids.size(); ++i) made_.triangles.push_back({ids[0], ids[i - 1], ids[i]});
    }

    const HeightSquare& heights_;
    std::vector<Id> ids_;  // per sample of the grid
    std::map<std::pair<double, double>, Id> crossings_;
    GridTriangles made_;
};

}  // namespace

std::size_t count_triangles(const HeightSquare& heights, const KeptSample& is_kept) {
    std::size_t count = 0;
    const QuadtreeWalk::Emit emit = [&](const SampleTriangle&) { ++count; };
    QuadtreeWalk(heights, is_kept, emit).all();
    return count;
}

GridTriangles cut_triangles(const HeightSquare& heights, const KeptSample& is_kept) {
    Gatherer gatherer(heights);
    const QuadtreeWalk::Emit emit = [&](const SampleTriangle& triangle) { gatherer.add(triangle); };
    QuadtreeWalk(heights, is_kept, emit).all();
    return gatherer.take();
}

}  // namespace trilens
