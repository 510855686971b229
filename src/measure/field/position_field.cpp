#include "measure/field/position_field.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <utility>

#include "base/util/parallel.h"
#include "measure/common/comparable.h"

namespace trilens {

namespace {

/// Steps along one line of pixels, row or column.
struct Line {
    const PositionField& field;
    std::size_t first, stride;
    int count;

    std::size_t at(int i) const { return first + static_cast<std::size_t>(i) * stride; }

    /// The length of the step from pixel i to i + 1, or -1 where there is none within one object and optic.
    double step(int i) const {
        if (i < 0 || i + 1 >= count) return -1;
        const std::size_t a = at(i), b = at(i + 1);
        if (!field.sees(a) || !field.sees(b)) return -1;
        if ((*field.object)[a] != (*field.object)[b] || field.optic_of(a) != field.optic_of(b)) return -1;
        return length(field.point(b) - field.point(a));
    }
};

void link_line(const Line& line, std::uint8_t bit, std::vector<std::uint8_t>& links) {
    double before = -1, here = line.step(0);
    for (int i = 0; i + 1 < line.count; ++i) {
        const double after = line.step(i + 1);
        const double neighbour = std::max(before, after);
        const bool jump = neighbour > 0 && here > kJump * neighbour;
        if (here >= 0 && !jump) links[line.at(i)] |= bit;
        before = here;
        here = after;
    }
}

}  // namespace

FieldSample PositionField::seen_point(std::size_t i) const {
    const std::size_t columns = static_cast<std::size_t>(width);
    return {point(i),
            (*object)[i],
            optic_of(i),
            primitive_of(i),
            static_cast<int>(i % columns),
            static_cast<int>(i / columns)};
}

std::optional<PositionField> make_seen_field(const Image& image, const std::string& layer) {
    const auto channel = [&](const char* name) { return seen_channel(image, layer, name); };
    for (const char* name : {"object", "X", "Y", "Z"})
        if (!image.find(channel(name))) return std::nullopt;
    PositionField field;
    field.width = image.data_width;
    field.height = image.data_height;
    field.object = &id_channel(image, channel("object"));
    field.x = &float_channel(image, channel("X"));
    field.y = &float_channel(image, channel("Y"));
    field.z = &float_channel(image, channel("Z"));
    if (image.find("optic.object")) field.optic = &id_channel(image, "optic.object");
    if (image.find(channel("primitive"))) field.primitive = &id_channel(image, channel("primitive"));
    return field;
}

FieldWindow shown_window(const PositionField& field) {
    const std::size_t rows = static_cast<std::size_t>(field.height);
    // Of each row the first that shows the layer, and the one behind the last.
    std::vector<std::pair<int, int>> shown(rows);
    parallel_for(rows, 16, [&](std::size_t from, std::size_t to) {
        for (std::size_t row = from; row < to; ++row) {
            const std::size_t start = row * static_cast<std::size_t>(field.width);
            const auto shows = [&](int x) { return field.shows_layer(start + static_cast<std::size_t>(x)); };
            int first = 0, last = field.width;
            while (first < last && !shows(first)) ++first;
            while (last > first && !shows(last - 1)) --last;
            shown[row] = {first, last};
        }
    });
    FieldWindow window{field.width, 0, 0, 0};
    for (int row = 0; row < field.height; ++row) {
        const auto [first, last] = shown[static_cast<std::size_t>(row)];
        if (first == last) continue;
        if (window.x1 == 0) window.y0 = row;
        window = {std::min(window.x0, first), window.y0, std::max(window.x1, last), row + 1};
    }
    return window.x1 > 0 ? window : FieldWindow{};
}

void link_neighbours(PositionField& field) {
    link_neighbours(field, {0, 0, field.width, field.height});
}

void link_neighbours(PositionField& field, const FieldWindow& window) {
    const std::size_t columns = static_cast<std::size_t>(field.width),
                      rows = static_cast<std::size_t>(field.height);
    std::vector<std::uint8_t> links(columns * rows, 0);
    const int width = window.x1 - window.x0, height = window.y1 - window.y0;
    parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t first, std::size_t last) {
        for (int row = static_cast<int>(first); row < static_cast<int>(last); ++row)
            link_line({field, field.index(window.x0, window.y0 + row), 1, width}, PositionField::kRight,
                      links);
    });
    parallel_for(static_cast<std::size_t>(width), 64, [&](std::size_t first, std::size_t last) {
        for (int column = static_cast<int>(first); column < static_cast<int>(last); ++column)
            link_line({field, field.index(window.x0 + column, window.y0), columns, height},
                      PositionField::kDown, links);
    });
    field.links = std::move(links);
}

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
