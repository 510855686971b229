// A surface's grid in parts that are made when they are asked for, and boxes that hold them, told without
// making them.
#include "surfaces/grid_parts.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "base/util/check.h"
#include "base/util/parallel.h"
#include "surfaces/polynomial/face_hulls.h"
#include "surfaces/surfaces.h"

namespace trilens {
namespace {

/// The lattice points of a part, evaluated: those of its rectangle that lie in the face.
class PartPoints {
  public:
    PartPoints(const Surface& surface, int n, const GridPart& part)
        : is_square_(surface.domain(part.face) == FaceDomain::kSquare),
          n_(n),
          part_(part),
          columns_(std::min(part.steps, n - part.column)),
          rows_(std::min(part.steps, n - part.row)),
          number_(static_cast<std::size_t>((columns_ + 1) * (rows_ + 1)), kNone) {
        for (int j = 0; j <= rows_; ++j)
            for (int i = 0; i <= columns_; ++i) {
                if (!holds(i, j)) continue;
                const Vec2 uv(static_cast<double>(part.column + i) / n,
                              static_cast<double>(part.row + j) / n);
                const SurfacePoint point = surface.eval_first_order(part.face, uv);
                const Id number = static_cast<Id>(grid_.points.size());
                number_[place(i, j)] = number;
                grid_.corner_point.push_back(number);
                grid_.points.push_back(point.position);
                grid_.corner_normal.push_back(point.normal);
                uv_.push_back(uv);
            }
        for (int j = 0; j < rows_; ++j)
            for (int i = 0; i < columns_; ++i) add_square(i, j);
    }

    SurfaceGrid take() { return std::move(grid_); }

  private:
    std::size_t place(int i, int j) const { return static_cast<std::size_t>(j * (columns_ + 1) + i); }
    bool holds(int i, int j) const { return is_square_ || part_.column + i + part_.row + j <= n_; }

    void add_square(int i, int j) {
        if (!is_square_) {
            if (!holds(i + 1, j)) return;
            add_facet({number_[place(i, j)], number_[place(i + 1, j)], number_[place(i, j + 1)]});
            if (holds(i + 1, j + 1))
                add_facet({number_[place(i + 1, j)], number_[place(i + 1, j + 1)], number_[place(i, j + 1)]});
            return;
        }
        const Id a = number_[place(i, j)], b = number_[place(i + 1, j)], c = number_[place(i + 1, j + 1)],
                 d = number_[place(i, j + 1)];
        const std::vector<Vec3>& at = grid_.points;
        if (second_diagonal_is_shorter({at[a], at[b], at[c], at[d]})) {
            add_facet({b, c, d});
            add_facet({b, d, a});
        } else {
            add_facet({a, b, c});
            add_facet({a, c, d});
        }
    }
    void add_facet(const IdTriple& facet) {
        grid_.facets.push_back(facet);
        grid_.facet_face.push_back(part_.face);
        grid_.facet_uv.push_back({uv_[facet[0]], uv_[facet[1]], uv_[facet[2]]});
    }

    bool is_square_;
    int n_;
    GridPart part_;
    int columns_, rows_;
    std::vector<Id> number_;  // per place of the rectangle
    std::vector<Vec2> uv_;
    SurfaceGrid grid_;
};

}  // namespace

std::vector<GridPart> grid_parts(const Surface& surface, int n, int steps) {
    TRILENS_CHECK(n >= 1 && n <= kMostSteps && steps >= 1, "a grid has 1 to 1024 steps");
    std::vector<GridPart> parts;
    for (Id face = 0; face < surface.face_count(); ++face) {
        const bool is_square = surface.domain(face) == FaceDomain::kSquare;
        for (int row = 0; row < n; row += steps)
            for (int column = 0; column < n && (is_square || column + row < n); column += steps)
                parts.push_back({face, column, row, steps});
    }
    return parts;
}

SurfaceGrid make_part_grid(const Surface& surface, int n, const GridPart& part) {
    TRILENS_CHECK(n >= 1 && n <= kMostSteps && part.column < n && part.row < n, "a part lies in its grid");
    return PartPoints(surface, n, part).take();
}

std::vector<Box> part_boxes(const Surface& surface, int n, const std::vector<GridPart>& parts) {
    const std::unique_ptr<const SurfaceBounder> bounder = surface.make_bounder();
    if (!bounder) return {};
    std::vector<Box> boxes(parts.size());
    parallel_for(parts.size(), 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t p = first; p < last; ++p) {
            const Vec2 low = Vec2(parts[p].column, parts[p].row) / double(n);
            boxes[p] = bounder->box(parts[p].face, low, glm::min(low + double(parts[p].steps) / n, Vec2(1)));
        }
    });
    return boxes;
}

std::vector<Box> face_hulls(const Surface& surface) {
    std::vector<Box> hulls;
    const auto* known = dynamic_cast<const HasHulls*>(&surface);
    for (Id face = 0; known && face < surface.face_count(); ++face) {
        const std::optional<Box> hull = known->hull(face);
        if (!hull) return {};
        hulls.push_back(*hull);
    }
    return hulls;
}

}  // namespace trilens
