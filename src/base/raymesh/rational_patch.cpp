#include "base/raymesh/rational_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "base/math/point_tree.h"

namespace trilens {

Vec3 normal_of_tangents(const SurfacePoint& point, double extent) {
    // A cross product below this share of (extent * derivative) is rounding, not a direction: derivatives
    // carry errors of about 1e-16 of the extent, so a normal above it is good to 1e-4.
    constexpr double kRounding = 1e-12;
    if (!(extent > 0)) return Vec3(0);
    const Vec3 du = point.du / extent, dv = point.dv / extent, across = cross(du, dv);
    const bool is_noise = !(length(across) > kRounding * (length(du) + length(dv)));
    return is_noise ? Vec3(0) : normalize_or_zero(across);
}

double extent_of(const RationalPatch& patch) {
    double extent = 0;
    for (const Vec4& point : patch.points) {
        const Vec3 p = Vec3(point) / point.w;
        extent = std::max({extent, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
    }
    return extent;
}

double joint_tolerance(const Box& all) {
    if (all.empty()) return 0;
    const Vec3 size = all.size();
    return kSameControl * std::max({size.x, size.y, size.z});
}

Box bounds_of(const RationalPatch& patch) {
    Box box;
    for (std::size_t k = 0; k < patch.points.size(); ++k) box.include(patch.control(k));
    return box;
}

namespace {

/// By the quotient rule: with A = w P, A_u = w P_u + w_u P and so on.
template <bool kSecondOrder>
SurfacePoint place_on(const RationalPatch& patch, const Vec2& uv) {
    const auto u = bernstein<kMostPatchRow>(patch.degree_u, uv.x),
               v = bernstein<kMostPatchRow>(patch.degree_v, uv.y);
    Vec4 a(0), a_u(0), a_v(0), a_uu(0), a_uv(0), a_vv(0);
    const std::size_t columns = patch.row(), rows = static_cast<std::size_t>(patch.degree_v) + 1;
    for (std::size_t j = 0; j < rows; ++j) {
        const Vec4* const row = &patch.points[j * columns];
        Vec4 along(0), along_u(0), along_uu(0);
        for (std::size_t i = 0; i < columns; ++i) {
            along += u[0][i] * row[i];
            along_u += u[1][i] * row[i];
            if constexpr (kSecondOrder) along_uu += u[2][i] * row[i];
        }
        a += v[0][j] * along;
        a_u += v[0][j] * along_u;
        a_v += v[1][j] * along;
        if constexpr (kSecondOrder) {
            a_uu += v[0][j] * along_uu;
            a_uv += v[1][j] * along_u;
            a_vv += v[2][j] * along;
        }
    }
    SurfacePoint point;
    const Vec3 p = Vec3(a) / a.w;
    point.position = patch.origin + p;
    point.du = (Vec3(a_u) - a_u.w * p) / a.w;
    point.dv = (Vec3(a_v) - a_v.w * p) / a.w;
    if constexpr (kSecondOrder) {
        point.duu = (Vec3(a_uu) - 2 * a_u.w * point.du - a_uu.w * p) / a.w;
        point.duv = (Vec3(a_uv) - a_u.w * point.dv - a_v.w * point.du - a_uv.w * p) / a.w;
        point.dvv = (Vec3(a_vv) - 2 * a_v.w * point.dv - a_vv.w * p) / a.w;
    }
    return point;
}

void set_normal(const RationalPatch& patch, const Vec2& uv, double extent, SurfacePoint& point) {
    point.normal = normal_of_tangents(point, extent);
    for (const double step : kStepsInward) {
        if (point.normal != Vec3(0)) return;
        point.normal = normal_of_tangents(place_on<false>(patch, uv + step * (Vec2(0.5) - uv)), extent);
    }
}

}  // namespace

SurfacePoint evaluate(const RationalPatch& patch, const Vec2& uv, double extent) {
    SurfacePoint point = place_on<true>(patch, uv);
    set_normal(patch, uv, extent, point);
    return point;
}

SurfacePoint evaluate_first_order(const RationalPatch& patch, const Vec2& uv, double extent) {
    SurfacePoint point = place_on<false>(patch, uv);
    set_normal(patch, uv, extent, point);
    return point;
}

// Edges are joined in two steps: sides that agree are found, then their points are made one.

namespace {

/// Of the patch's extent: what rounding leaves between points that were made one.
constexpr double kSamePlace = 1e-13;

/// A side's control points in the direction in which borders run.
struct Side {
    std::size_t patch = 0, number = 0;
    std::vector<std::size_t> points;  // of the patch
    Vec3 first, last;
    bool is_point = false;
};

std::vector<std::size_t> points_of_side(const RationalPatch& patch, std::size_t side) {
    const std::size_t columns = patch.row(), rows = patch.points.size() / columns;
    const std::size_t start = side == 0   ? 0
                              : side == 1 ? columns - 1
                              : side == 2 ? rows * columns - 1
                                          : (rows - 1) * columns;
    std::vector<std::size_t> points;
    for (std::size_t k = 0; k < (side % 2 == 0 ? columns : rows); ++k) {
        const std::size_t step = side % 2 == 0 ? k : k * columns;
        points.push_back(side < 2 ? start + step : start - step);
    }
    return points;
}

bool is_one_point(const RationalPatch& patch, const std::vector<std::size_t>& points, double tolerance) {
    return std::all_of(points.begin(), points.end(), [&](std::size_t k) {
        return length(patch.control(k) - patch.control(points[0])) <= tolerance;
    });
}

/// Representatives of classes that grow together; the smallest member stands for all.
class Classes {
  public:
    explicit Classes(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
    std::size_t of(std::size_t k) {
        while (parent_[k] != k) k = parent_[k] = parent_[parent_[k]];
        return k;
    }
    void join(std::size_t a, std::size_t b) {
        a = of(a), b = of(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

  private:
    std::vector<std::size_t> parent_;
};

class Joining {
  public:
    explicit Joining(std::span<RationalPatch> patches) : patches_(patches), points_(count_points()) {
        for (std::size_t p = 0; p < patches.size(); ++p)
            for (std::size_t side = 0; side < 4; ++side) add_side(p, side);
    }

    std::vector<FaceBorder> borders() {
        std::vector<FaceBorder> borders(patches_.size());
        find_edges(borders);
        for (const Side& side : sides_) {
            const std::size_t corner = points_.of(number(side, 0));
            borders[side.patch].corners[side.number] = static_cast<Id>(corner);
        }
        make_points_one();
        return borders;
    }

  private:
    std::size_t count_points() {
        std::size_t count = 0;
        Box box;
        for (const RationalPatch& patch : patches_) {
            first_.push_back(count);
            count += patch.points.size();
            box.include(bounds_of(patch));
        }
        tolerance_ = joint_tolerance(box);
        return count;
    }

    void add_side(std::size_t p, std::size_t number_of_side) {
        const RationalPatch& patch = patches_[p];
        Side side{p, number_of_side, points_of_side(patch, number_of_side), {}, {}, false};
        side.first = patch.control(side.points.front());
        side.last = patch.control(side.points.back());
        side.is_point = is_one_point(patch, side.points, tolerance_);
        for (std::size_t k = 1; side.is_point && k < side.points.size(); ++k)
            points_.join(number(side, 0), number(side, k));
        sides_.push_back(std::move(side));
    }

    std::size_t number(const Side& side, std::size_t k) const { return first_[side.patch] + side.points[k]; }

    /// Against or along: whether the sides' points and the shape of their weights are the same.
    bool agree(const Side& a, const Side& b, bool against) const {
        const std::size_t count = a.points.size();
        if (b.points.size() != count) return false;
        const RationalPatch &p = patches_[a.patch], &q = patches_[b.patch];
        const auto other = [&](std::size_t k) { return b.points[against ? count - 1 - k : k]; };
        const double factor = q.points[other(0)].w / p.points[a.points[0]].w;
        for (std::size_t k = 0; k < count; ++k) {
            if (!(length(p.control(a.points[k]) - q.control(other(k))) <= tolerance_)) return false;
            const double weight = factor * p.points[a.points[k]].w;
            if (!(std::fabs(q.points[other(k)].w - weight) <= kSameControl * weight)) return false;
        }
        return true;
    }

    void find_edges(std::vector<FaceBorder>& borders) {
        // Only sides whose ends have the same middle are compared; twice the tolerance covers its rounding.
        std::vector<std::size_t> lines;
        std::vector<Vec3> middles;
        for (std::size_t s = 0; s < sides_.size(); ++s)
            if (!sides_[s].is_point) {
                lines.push_back(s);
                middles.push_back(0.5 * (sides_[s].first + sides_[s].last));
            }
        const PointTree tree(middles);
        Classes edges(sides_.size());
        for (std::size_t i = 0; i < lines.size(); ++i)
            tree.any_within(middles[i], 2 * tolerance_, [&](std::size_t j) {
                if (j > i) join_sides(lines[i], lines[j], edges);
                return false;
            });
        for (std::size_t s = 0; s < sides_.size(); ++s) {
            const std::size_t first = edges.of(s);
            if (first == s) continue;
            const bool reversed = agree(sides_[first], sides_[s], true);
            const Id edge = static_cast<Id>(first);
            borders[sides_[s].patch].sides[sides_[s].number] = {edge, FaceSide::Part::kWhole, reversed};
            borders[sides_[first].patch].sides[sides_[first].number] = {edge, FaceSide::Part::kWhole, false};
        }
    }

    void join_sides(std::size_t a, std::size_t b, Classes& edges) {
        for (const bool against : {true, false}) {
            if (!agree(sides_[a], sides_[b], against)) continue;
            edges.join(a, b);
            const std::size_t count = sides_[a].points.size();
            for (std::size_t k = 0; k < count; ++k)
                points_.join(number(sides_[a], k), number(sides_[b], against ? count - 1 - k : k));
            return;
        }
    }

    void make_points_one() {
        std::vector<Vec3> places;
        for (const RationalPatch& patch : patches_)
            for (std::size_t k = 0; k < patch.points.size(); ++k) places.push_back(patch.control(k));
        for (std::size_t p = 0; p < patches_.size(); ++p)
            for (std::size_t k = 0; k < patches_[p].points.size(); ++k) {
                const std::size_t first = points_.of(first_[p] + k);
                if (first == first_[p] + k) continue;
                const double w = patches_[p].points[k].w;
                patches_[p].points[k] = Vec4(w * (places[first] - patches_[p].origin), w);
            }
    }

    std::span<RationalPatch> patches_;
    double tolerance_ = 0;
    std::vector<std::size_t> first_;  // per patch: of its points among all
    Classes points_;
    std::vector<Side> sides_;
};

}  // namespace

bool is_collapsed(const RationalPatch& patch, std::size_t side) {
    return is_one_point(patch, points_of_side(patch, side), kSamePlace * extent_of(patch));
}

std::vector<FaceBorder> join_patches(std::span<RationalPatch> patches) {
    return Joining(patches).borders();
}

}  // namespace trilens
