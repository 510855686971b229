#include "measure/field/folds.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr double kTurned = 0.5;  // the least cosine between normals that agree, up to sign
constexpr double kCoplanar =
    0.25;                     // the largest sine between the way from cell to cell and the plane of either
constexpr int kFarthest = 4;  // cells across a fold; those on it have an orientation by chance

/// What a cell of four pixels covers. Its normal's length is twice its size, its normal's sign the
/// orientation.
struct Cell {
    Vec3 middle{0}, normal{0};
};

/// Nothing where the cell's pixels are not one linked piece of an object.
std::optional<Cell> cell_at(const PositionField& field, int column, int row) {
    if (!field.contains(column, row) || !field.contains(column + 1, row + 1)) return std::nullopt;
    const std::size_t corner = field.index(column, row), below = field.index(column, row + 1);
    const SurfaceId piece{(*field.object)[corner], field.optic_of(corner), std::nullopt};
    for (const std::size_t i : {corner, corner + 1, below, below + 1})
        if (!field.shows(i, piece)) return std::nullopt;
    constexpr std::uint8_t right = PositionField::kRight, down = PositionField::kDown;
    if ((field.links[corner] & right) == 0 || (field.links[corner] & down) == 0 ||
        (field.links[corner + 1] & down) == 0 || (field.links[below] & right) == 0)
        return std::nullopt;
    const Vec3 a = field.point(corner), b = field.point(corner + 1), c = field.point(below),
               d = field.point(below + 1);
    return Cell{0.25 * (a + b + c + d), glm::cross(d - a, c - b)};
}

/// The cosine between two normals; 0 where one has no length.
double cosine(const Cell& a, const Cell& b) {
    const double scale = glm::length(a.normal) * glm::length(b.normal);
    return scale > 0 ? glm::dot(a.normal, b.normal) / scale : 0;
}

/// One surface turned over: opposite orientations, and side by side, not face to face as two walls of a room
/// are.
bool are_opposed(const Cell& a, const Cell& b) {
    if (cosine(a, b) > -kTurned) return false;
    const Vec3 way = b.middle - a.middle;
    const double off_plane = std::max(std::abs(glm::dot(way, a.normal)) / glm::length(a.normal),
                                      std::abs(glm::dot(way, b.normal)) / glm::length(b.normal));
    return off_plane <= kCoplanar * glm::length(way);
}

/// How many pixels after the cell, on its row (or column), the piece turns over: between cells each of which
/// agrees with the one beyond it, for where pixels are too coarse for what they see, orientations change from
/// cell to cell.
std::optional<int> fold_after(const PositionField& field, int column, int row, bool on_row) {
    const int right = on_row ? 1 : 0, down = on_row ? 0 : 1;
    const auto cell = [&](int step) { return cell_at(field, column + step * right, row + step * down); };
    const auto agree = [&](const std::optional<Cell>& a, const std::optional<Cell>& b) {
        return a && b && cosine(*a, *b) > kTurned;
    };
    const std::optional<Cell> here = cell(0);
    if (!agree(here, cell(-1))) return std::nullopt;
    for (int step = 1; step <= kFarthest; ++step) {
        const std::optional<Cell> there = cell(step);
        if (there && are_opposed(*here, *there) && agree(there, cell(step + 1))) return (step + 1) / 2;
    }
    return std::nullopt;
}

}  // namespace

std::vector<std::uint8_t> near_folds(const PositionField& field) {
    std::vector<std::uint8_t> near(
        static_cast<std::size_t>(field.width) * static_cast<std::size_t>(field.height), 0);
    const auto mark = [&](int column, int row) {
        for (int y = std::max(0, row - kFoldReach); y <= std::min(field.height - 1, row + kFoldReach); ++y)
            for (int x = std::max(0, column - kFoldReach);
                 x <= std::min(field.width - 1, column + kFoldReach); ++x)
                near[field.index(x, y)] = 1;
    };
    std::mutex mutex;
    parallel_for(static_cast<std::size_t>(field.height), 16, [&](std::size_t first, std::size_t last) {
        std::vector<std::pair<int, int>> folds;
        for (int row = static_cast<int>(first); row < static_cast<int>(last); ++row) {
            for (int column = 0; column < field.width; ++column) {
                if (const std::optional<int> after = fold_after(field, column, row, true))
                    folds.emplace_back(column + *after, row);
                if (const std::optional<int> after = fold_after(field, column, row, false))
                    folds.emplace_back(column, row + *after);
            }
        }
        const std::lock_guard guard(mutex);
        for (const auto& [column, row] : folds) mark(column, row);
    });
    return near;
}

}  // namespace trilens
