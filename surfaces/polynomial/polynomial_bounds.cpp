// Bounds over boxes from the parts that a face is made of.
#include "surfaces/polynomial/polynomial_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/util/parallel.h"
#include "surfaces/polynomial/face_parts.h"
#include "surfaces/polynomial/polynomial_parts.h"

namespace trilens {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Radii of the quantities, then of the normal.
constexpr std::size_t kNormal = kQuantities;
using Radii = std::array<double, kQuantities + 1>;

struct ParameterBox {
    Vec2 low, high;
};

/// Whether the box and the shape share more than a border; a box without extent along a parameter may lie on
/// it.
bool overlap(const PartShape& shape, FaceDomain domain, const ParameterBox& box) {
    for (int axis = 0; axis < 2; ++axis) {
        const double low = std::max(box.low[axis], shape.low()[axis]);
        const double high = std::min(box.high[axis], shape.high()[axis]);
        if (box.low[axis] < box.high[axis] ? !(low < high) : !(low <= high)) return false;
    }
    if (domain == FaceDomain::kSquare) return true;
    const Vec2 near = shape.size > 0 ? glm::max(box.low, shape.low()) : glm::min(box.high, shape.high());
    const double beyond = (near.x + near.y - shape.corner.x - shape.corner.y) / shape.size;
    return box.low == box.high ? beyond <= 1 : beyond < 1;
}

class PolynomialBounder final : public SurfaceBounder {
  public:
    explicit PolynomialBounder(const Surface& surface) : surface_(surface), faces_(surface.face_count()) {
        const FaceTaker taker(surface);
        parallel_for(faces_.size(), 1, [&](std::size_t first, std::size_t last) {
            for (std::size_t f = first; f < last; ++f) faces_[f] = taker.take(static_cast<Id>(f));
        });
    }

    SurfaceBounds bounds(Id face, const Vec2& low, const Vec2& high) const override {
        std::vector<const FacePart*> parts;
        collect(face, 0, {low, high}, parts);
        const Vec2 middle = 0.5 * (low + high);
        const bool beyond = surface_.domain(face) == FaceDomain::kTriangle && middle.x + middle.y > 1;

        SurfaceBounds result;
        if (parts.empty()) return result;  // rounding put the box outside of a triangle
        if (beyond) {
            result.middle = continued(*parts.front(), middle);
        } else {
            result.middle = surface_.eval(face, middle);
        }
        Radii radius{};
        for (const FacePart* part : parts) widen(*part, {low, high}, result.middle, radius);
        // Continued beyond the face, several parts are not one smooth surface.
        if (beyond && parts.size() > 1) std::fill_n(radius.begin() + 3, 3, kInfinite);

        result.position_radius = radius[0];
        result.du_radius = radius[1];
        result.dv_radius = radius[2];
        result.duu_radius = radius[3];
        result.duv_radius = radius[4];
        result.dvv_radius = radius[5];
        result.normal_radius = std::min(radius[kNormal], 2.0);
        result.is_finest = parts.size() == 1 && !parts.front()->is_polynomial;
        return result;
    }

    Box box(Id face, const Vec2& low, const Vec2& high) const override {
        std::vector<const FacePart*> parts;
        collect(face, 0, {low, high}, parts);
        if (parts.empty()) return SurfaceBounder::box(face, low, high);
        Box result;
        for (const FacePart* part : parts) {
            const Vec3 room(part->slack[0]);
            if (!part->is_polynomial) {
                result.include(part->middle.position - room);
                result.include(part->middle.position + room);
                continue;
            }
            const auto [a, b] = inside_part(*part, {low, high});
            const BezierNet net = restricted(part->net, a, b);
            for (const Vec3& point : net.points()) {
                result.include(part->origin + point - room);
                result.include(part->origin + point + room);
            }
        }
        return result;
    }

  private:
    void collect(Id face, std::size_t index, const ParameterBox& box,
                 std::vector<const FacePart*>& parts) const {
        const PartBranch& branch = faces_[face].branches[index];
        if (!overlap(branch.shape, surface_.domain(face), box)) return;
        if (branch.is_part) {
            parts.push_back(&faces_[face].parts[branch.first]);
        } else {
            for (std::size_t k = 0; k < 4; ++k) collect(face, branch.first + k, box, parts);
        }
    }

    static SurfacePoint continued(const FacePart& part, const Vec2& uv) {
        if (!part.is_polynomial) return part.middle;
        const std::array<BezierNet, kQuantities> nets = part_nets(part.net);
        const Vec2 t = (uv - part.shape.corner) / part.shape.size;
        const double scale = 1 / part.shape.size;
        SurfacePoint point;
        for (std::size_t q = 0; q < kQuantities; ++q)
            point.*kQuantity[q] = value(nets[q], t) * (q == 0 ? 1 : q < 3 ? scale : scale * scale);
        point.position += part.origin;
        point.normal = normalize_or_zero(cross(point.du, point.dv));
        return point;
    }

    /// Widens the radii about `middle` by one part's values within the box.
    static void widen(const FacePart& part, const ParameterBox& box, const SurfacePoint& middle,
                      Radii& radius) {
        if (part.is_polynomial) {
            widen_by_hulls(part, box, middle, radius);
            return;
        }
        for (std::size_t q = 0; q < kQuantities; ++q) {
            const double off = length(part.middle.*kQuantity[q] - middle.*kQuantity[q]);
            radius[q] = std::max(radius[q], off + part.slack[q]);
        }
        const double turn = length(part.middle.normal - middle.normal) + part.normal_spread;
        radius[kNormal] = std::max(radius[kNormal], turn);
    }

    /// The box's share of a part, in the part's own parameters.
    static std::pair<Vec2, Vec2> inside_part(const FacePart& part, const ParameterBox& box) {
        const Vec2 low = glm::max(box.low, part.shape.low()), high = glm::min(box.high, part.shape.high());
        return {(low - part.shape.corner) / part.shape.size, (high - part.shape.corner) / part.shape.size};
    }

    static void widen_by_hulls(const FacePart& part, const ParameterBox& box, const SurfacePoint& middle,
                               Radii& radius) {
        const auto [a, b] = inside_part(part, box);
        const double scale = 1 / part.shape.size;
        std::array<BezierNet, kQuantities> nets = part_nets(part.net);
        for (std::size_t q = 0; q < kQuantities; ++q) {
            const double unit = q == 0 ? 1 : q < 3 ? scale : scale * scale;
            const Vec3 about = middle.*kQuantity[q] - (q == 0 ? part.origin : Vec3(0));
            nets[q] = restricted(nets[q], a, b);
            for (std::size_t k = 0; k < nets[q].points().size(); ++k) {
                nets[q].point[k] *= unit;
                radius[q] = std::max(radius[q], length(nets[q].point[k] - about) + part.slack[q]);
            }
        }
        const TangentHulls hulls{nets[1].points(), nets[2].points(), part.slack[1], part.slack[2]};
        radius[kNormal] = std::max(radius[kNormal], normal_radius(hulls, middle.normal));
    }

    const Surface& surface_;
    std::vector<TakenFace> faces_;
};

}  // namespace

std::unique_ptr<const SurfaceBounder> make_polynomial_bounder(const Surface& surface) {
    return std::make_unique<PolynomialBounder>(surface);
}

namespace {

class BounderShare final : public SurfaceBounder {
  public:
    explicit BounderShare(std::shared_ptr<const SurfaceBounder> of) : of_(std::move(of)) {}

    SurfaceBounds bounds(Id face, const Vec2& low, const Vec2& high) const override {
        return of_->bounds(face, low, high);
    }
    Box box(Id face, const Vec2& low, const Vec2& high) const override { return of_->box(face, low, high); }

  private:
    std::shared_ptr<const SurfaceBounder> of_;
};

}  // namespace

std::unique_ptr<const SurfaceBounder> SharedPolynomialBounder::get(const Surface& surface) const {
    const std::lock_guard lock(making_);
    std::shared_ptr<const SurfaceBounder> bounder = made_.lock();
    // Isolated: else this thread might meanwhile take up work that waits for the lock.
    if (!bounder) run_isolated([&] { bounder = make_polynomial_bounder(surface); });
    made_ = bounder;
    return std::make_unique<BounderShare>(std::move(bounder));
}

// The cross product's part along a normal from below, its part across from above.

namespace {

/// A hull as a ball, with its reach along the normal.
struct Reach {
    Vec3 middle{0};
    double radius = 0, longest = 0, along = 0;
};

Reach reach_of(std::span<const Vec3> hull, double slack, const Vec3& normal) {
    Reach reach;
    for (const Vec3& p : hull) reach.middle += p / static_cast<double>(hull.size());
    for (const Vec3& p : hull) {
        reach.radius = std::max(reach.radius, length(p - reach.middle) + slack);
        reach.longest = std::max(reach.longest, length(p) + slack);
        reach.along = std::max(reach.along, std::fabs(dot(p, normal)) + slack);
    }
    return reach;
}

}  // namespace

double normal_radius(const TangentHulls& hulls, const Vec3& normal) {
    const Reach u = reach_of(hulls.du, hulls.du_slack, normal);
    const Reach v = reach_of(hulls.dv, hulls.dv_slack, normal);

    // (a + alpha n) x (b + beta n), a and b across n, is a x b along n and beta a x n + alpha n x b across
    // it.
    const double moved = length(u.middle) * v.radius + length(v.middle) * u.radius + u.radius * v.radius;
    const double upright = dot(cross(u.middle, v.middle), normal) - moved;
    const double tangent = (v.along * u.longest + u.along * v.longest) / upright;
    if (!(upright > 0) || !std::isfinite(tangent)) return 2;

    // The chord 2 sin(angle / 2).
    const double cosine = 1 / std::sqrt(1 + tangent * tangent);
    return tangent * cosine * std::sqrt(2 / (1 + cosine)) + 1e-14;
}

}  // namespace trilens
