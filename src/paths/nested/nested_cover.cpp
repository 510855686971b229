#include "paths/nested/nested_cover.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

constexpr double kOnBorder = 1e-9;         // of the sum of weights
constexpr double kSquaresPerFacet = 1.5;   // a square's side over the mean facet's
constexpr std::size_t kMostSquares = 512;  // along a side

struct Bounds {
    Vec2 low{0}, high{0};
};

Vec2 pixel_of(const Vec3& screen) {
    return Vec2(screen.x, screen.y) / screen.z;
}

Bounds bounds_of(const RayMesh& mesh, const IdTriple& corners) {
    Bounds bounds{pixel_of(mesh.screen[corners[0]]), pixel_of(mesh.screen[corners[0]])};
    for (const Id corner : corners) {
        bounds.low = glm::min(bounds.low, pixel_of(mesh.screen[corner]));
        bounds.high = glm::max(bounds.high, pixel_of(mesh.screen[corner]));
    }
    return bounds;
}

}  // namespace

NestedCover::NestedCover(const RayMesh& outline, std::vector<char> covers) : outline_(&outline) {
    const std::size_t facets = outline.facets.size();
    weights_.resize(facets);
    std::vector<Bounds> bounds(facets);
    double area = 0;
    std::size_t count = 0;
    for (std::size_t f = 0; f < facets; ++f) {
        for (const Id corner : outline.facets[f]) covers[f] = covers[f] && outline.screen[corner].z > 0;
        if (!covers[f]) continue;
        weights_[f] = facet_weights(outline, f);
        covers[f] = !weights_[f].edge_on;
        if (!covers[f]) continue;
        bounds[f] = bounds_of(outline, outline.facets[f]);
        low_ = count == 0 ? bounds[f].low : glm::min(low_, bounds[f].low);
        high_ = count == 0 ? bounds[f].high : glm::max(high_, bounds[f].high);
        const Vec2 size = bounds[f].high - bounds[f].low;
        area += 0.5 * size.x * size.y;
        ++count;
    }
    if (count == 0) return;
    facet_size_ = std::sqrt(area / static_cast<double>(count));
    const Vec2 size = high_ - low_;
    square_ = std::max({kSquaresPerFacet * facet_size_, size.x / kMostSquares, size.y / kMostSquares, 1e-9});
    across_ = static_cast<std::size_t>(size.x / square_) + 1;
    down_ = static_cast<std::size_t>(size.y / square_) + 1;

    // Counted, then put: a facet stands in every square that its bounds touch.
    first_.assign(across_ * down_ + 1, 0);
    const auto each_square = [&](const auto& act) {
        for (std::size_t f = 0; f < facets; ++f) {
            if (!covers[f]) continue;
            const Vec2 from = (bounds[f].low - low_) / square_, to = (bounds[f].high - low_) / square_;
            for (std::size_t j = static_cast<std::size_t>(from.y); j <= static_cast<std::size_t>(to.y); ++j)
                for (std::size_t i = static_cast<std::size_t>(from.x); i <= static_cast<std::size_t>(to.x);
                     ++i)
                    act(std::min(j, down_ - 1) * across_ + std::min(i, across_ - 1), static_cast<Id>(f));
        }
    };
    each_square([&](std::size_t square, Id) { ++first_[square + 1]; });
    for (std::size_t s = 0; s < across_ * down_; ++s) first_[s + 1] += first_[s];
    facet_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    each_square([&](std::size_t square, Id f) { facet_[next[square]++] = f; });
}

bool NestedCover::may_cover(const Vec2& low, const Vec2& high) const {
    if (facet_.empty() || !(low.x <= high_.x && low.y <= high_.y && high.x >= low_.x && high.y >= low_.y))
        return false;
    const auto square = [&](double at, std::size_t count) {
        return std::min(static_cast<std::size_t>(std::max(at, 0.0) / square_), count - 1);
    };
    const std::size_t left = square(low.x - low_.x, across_), right = square(high.x - low_.x, across_);
    const std::size_t top = square(low.y - low_.y, down_), bottom = square(high.y - low_.y, down_);
    for (std::size_t j = top; j <= bottom; ++j)
        if (first_[j * across_ + left] < first_[j * across_ + right + 1]) return true;
    return false;
}

double NestedCover::area() const {
    return (high_.x - low_.x) * (high_.y - low_.y);
}

std::optional<CoveringFacet> NestedCover::at(const Vec2& pixel) const {
    if (facet_.empty() ||
        !(pixel.x >= low_.x && pixel.y >= low_.y && pixel.x <= high_.x && pixel.y <= high_.y))
        return std::nullopt;
    const Vec2 at = (pixel - low_) / square_;
    const std::size_t square = std::min(static_cast<std::size_t>(at.y), down_ - 1) * across_ +
                               std::min(static_cast<std::size_t>(at.x), across_ - 1);
    std::optional<CoveringFacet> best;
    for (std::size_t i = first_[square]; i < first_[square + 1]; ++i) {
        const Id f = facet_[i];
        const Vec3 e = weights_[f].unnormalised(pixel.x, pixel.y);
        const double sum = e.x + e.y + e.z;
        if (!(sum > 0) || std::min({e.x, e.y, e.z}) < -kOnBorder * sum) continue;
        CoveringFacet here{f, e / sum, 0};
        for (int k = 0; k < 3; ++k)
            here.depth +=
                here.weights[k] * outline_->screen[outline_->facets[f][static_cast<std::size_t>(k)]].z;
        if (!best || here.depth < best->depth) best = here;
    }
    return best;
}

}  // namespace trilens
