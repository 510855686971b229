// Rational Bezier patches as a surface, joined where their edges agree, and their bounds. Every quantity's
// net is raised to the patch's own degrees, so that quotients go point by point.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/util/error.h"
#include "surfaces/polynomial/face_hulls.h"
#include "surfaces/polynomial/polynomial_bounds.h"
#include "surfaces/surfaces.h"

namespace trilens {
namespace {

using PatchWeights = BezierWeights<kMostPatchRow>;
using PatchRows = std::array<PatchWeights, kMostPatchRow>;

/// Rounding of one evaluation of a quantity, as a share of the control points' extent.
constexpr double kPatchRounding = 4e-15;
/// What rounding of a collapsed side leaves of a normal at it.
constexpr double kPoleTurn = 1e-9;

/// Bezier points of a polynomial with values (A, w).
struct Net {
    std::size_t wide = 0, high = 0;  // points along u and v
    std::array<Vec4, kMostPatchRow * kMostPatchRow> point;

    std::size_t size() const { return wide * high; }
    Vec4& at(std::size_t i, std::size_t j) { return point[j * wide + i]; }
    const Vec4& at(std::size_t i, std::size_t j) const { return point[j * wide + i]; }
};

Net net_of(const RationalPatch& patch) {
    Net net;
    net.wide = patch.row();
    net.high = patch.points.size() / net.wide;
    std::copy(patch.points.begin(), patch.points.end(), net.point.begin());
    return net;
}

/// The derivative by u (axis 0) or v (axis 1), written with as many points.
Net derivative(const Net& net, int axis) {
    Net result;
    result.wide = net.wide, result.high = net.high;
    const std::size_t count = axis == 0 ? net.wide : net.high;
    const double degree = static_cast<double>(count - 1);
    for (std::size_t j = 0; j < net.high; ++j)
        for (std::size_t i = 0; i < net.wide; ++i) {
            const std::size_t k = axis == 0 ? i : j;
            const auto at = [&](std::size_t other) -> const Vec4& {
                return axis == 0 ? net.at(other, j) : net.at(i, other);
            };
            // The differences have one degree less; raised to this one by means of neighbours.
            Vec4 sum(0);
            if (k > 0) sum += static_cast<double>(k) * (at(k) - at(k - 1));
            if (k + 1 < count) sum += (degree - static_cast<double>(k)) * (at(k + 1) - at(k));
            result.at(i, j) = sum;
        }
    return result;
}

/// The same polynomial over a box as over a unit square.
struct Restriction {
    PatchRows u, v;

    Restriction(const Net& net, const Vec2& low, const Vec2& high) {
        for (std::size_t i = 0; i < net.wide; ++i)
            u[i] = blossom<kMostPatchRow>(static_cast<int>(net.wide) - 1, static_cast<int>(i), low.x, high.x);
        for (std::size_t j = 0; j < net.high; ++j)
            v[j] = blossom<kMostPatchRow>(static_cast<int>(net.high) - 1, static_cast<int>(j), low.y, high.y);
    }
    Net operator()(const Net& net) const {
        Net half, result;
        half.wide = result.wide = net.wide, half.high = result.high = net.high;
        for (std::size_t j = 0; j < net.high; ++j)
            for (std::size_t i = 0; i < net.wide; ++i) {
                Vec4 sum(0);
                for (std::size_t k = 0; k < net.wide; ++k) sum += u[i][k] * net.at(k, j);
                half.at(i, j) = sum;
            }
        for (std::size_t j = 0; j < net.high; ++j)
            for (std::size_t i = 0; i < net.wide; ++i) {
                Vec4 sum(0);
                for (std::size_t k = 0; k < net.high; ++k) sum += v[j][k] * half.at(i, k);
                result.at(i, j) = sum;
            }
        return result;
    }
};

/// Quotients by the weights' net, point by point: the hull of (A - about a) / w and the range of a / w, where
/// a is the net's own last coordinate.
struct Quotients {
    std::array<Vec3, kMostPatchRow * kMostPatchRow> hull;
    std::size_t count = 0;
    double low = HUGE_VAL, high = -HUGE_VAL;

    Quotients(const Net& net, const Net& weights, const Vec3& about) : count(net.size()) {
        for (std::size_t k = 0; k < count; ++k) {
            const double w = weights.point[k].w, own = net.point[k].w / w;
            hull[k] = Vec3(net.point[k]) / w - own * about;
            low = std::min(low, own);
            high = std::max(high, own);
        }
    }
    std::span<const Vec3> points() const { return {hull.data(), count}; }
    double middle() const { return 0.5 * (low + high); }
    double radius() const { return 0.5 * (high - low); }
    double largest() const { return std::max(std::fabs(low), std::fabs(high)); }
    double farthest(const Vec3& from) const {
        double far = 0;
        for (const Vec3& point : points()) far = std::max(far, length(point - from));
        return far;
    }
    Vec3 mean() const {
        Vec3 sum(0);
        for (const Vec3& point : points()) sum += point / static_cast<double>(count);
        return sum;
    }
};

/// How far a vector within a ball, times one of the quotients, lies from the product of their middles.
double product_radius(const Vec3& middle, double radius, const Quotients& factor) {
    return length(middle) * factor.radius() + factor.largest() * radius;
}

/// (A - pole w) divided by the distance from a side on which that vanishes, of as many points.
Net divided(const Net& net, std::size_t side, const Vec3& pole) {
    const bool along_u = side % 2 == 1;  // the distance grows along u
    const std::size_t count = along_u ? net.wide : net.high;
    const double degree = static_cast<double>(count - 1);
    const bool from_far = side == 1 || side == 2;
    Net result;
    result.wide = net.wide, result.high = net.high;
    for (std::size_t j = 0; j < net.high; ++j)
        for (std::size_t i = 0; i < net.wide; ++i) {
            // The k-th row from the side: one degree less, then raised again.
            const auto lifted = [&](std::size_t k) {
                const std::size_t row = from_far ? count - 1 - k : k;
                const Vec4& a = along_u ? net.at(row, j) : net.at(i, row);
                return Vec3(a) - a.w * pole;
            };
            const std::size_t here = along_u ? i : j, k = from_far ? count - 1 - here : here;
            Vec3 sum(0);
            if (k > 0) sum += lifted(k);
            if (k + 1 < count)
                sum += (degree - static_cast<double>(k)) / static_cast<double>(k + 1) * lifted(k + 1);
            result.at(i, j) = Vec4(sum, 0);
        }
    return result;
}

/// The patch over a box: nets of A and its derivatives, about the middle of the box.
struct Part {
    const RationalPatch& patch;
    Net whole = net_of(patch);
    Restriction in_box;
    Net a, a_u, a_v;

    Part(const RationalPatch& of, const Vec2& low, const Vec2& high)
        : patch(of),
          in_box(whole, low, high),
          a(in_box(whole)),
          a_u(in_box(derivative(whole, 0))),
          a_v(in_box(derivative(whole, 1))) {}
};

/// The tangents as far as their cross product has one direction: hulls with what else may be added.
struct Tangents {
    std::span<const Vec3> u, v;
    double u_slack = 0, v_slack = 0;
};

/// With P = pole + d H, d the distance from the side: the normal is along H_s x P_d, s along the side.
double normal_radius_at_pole(const Part& part, std::size_t side, const Tangents& tangents,
                             const Vec3& normal) {
    const bool along_u = side % 2 == 0;  // the side
    const std::size_t corner = side == 0 ? 0 : side == 3 ? 0 : part.whole.size() - 1;
    const Vec3 pole = Vec3(part.whole.point[corner]) / part.whole.point[corner].w;
    const Net g = divided(part.whole, side, pole);
    const Quotients h(part.in_box(g), part.a, Vec3(0)),
        slope(part.in_box(derivative(g, along_u ? 0 : 1)), part.a, Vec3(0)),
        weight(along_u ? part.a_u : part.a_v, part.a, Vec3(0));
    // H_s = G_s / w - H w_s / w.
    const Vec3 middle = h.mean(), shift = weight.middle() * middle;
    const double slack = product_radius(middle, h.farthest(middle), weight);
    std::array<Vec3, kMostPatchRow * kMostPatchRow> along;
    for (std::size_t k = 0; k < slope.count; ++k) along[k] = slope.hull[k] - shift;
    const std::span<const Vec3> hull(along.data(), slope.count);
    const TangentHulls hulls = along_u ? TangentHulls{hull, tangents.v, slack, tangents.v_slack}
                                       : TangentHulls{tangents.u, hull, tangents.u_slack, slack};
    return std::min(2.0, normal_radius(hulls, normal) + kPoleTurn);
}

/// What rounding leaves of evaluated positions, first and second derivatives.
std::array<double, 3> rounding_of(const RationalPatch& patch, const Vec3& position) {
    double lightest = HUGE_VAL, heaviest = 0;
    for (const Vec4& point : patch.points) {
        lightest = std::min(lightest, point.w);
        heaviest = std::max(heaviest, point.w);
    }
    const double degree = std::max(patch.degree_u, patch.degree_v);
    const double share = kPatchRounding * extent_of(patch) * heaviest / lightest;
    const double coordinate = std::max({std::fabs(position.x), std::fabs(position.y), std::fabs(position.z)});
    return {share + kPatchRounding * coordinate, 2 * degree * share, 8 * degree * degree * share};
}

/// What the patch does over the box, `middle` its point at the box's middle: by the convex hulls of quotients
/// of Bezier points. With A = w P about the box's middle, P_u = A_u / w - P w_u / w: the first is within the
/// hull of its quotients of control points, in the second P is small. Where a side is one point, normals
/// are bounded up to it: what the derivative along the side divided by the distance from it has is bounded.
SurfaceBounds patch_bounds(const RationalPatch& patch, const SurfacePoint& middle, const Vec2& low,
                           const Vec2& high) {
    const Part part(patch, low, high);
    const Vec3 about = middle.position - patch.origin;
    const auto quotients = [&](const Net& net) { return Quotients(net, part.a, about); };
    const auto second = [&](int one, int other) {
        return quotients(part.in_box(derivative(derivative(part.whole, one), other)));
    };
    const Quotients position = quotients(part.a), u = quotients(part.a_u), v = quotients(part.a_v);
    const std::array<double, 3> rounding = rounding_of(patch, middle.position);  // by order of derivative
    const double far = position.farthest(Vec3(0));

    SurfaceBounds bounds;
    bounds.middle = middle;
    bounds.position_radius = far + rounding[0];
    bounds.du_radius = u.farthest(middle.du) + far * u.largest() + rounding[1];
    bounds.dv_radius = v.farthest(middle.dv) + far * v.largest() + rounding[1];
    // P_uv = A_uv / w - P_u w_v / w - P_v w_u / w - P w_uv / w.
    const auto radius = [&](const Quotients& of, const Vec3& value, double products, const Vec3& moved) {
        return of.farthest(value + moved) + products + far * of.largest() + rounding[2];
    };
    bounds.duu_radius = radius(second(0, 0), middle.duu, 2 * product_radius(middle.du, bounds.du_radius, u),
                               2 * u.middle() * middle.du);
    bounds.duv_radius = radius(
        second(0, 1), middle.duv,
        product_radius(middle.du, bounds.du_radius, v) + product_radius(middle.dv, bounds.dv_radius, u),
        v.middle() * middle.du + u.middle() * middle.dv);
    bounds.dvv_radius = radius(second(1, 1), middle.dvv, 2 * product_radius(middle.dv, bounds.dv_radius, v),
                               2 * v.middle() * middle.dv);

    const Tangents tangents{u.points(), v.points(), far * u.largest() + rounding[1],
                            far * v.largest() + rounding[1]};
    double turn = normal_radius({tangents.u, tangents.v, tangents.u_slack, tangents.v_slack}, middle.normal);
    for (std::size_t side = 0; side < 4; ++side)
        if (is_collapsed(patch, side))
            turn = std::min(turn, normal_radius_at_pole(part, side, tangents, middle.normal));
    bounds.normal_radius = std::min(turn, 2.0);
    return bounds;
}

/// A box that holds that part of the patch, but for rounding.
Box patch_box(const RationalPatch& patch, const Vec2& low, const Vec2& high) {
    const Net whole = net_of(patch), part = Restriction(whole, low, high)(whole);
    const double room = kPatchRounding * extent_of(patch);
    Box box;
    for (std::size_t k = 0; k < part.size(); ++k) {
        const Vec3 point = patch.origin + Vec3(part.point[k]) / part.point[k].w;
        box.include(point - room);
        box.include(point + room);
    }
    return box;
}

class PatchBounder final : public SurfaceBounder {
  public:
    PatchBounder(const Surface& surface, const std::vector<RationalPatch>& patches)
        : surface_(surface), patches_(patches) {}

    SurfaceBounds bounds(Id face, const Vec2& low, const Vec2& high) const override {
        return patch_bounds(patches_[face], surface_.eval(face, 0.5 * (low + high)), low, high);
    }
    Box box(Id face, const Vec2& low, const Vec2& high) const override {
        return patch_box(patches_[face], low, high);
    }

  private:
    const Surface& surface_;
    const std::vector<RationalPatch>& patches_;
};

class PatchSurface final : public Surface, public HasHulls {
  public:
    explicit PatchSurface(std::vector<RationalPatch> patches)
        : patches_(std::move(patches)), borders_(join_patches(patches_)) {
        for (const RationalPatch& patch : patches_) extents_.push_back(extent_of(patch));
    }

    std::size_t face_count() const override { return patches_.size(); }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    FaceBorder border(Id face) const override { return borders_[face]; }
    SurfacePoint eval(Id face, const Vec2& uv) const override {
        return evaluate(patches_[face], clamped(uv), extents_[face]);
    }
    SurfacePoint eval_first_order(Id face, const Vec2& uv) const override {
        return evaluate_first_order(patches_[face], clamped(uv), extents_[face]);
    }
    std::size_t bytes_held() const override {
        std::size_t bytes = patches_.capacity() * sizeof(RationalPatch) +
                            borders_.capacity() * sizeof(FaceBorder) + extents_.capacity() * sizeof(double);
        for (const RationalPatch& patch : patches_) bytes += patch.points.capacity() * sizeof(Vec4);
        return bytes;
    }
    std::unique_ptr<const SurfaceBounder> make_bounder() const override {
        return std::make_unique<PatchBounder>(*this, patches_);
    }
    std::optional<Box> hull(Id face) const override { return patch_box(patches_[face], Vec2(0), Vec2(1)); }

  private:
    /// Not-a-number becomes 0.
    static Vec2 clamped(const Vec2& uv) {
        const auto clamp = [](double x) { return x > 0 ? std::fmin(x, 1.0) : 0.0; };
        return {clamp(uv.x), clamp(uv.y)};
    }

    std::vector<RationalPatch> patches_;
    std::vector<FaceBorder> borders_;
    std::vector<double> extents_;
};

}  // namespace

std::unique_ptr<Surface> make_patch_surface(std::vector<RationalPatch> patches, const std::string& name) {
    if (patches.empty()) throw InputError(name, "", "has no patches");
    return std::make_unique<PatchSurface>(std::move(patches));
}

}  // namespace trilens
