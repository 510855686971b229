#include "vector/facet_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>

#include "base/math/box.h"
#include "trilinear/facet/facet.h"

namespace trilens {
namespace {

constexpr double kReach = 1.5;  // samples, from what is seen to the farthest triangle looked at
constexpr double kSlack = 0.05;
constexpr double kSideRounding = 1e-12;  // of the side of a triangle that a ray sees, as a cosine

/// A triangle that a sample sees, or one that is so near to it that samples may have missed it.
struct NearTriangle {
    Id triangle = kNone;
    Id sample = kNone;  // that sees it, or sees what the way to it began with
    double away = 0;    // samples in the picture
    double cosine = 1;  // of the rays' angle to the normal: what is farther on lies no less aslant
};

/// Finds the edges of one facet.
class EdgeSearch {
  public:
    EdgeSearch(const VectorView& view, Id facet, std::span<const Id> samples)
        : view_(view), lattice_{view.grid}, samples_(samples), rays_(trilinear_facet(view.mesh, facet)) {
        for (int k = 0; k < 3; ++k) {
            const auto corner = static_cast<std::size_t>(k);
            screen_[k] = view.mesh.screen[view.mesh.facets[facet][corner]];
        }
        weights_of_screen_ = inverse(screen_);
    }

    std::vector<Id> find() {
        look_around();
        for (std::size_t i = 0; i < near_.size(); ++i) {
            const NearTriangle from = near_[i];
            for (const Id vertex : view_.edges.vertex_of[from.triangle])
                for (const Id e : view_.edges.at(vertex)) found_.push_back(e);
            for (std::size_t e = 0; e < 3; ++e) walk_over(from, e);
        }
        std::sort(found_.begin(), found_.end());
        found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
        std::erase_if(found_, [&](Id e) { return !may_show(view_.edges.edge[e]); });
        return std::move(found_);
    }

  private:
    Vec2 position(Id sample) const {
        return {view_.grid.x0 + (lattice_.column(sample) + 0.5) / view_.grid.side,
                view_.grid.y0 + (lattice_.row(sample) + 0.5) / view_.grid.side};
    }
    Vec3 weights_at(const Vec2& at) const {
        const Vec3 weights = weights_of_screen_ * Vec3(at, 1);
        return weights / (weights.x + weights.y + weights.z);
    }
    void look_around();
    double cosine(Id triangle, const Vec3& direction) const {
        const Vec3& normal = view_.edges.normal[triangle];
        return std::fabs(dot(normal, direction)) / std::max(length(normal), 1e-300);
    }
    void walk_over(const NearTriangle& from, std::size_t edge);
    bool turns_away(Id triangle, std::size_t edge, Id next, const Vec3& direction) const;
    bool may_show(const DrawnEdge& edge) const;
    std::array<Vec2, 3> image_near(Id triangle, const Vec3& weights) const;

    const VectorView& view_;
    SampleLattice lattice_;
    std::span<const Id> samples_;
    TrilinearFacet rays_;
    Mat3 screen_{0}, weights_of_screen_{0};
    Vec2 low_{HUGE_VAL}, high_{-HUGE_VAL};  // around the samples, in pixels
    std::vector<NearTriangle> near_;
    std::unordered_set<Id> reached_;
    std::vector<Id> found_;
};

/// What is seen at the samples and beside them.
void EdgeSearch::look_around() {
    Id last = kNone;
    for (const Id s : samples_) {
        const int column = lattice_.column(s), row = lattice_.row(s);
        low_ = min(low_, position(s)), high_ = max(high_, position(s));
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                if (!lattice_.holds(column + dx, row + dy)) continue;
                const Id there = lattice_.sample(column + dx, row + dy), seen = view_.triangle[there];
                if (seen != kNone && seen != last && reached_.insert(seen).second)
                    near_.push_back({seen, there, 0,
                                     kSlack + cosine(seen, rays_.direction(weights_at(position(there))))});
                last = seen;
            }
    }
    const double margin = kReach / view_.grid.side;
    low_ -= margin, high_ += margin;
}

/// Along a facet's rays direction is linear in the weights, so that the sides of a triangle that all of them
/// see are among those that its corner rays see.
bool EdgeSearch::may_show(const DrawnEdge& edge) const {
    if (edge.always || edge.other == kNone) return true;
    const Vec3 here = view_.edges.normal[edge.triangle],
               there = view_.edges.normal[edge.other] * (edge.same_winding ? 1.0 : -1.0);
    bool front = true, back = true;
    for (const Ray& ray : rays_.corner)
        for (const Vec3& normal : {here, there}) {
            const double side = dot(normal, ray.direction),
                         rounding = kSideRounding * length(normal) * length(ray.direction);
            front &= side > rounding, back &= side < -rounding;
        }
    return !front && !back;
}

/// The corners' images, in pixels, as the ray of these weights and those around it would have them.
std::array<Vec2, 3> EdgeSearch::image_near(Id triangle, const Vec3& weights) const {
    const IdTriple& c = view_.scene.triangles[triangle];
    const Vec3 origin = rays_.origin(weights), direction = rays_.direction(weights);
    std::array<Vec2, 3> image;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& point = view_.scene.points[c[k]];
        const double t = dot(point - origin, direction) / dot(direction, direction);
        const Vec3 a = rays_.corner_at(0, t), u = rays_.corner_at(1, t) - a, v = rays_.corner_at(2, t) - a,
                   n = cross(u, v), p = point - a;
        const double y = dot(cross(p, v), n) / dot(n, n), z = dot(cross(u, p), n) / dot(n, n);
        const Vec3 homogeneous = screen_ * Vec3(1 - y - z, y, z);
        image[k] = {homogeneous.x / homogeneous.z, homogeneous.y / homogeneous.z};
    }
    return image;
}

/// Whether a ray of this direction sees the edge from triangle to neighbour as a silhouette.
bool EdgeSearch::turns_away(Id triangle, std::size_t edge, Id next, const Vec3& direction) const {
    const std::array<Id, 3>&here = view_.edges.vertex_of[triangle], &there = view_.edges.vertex_of[next];
    const auto from =
        static_cast<std::size_t>(std::find(there.begin(), there.end(), here[edge]) - there.begin());
    const bool same_winding = there[(from + 1) % 3] != here[(edge + 1) % 3];
    return is_silhouette(view_.edges, {triangle, edge, next, false, same_winding}, direction);
}

/// From a triangle over an edge, unless that is a silhouette there, to one that lies more aslant, which the
/// samples may have missed: the way grows by the width of each triangle in the picture.
void EdgeSearch::walk_over(const NearTriangle& from, std::size_t edge) {
    const Id next = view_.edges.neighbour[from.triangle][edge];
    if (next == kNone || reached_.count(next)) return;
    const Vec3 weights = weights_at(position(from.sample)), direction = rays_.direction(weights);
    if (turns_away(from.triangle, edge, next, direction) || cosine(next, direction) > from.cosine) return;

    const auto [a, b, c] = image_near(next, weights);
    const Vec2 low = min(a, min(b, c)), high = max(a, max(b, c));
    if (!(low.x <= high_.x && low.y <= high_.y && high.x >= low_.x && high.y >= low_.y)) return;
    const double longest = std::max({length(b - a), length(c - b), length(a - c)});
    const double twice_area = std::fabs(cross(b - a, c - a));
    const double away = from.away + (longest > 0 ? twice_area / longest * view_.grid.side : 0);
    if (!(away <= kReach)) return;
    reached_.insert(next);
    near_.push_back({next, from.sample, away, from.cosine});
}

}  // namespace

std::vector<Id> edges_at_samples(const VectorView& view, Id facet, std::span<const Id> samples) {
    if (!view.wire) return EdgeSearch(view, facet, samples).find();
    std::vector<Id> all(view.edges.edge.size());
    for (Id e = 0; e < all.size(); ++e) all[e] = e;
    return all;
}

}  // namespace trilens
