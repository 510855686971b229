#include "measure/candidate_cells.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "base/check.h"
#include "measure/image_finder.h"
#include "measure/likely_place.h"

namespace trilens {
namespace {

using Floats = BoxQuad::Floats;

/// Points that are asked for later may lie farther away: a little more is looked through than is asked for.
constexpr double kMore = 1.25, kMorePixels = 1;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Floats all_of(float value) {
    const Floats all = {value, value, value, value};
    return all;
}

/// Bit i: box i of the quad has a point in common with the box.
unsigned meeting(const BoxQuad& quad, const Floats (&low)[3], const Floats (&high)[3]) {
    BoxQuad::Bits meets = {1, 2, 4, 8};
    for (int k = 0; k < 3; ++k) meets &= (quad.low[k] <= high[k]) & (low[k] <= quad.high[k]);
    return BoxQuad::bits_of(meets);
}

BoxQuad empty_quad() {
    BoxQuad quad;
    for (int k = 0; k < 3; ++k) {
        quad.low[k] = all_of(kInfinity);
        quad.high[k] = all_of(-kInfinity);
    }
    return quad;
}

/// Whether one of the cell's corners shows the piece.
bool shows_piece(const FieldIndex& index, const Piece& piece, int column, int row) {
    const SeenField& field = index.field;
    if (index.wholeness(column, row)) return field.shows(field.index(column, row), piece);
    for (int corner = 0; corner < 4; ++corner) {
        const int x = column + corner % 2, y = row + corner / 2;
        if (field.contains(x, y) && field.shows(field.index(x, y), piece)) return true;
    }
    return false;
}

}  // namespace

PointGroup::PointGroup(const ImageFinder& finder, std::span<const SeenPoint> points)
    : finder_(finder), piece_(piece_of(points.front())), left_(points.front().column), right_(left_),
      top_(points.front().row), bottom_(top_) {
    for (int k = 0; k < 3; ++k) {
        float low = kInfinity, high = -kInfinity;
        for (const SeenPoint& point : points) {
            low = std::min(low, static_cast<float>(point.point[k]));
            high = std::max(high, static_cast<float>(point.point[k]));
        }
        low_[k] = all_of(low);
        high_[k] = all_of(high);
    }
    for (const SeenPoint& point : points) {
        TRILENS_CHECK(point.object == piece_.object && point.optic == piece_.optic, "points of one piece");
        left_ = std::min(left_, point.column);
        right_ = std::max(right_, point.column);
        top_ = std::min(top_, point.row);
        bottom_ = std::max(bottom_, point.row);
    }
}

std::shared_ptr<CandidateCells> PointGroup::cells(double radius) {
    for (const auto& known : found_)
        if (known->radius >= radius) return known;
    found_.push_back(std::make_shared<CandidateCells>(collect(kMore * radius + kMorePixels)));
    return found_.back();
}

double PointGroup::distance_to(const Node& node) const {
    const double size = static_cast<double>(std::int64_t{1} << node.level);
    const double x0 = node.column * size - 1, y0 = node.row * size - 1;
    const double dx = std::max({x0 - right_, left_ - (x0 + size), 0.0});
    const double dy = std::max({y0 - bottom_, top_ - (y0 + size), 0.0});
    return dx * dx + dy * dy;
}

/// Those that may show one of the points, the nearest on top.
void PointGroup::push_children(const Node& node, double most, std::vector<Node>& stack) const {
    const FieldIndex::Level& level = finder_.reference().levels[static_cast<std::size_t>(node.level - 1)];
    const std::size_t first = stack.size();
    for (unsigned left = meeting(level.at(node.column, node.row), low_, high_); left; left &= left - 1) {
        const int child = std::countr_zero(left);
        Node at{node.level - 1, 2 * node.column + child % 2, 2 * node.row + child / 2, 0};
        at.distance = distance_to(at);
        if (at.distance > most) continue;
        const auto place = std::find_if(stack.begin() + static_cast<std::ptrdiff_t>(first), stack.end(),
                                        [&](const Node& other) { return other.distance < at.distance; });
        stack.insert(place, at);
    }
}

void PointGroup::add_cell(int column, int row, CandidateCells& found) const {
    const BoxQuad& from = finder_.reference().levels.front().at((column + 1) / 2, (row + 1) / 2);
    const int child = (column + 1) % 2 + 2 * ((row + 1) % 2);
    const int place = static_cast<int>(found.cells.size() % 4);
    if (place == 0) found.bounds.push_back(empty_quad());
    for (int k = 0; k < 3; ++k) {
        found.bounds.back().low[k][place] = from.low[k][child];
        found.bounds.back().high[k][place] = from.high[k][child];
    }
    found.cells.push_back({column, row});
}

bool PointGroup::may_hold(std::size_t number, const Vec3& point, CandidateCells& among) const {
    CandidateCells::Cell& cell = among.cells[number];
    if (!cell.reach) {
        static constexpr CellReach kNothing{
            {kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}, {}};
        const bool is_shown = shows_piece(finder_.reference(), piece_, cell.column, cell.row);
        cell.reach = is_shown ? &finder_.reach_of(cell.column, cell.row) : &kNothing;
        BoxQuad& bounds = among.bounds[number / 4];
        const int place = static_cast<int>(number % 4);
        for (int k = 0; k < 3; ++k) {
            bounds.low[k][place] = std::max(float{bounds.low[k][place]}, cell.reach->low[k]);
            bounds.high[k][place] = std::min(float{bounds.high[k][place]}, cell.reach->high[k]);
        }
    }
    return cell.reach->may_hold(point);
}

/// Depth first, nearest child first.
CandidateCells PointGroup::collect(double radius) const {
    CandidateCells found;
    found.radius = radius;
    std::vector<Node> stack = {{static_cast<int>(finder_.reference().levels.size()), 0, 0, 0}};
    while (!stack.empty()) {
        const Node node = stack.back();
        stack.pop_back();
        if (node.level > 0)
            push_children(node, radius * radius, stack);
        else
            add_cell(node.column - 1, node.row - 1, found);
    }
    return found;
}

}  // namespace trilens
