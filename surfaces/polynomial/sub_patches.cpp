// Quarters of quarters until all four of one are made of the same points.
#include "surfaces/polynomial/sub_patches.h"

#include <array>

namespace trilens {
namespace {

/// Inside a part, off all of its halves, as shares of its sides.
constexpr Vec2 kWithin{0.3, 0.25};

/// The quarter of a square of side 2 * half that holds (u, v), which becomes the quarter's own.
std::size_t enter_quarter(double half, Vec2& uv) {
    std::size_t quarter = 0;
    for (int axis = 0; axis < 2; ++axis) {
        if (!(uv[axis] >= half)) continue;
        uv[axis] -= half;
        quarter |= std::size_t{1} << axis;
    }
    return quarter;
}

/// The same of a triangle: the one in the middle, the last, is turned by half a turn, and so are the quarters
/// of what is turned. (u, v) of these run on from the corner of the square around them.
std::size_t enter_triangle(double half, bool& turned, Vec2& uv) {
    const auto is_beyond = [&](double x) { return turned ? x < half : x >= half; };
    for (int axis = 0; axis < 2; ++axis) {
        if (!is_beyond(uv[axis])) continue;
        // Of a turned triangle the corner along one axis is the far one along the other.
        uv[turned ? 1 - axis : axis] -= half;
        return static_cast<std::size_t>(1 + axis);
    }
    if (turned) uv -= Vec2(half);
    if (is_beyond(uv.x + uv.y)) {
        turned = !turned;
        return 3;
    }
    return 0;
}

}  // namespace

/// As in PartShape: of negative size where it is turned.
struct SubPatches::Part {
    Vec2 corner{0};
    double size = 1;
    int depth = 0;

    Vec2 within() const { return corner + size * kWithin; }
    std::array<Part, 4> quarters(FaceDomain domain) const {
        const double half = size / 2;
        const Part last = domain == FaceDomain::kSquare ? Part{corner + half, half, depth + 1}
                                                        : Part{corner + half, -half, depth + 1};
        return {{{corner, half, depth + 1},
                 {corner + Vec2(half, 0), half, depth + 1},
                 {corner + Vec2(0, half), half, depth + 1},
                 last}};
    }
};

SubPatches::SubPatches(FaceDomain domain, int depth, const UsedPoints& used)
    : domain_(domain), depth_(depth), nodes_(1) {
    divide(0, {}, used);
}

void SubPatches::set_points(std::size_t at, const std::vector<int>& points) {
    nodes_[at] = {points_.size(), points.size(), true};
    points_.insert(points_.end(), points.begin(), points.end());
}

void SubPatches::divide(std::size_t at, const Part& part, const UsedPoints& used) {
    const std::array<Part, 4> quarters = part.quarters(domain_);
    std::array<std::vector<int>, 4> of_quarter;
    bool is_one = true;
    for (std::size_t k = 0; k < 4; ++k) {
        of_quarter[k] = used(quarters[k].within());
        is_one = is_one && of_quarter[k] == of_quarter[0];
    }
    if (is_one) return set_points(at, of_quarter[0]);
    if (part.depth >= depth_) return;  // no points: not a sub-patch
    const std::size_t first = nodes_.size();
    nodes_[at] = {first, 0, false};
    nodes_.resize(first + 4);
    for (std::size_t k = 0; k < 4; ++k) divide(first + k, quarters[k], used);
}

std::span<const int> SubPatches::points_at(const Vec2& uv) const {
    const Node* node = &nodes_[0];
    Vec2 left = uv;
    bool turned = false;
    for (double half = 0.5; !node->is_leaf; half /= 2) {
        const std::size_t quarter =
            domain_ == FaceDomain::kSquare ? enter_quarter(half, left) : enter_triangle(half, turned, left);
        node = &nodes_[node->first + quarter];
    }
    return std::span(points_).subspan(node->first, node->count);
}

}  // namespace trilens
