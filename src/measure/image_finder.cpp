#include "measure/image_finder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "measure/sliver.h"
#include "measure/slope.h"

namespace trilens {
namespace {

/// How far the surface of a cell may leave the box of its corners, in steps between pixels: bulge, overshoot
/// and residual of a whole cell; of a cell that is partly extrapolated also the longer steps there.
constexpr double kWholeMargin = 0.35, kPartMargin = 4;

/// A hit outside its cell is the cell next door's business, a hit on another triangle is less exact: both
/// count as farther away, so that the better answer wins where two say nearly the same. Never less than the
/// distance.
constexpr double kOvershootPenalty = 2, kOtherPrimitivePenalty = 0.25;
constexpr double kMostPenalty = 1;  // more than both together
static_assert(kOvershootPenalty * kOvershoot + kOtherPrimitivePenalty < kMostPenalty);

/// Pixels. Two images of one point this near to each other are the two sides of one fold.
constexpr double kSurelyNearest = 0.25;

/// The distance from a pixel to a rectangle of the screen, both in pixel centres.
double distance_to(const SeenPoint& from, double x0, double y0, double x1, double y1) {
    const double dx = std::max({x0 - from.column, from.column - x1, 0.0});
    const double dy = std::max({y0 - from.row, from.row - y1, 0.0});
    return std::sqrt(dx * dx + dy * dy);
}

template <typename Box>
bool contains(const Box& box, const Vec3& point) {
    return point.x >= double(box.low[0]) && point.x <= double(box.high[0]) && point.y >= double(box.low[1]) &&
           point.y <= double(box.high[1]) && point.z >= double(box.low[2]) && point.z <= double(box.high[2]);
}

template <typename Box>
Box empty_box() {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    return {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
}

template <typename Box>
void add(Box& box, const Box& other) {
    for (std::size_t k = 0; k < 3; ++k) {
        box.low[k] = std::min(box.low[k], other.low[k]);
        box.high[k] = std::max(box.high[k], other.high[k]);
    }
}

/// The longest linked step at a pixel; zero where it stands alone.
double longest_step(const SeenField& field, int column, int row) {
    const std::size_t i = field.index(column, row);
    double longest = 0;
    const auto look = [&](bool linked, std::size_t j) {
        if (linked) longest = std::max(longest, length(field.point(j) - field.point(i)));
    };
    const std::size_t below = static_cast<std::size_t>(field.width);
    look(field.links[i] & SeenField::kRight, i + 1);
    look(field.links[i] & SeenField::kDown, i + below);
    if (column > 0) look(field.links[i - 1] & SeenField::kRight, i - 1);
    if (row > 0) look(field.links[i - below] & SeenField::kDown, i - below);
    return longest;
}

bool is_whole(const SeenField& field, int column, int row) {
    if (!field.contains(column, row) || !field.contains(column + 1, row + 1)) return false;
    constexpr std::uint8_t both = SeenField::kRight | SeenField::kDown;
    const std::size_t i = field.index(column, row), below = field.index(column, row + 1);
    return field.links[i] == both && (field.links[i + 1] & SeenField::kDown) &&
           (field.links[below] & SeenField::kRight);
}

}  // namespace

ImageFinder::ImageFinder(SeenField reference, SeenField test)
    : field_(std::move(reference)), test_(std::move(test)) {
    link_neighbours(field_);
    link_neighbours(test_);
    build_pyramid();
    number_ends();
}

ImageFinder::Box ImageFinder::cell_box(int column, int row) const {
    Box box = empty_box<Box>();
    const double margin_steps = is_whole(field_, column, row) ? kWholeMargin : kPartMargin;
    for (int corner = 0; corner < 4; ++corner) {
        const int x = column + corner % 2, y = row + corner / 2;
        if (!field_.contains(x, y)) continue;
        const std::size_t i = field_.index(x, y);
        if (!field_.sees(i)) continue;
        const Vec3 p = field_.point(i);
        const double margin = margin_steps * longest_step(field_, x, y) +
                              8 * static_cast<double>(std::numeric_limits<float>::epsilon()) * length(p);
        Box at = empty_box<Box>();
        for (std::size_t k = 0; k < 3; ++k) {
            at.low[k] = static_cast<float>(p[static_cast<int>(k)] - margin);
            at.high[k] = static_cast<float>(p[static_cast<int>(k)] + margin);
        }
        add(box, at);
    }
    return box;
}

void ImageFinder::build_pyramid() {
    Level cells{field_.width + 1, field_.height + 1, {}};
    cells.boxes.resize(static_cast<std::size_t>(cells.columns) * static_cast<std::size_t>(cells.rows));
    parallel_for(static_cast<std::size_t>(cells.rows), 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t row = first; row < last; ++row)
            for (int column = 0; column < cells.columns; ++column)
                cells
                    .boxes[row * static_cast<std::size_t>(cells.columns) + static_cast<std::size_t>(column)] =
                    cell_box(column - 1, static_cast<int>(row) - 1);
    });
    levels_.push_back(std::move(cells));

    while (levels_.back().columns > 1 || levels_.back().rows > 1) {
        const Level& fine = levels_.back();
        Level coarse{(fine.columns + 1) / 2, (fine.rows + 1) / 2, {}};
        coarse.boxes.assign(static_cast<std::size_t>(coarse.columns) * static_cast<std::size_t>(coarse.rows),
                            empty_box<Box>());
        for (int row = 0; row < fine.rows; ++row) {
            for (int column = 0; column < fine.columns; ++column) {
                add(coarse
                        .boxes[static_cast<std::size_t>(row / 2) * static_cast<std::size_t>(coarse.columns) +
                               static_cast<std::size_t>(column / 2)],
                    fine.boxes[static_cast<std::size_t>(row) * static_cast<std::size_t>(fine.columns) +
                               static_cast<std::size_t>(column)]);
            }
        }
        levels_.push_back(std::move(coarse));
    }
}

void ImageFinder::number_ends() {
    const Level& cells = levels_.front();
    Id count = 0;
    end_of_cell_.assign(cells.boxes.size(), kNone);
    for (int row = 0; row < cells.rows; ++row)
        for (int column = 0; column < cells.columns; ++column)
            if (!is_whole(field_, column - 1, row - 1))
                end_of_cell_[static_cast<std::size_t>(row) * static_cast<std::size_t>(cells.columns) +
                             static_cast<std::size_t>(column)] = count++;
    end_reach_ = LazyBoxes(count);
}

/// Whether the patches of a cell may show the point, as far as it costs little to say.
bool ImageFinder::may_show(const Vec3& point, int column, int row) const {
    const std::size_t cell =
        static_cast<std::size_t>(row + 1) * static_cast<std::size_t>(levels_.front().columns) +
        static_cast<std::size_t>(column + 1);
    if (!contains(levels_.front().boxes[cell], point)) return false;
    if (end_of_cell_[cell] == kNone) return true;
    const trilens::Box* reach =
        end_reach_.get(end_of_cell_[cell], [&] { return reach_of_cell(field_, test_, column, row); });
    return !reach || contains(*reach, point);
}

/// Tries every piece of the wanted object and optic that has a pixel among the cell's corners. Says whether
/// one was solid enough to be tried.
bool ImageFinder::try_pieces(const SeenPoint& wanted, int column, int row, bool same_primitive,
                             Best& best) const {
    Piece piece{wanted.object, wanted.optic, std::nullopt};
    if (same_primitive) piece.primitive = wanted.primitive;
    std::uint16_t tried = 0;
    bool any = false;
    for (int corner = 0; corner < 4; ++corner) {
        const int x = column + corner % 2, y = row + corner / 2;
        if ((tried >> kCellCorner[static_cast<std::size_t>(corner)]) & 1 || !field_.contains(x, y)) continue;
        if (!field_.shows(field_.index(x, y), piece)) continue;
        const std::optional<Patch> patch = make_patch(field_, test_, {column, row, corner}, piece);
        if (!patch) continue;
        any = true;
        tried |= patch->measured;

        const Vec2 origin(column, row), from(wanted.column, wanted.row);
        const std::optional<PatchHit> hit =
            invert_patch(*patch, wanted.point, glm::clamp(from - origin, Vec2(0), Vec2(1)));
        if (!hit) continue;
        const Vec2 shift = hit->uv + (origin - from);
        const double score = glm::length(shift) + kOvershootPenalty * hit->overshoot +
                             (same_primitive ? 0 : kOtherPrimitivePenalty);
        if (score < best.score) best = {score, shift};
    }
    return any;
}

const ImageFinder::Box& ImageFinder::box_at(int level, int column, int row) const {
    const Level& boxes = levels_[static_cast<std::size_t>(level)];
    return boxes.boxes[static_cast<std::size_t>(row) * static_cast<std::size_t>(boxes.columns) +
                       static_cast<std::size_t>(column)];
}

void ImageFinder::try_cell(const SeenPoint& wanted, int column, int row, Best& best) const {
    if (!may_show(wanted.point, column, row)) return;
    if (!try_pieces(wanted, column, row, true, best)) try_pieces(wanted, column, row, false, best);
}

/// Depth first, nearest child first; a box is entered if it may hold the point nearer than the best hit so
/// far.
void ImageFinder::search(const SeenPoint& wanted, Best& best) const {
    struct Node {
        int level, column, row;
        double distance;
    };
    const auto node_at = [&](int level, int column, int row) {
        const double size = static_cast<double>(1 << level);
        return Node{level, column, row,
                    distance_to(wanted, column * size - 1, row * size - 1, (column + 1) * size - 1,
                                (row + 1) * size - 1)};
    };
    std::array<Node, 4 * 32> stack;  // four children per level, and fewer than 32 levels
    std::size_t size = 0;
    stack[size++] = node_at(static_cast<int>(levels_.size()) - 1, 0, 0);
    while (size > 0) {
        const Node node = stack[--size];
        if (node.distance >= best.score) continue;
        if (node.level == 0) {
            try_cell(wanted, node.column - 1, node.row - 1, best);
            continue;
        }
        const Level& finer = levels_[static_cast<std::size_t>(node.level - 1)];
        const std::size_t first = size;
        for (int child = 0; child < 4; ++child) {
            const int column = 2 * node.column + child % 2, row = 2 * node.row + child / 2;
            if (column >= finer.columns || row >= finer.rows) continue;
            if (!contains(box_at(node.level - 1, column, row), wanted.point)) continue;
            stack[size] = node_at(node.level - 1, column, row);
            if (stack[size].distance < best.score) ++size;
        }
        std::sort(stack.begin() + static_cast<std::ptrdiff_t>(first),
                  stack.begin() + static_cast<std::ptrdiff_t>(size),
                  [](const Node& a, const Node& b) { return a.distance > b.distance; });
    }
}

/// Which way from its pixel the point lies, by the slopes there: the signs of its offset.
std::array<int, 2> ImageFinder::likely_side(const SeenPoint& wanted) const {
    const std::size_t here = field_.index(wanted.column, wanted.row),
                      below = static_cast<std::size_t>(field_.width);
    if (!field_.sees(here)) return {1, 1};
    const Vec3 p = field_.point(here), offset = wanted.point - p;
    Vec3 du(0), dv(0);
    if (field_.links[here] & SeenField::kRight)
        du = field_.point(here + 1) - p;
    else if (wanted.column > 0 && (field_.links[here - 1] & SeenField::kRight))
        du = p - field_.point(here - 1);
    if (field_.links[here] & SeenField::kDown)
        dv = field_.point(here + below) - p;
    else if (wanted.row > 0 && (field_.links[here - below] & SeenField::kDown))
        dv = p - field_.point(here - below);
    const double a = dot(du, du), b = dot(du, dv), d = dot(dv, dv), g0 = dot(du, offset),
                 g1 = dot(dv, offset);
    return {d * g0 - b * g1 < 0 ? -1 : 1, a * g1 - b * g0 < 0 ? -1 : 1};
}

/// Whether the reference's own pixel belongs to a piece of the wanted object that is wide enough for a slope.
bool ImageFinder::has_patch(const SeenPoint& wanted) const {
    const Piece piece{wanted.object, wanted.optic, std::nullopt};
    for (int corner = 0; corner < 4; ++corner) {
        const PatchPlace place{wanted.column - corner % 2, wanted.row - corner / 2, corner};
        if (make_patch(field_, test_, place, piece)) return true;
    }
    return false;
}

/// How far the displaced image of the point may lie, by the slopes of both images at the pixel. On the way to
/// it the seen point moves from what the reference shows at the pixel to the wanted one; near a fold it moves
/// up to twice as far as the slopes say, round a corner between two walls as far again. Infinite where the
/// reference shows something else all round the pixel.
double ImageFinder::farthest(const SeenPoint& wanted) const {
    const Piece piece{wanted.object, wanted.optic, std::nullopt};
    const Slopes test_slopes = slopes_at(test_, wanted.column, wanted.row);
    double least = std::numeric_limits<double>::infinity();
    for (int row = wanted.row - 1; row <= wanted.row + 1; ++row) {
        for (int column = wanted.column - 1; column <= wanted.column + 1; ++column) {
            if (!field_.contains(column, row) || !field_.shows(field_.index(column, row), piece)) continue;
            const Vec3 step = wanted.point - field_.point(field_.index(column, row));
            const std::optional<double> here = pixels_for(slopes_at(field_, column, row), step),
                                        there = pixels_for(test_slopes, step);
            const double away = std::hypot(column - wanted.column, row - wanted.row);
            // A single pixel next door says nothing of where it ends; one at the same place is the same spot.
            if (!here && !there && away > 0) continue;
            least = std::min(least, away + 1 + 4 * std::max(here.value_or(0), there.value_or(0)));
        }
    }
    return least;
}

std::optional<Vec2> ImageFinder::find(const SeenPoint& wanted, double reach) const {
    // The same pixel shows the same point, to the last bit.
    const std::size_t here = field_.index(wanted.column, wanted.row);
    const bool is_shown = field_.shows(here, {wanted.object, wanted.optic, std::nullopt});
    if (is_shown && field_.point(here) == wanted.point) return Vec2(0);

    // Only the four cells round the pixel reach nearer than one pixel: a hit there that is nearer ends the
    // search. The likeliest comes first; within a quarter of a pixel it is not asked whether another image
    // lies nearer still.
    Best best{reach + kMostPenalty, std::nullopt};
    const auto [side_x, side_y] = likely_side(wanted);
    for (const int dy : {side_y, -side_y}) {
        for (const int dx : {side_x, -side_x}) {
            try_cell(wanted, wanted.column + std::min(dx, 0), wanted.row + std::min(dy, 0), best);
            if (best.shift && best.score < kSurelyNearest) return best.shift;
        }
    }
    if (is_shown && !has_patch(wanted)) {
        const std::optional<Vec2> shift = find_along_sliver(field_, wanted);
        if (shift && glm::length(*shift) < best.score) best = {glm::length(*shift), shift};
    }
    if (!best.shift || best.score > 1) {
        best.score = std::min(best.score, farthest(wanted));
        search(wanted, best);
    }
    return best.shift;
}

}  // namespace trilens
