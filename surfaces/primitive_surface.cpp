// Primitive surfaces in the world: a shape in its own frame, and rays against it in closed form.
#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <utility>

#include "base/description/lens_sag.h"
#include "base/util/error.h"
#include "surfaces/lens_surface.h"
#include "surfaces/primitive_shapes.h"
#include "surfaces/primitives/primitive_bounds.h"
#include "surfaces/surfaces.h"

namespace trilens {
namespace {

class PrimitiveSurface final : public Surface {
  public:
    PrimitiveSurface(const Primitive& primitive, std::unique_ptr<PrimitiveShape> shape,
                     const Mat3& world_from_local)
        : kind_(primitive.kind),
          shape_(std::move(shape)),
          center_(primitive.center),
          world_from_local_(world_from_local) {}

    std::size_t face_count() const override { return shape_->face_count(); }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    FaceBorder border(Id face) const override { return shape_->border(face); }
    bool has_closed_form() const override { return true; }
    bool is_flat(Id) const override { return std::holds_alternative<PlanePrimitive>(kind_); }
    double sphere_curvature() const override {
        const auto* sphere = std::get_if<SpherePrimitive>(&kind_);
        return sphere ? 1 / sphere->radius : 0;
    }
    SurfaceParameter sphere_place(const Vec3& normal) const override {
        if (!std::holds_alternative<SpherePrimitive>(kind_)) return {};
        return shape_->place(glm::transpose(world_from_local_) * normal);
    }
    std::unique_ptr<const SurfaceBounder> make_bounder() const override {
        return make_primitive_bounder(kind_, *this);
    }

    SurfacePoint eval(Id face, const Vec2& uv) const override {
        SurfacePoint point = eval_first_order(face, uv);
        for (Vec3* vector : {&point.duu, &point.duv, &point.dvv}) *vector = world_from_local_ * *vector;
        return point;
    }
    /// The second derivatives stay in the shape's frame.
    SurfacePoint eval_first_order(Id face, const Vec2& uv) const override {
        const auto clamp = [](double x) { return x > 0 ? std::min(x, 1.0) : 0.0; };
        SurfacePoint point = shape_->eval(face, {clamp(uv.x), clamp(uv.y)});
        for (Vec3* vector : {&point.position, &point.du, &point.dv, &point.normal})
            *vector = world_from_local_ * *vector;
        point.position += center_;
        return point;
    }

    std::optional<SurfaceHit> intersect(const Ray& ray, double t_min) const override {
        std::optional<SurfaceHit> first;
        for_each_root(ray, t_min, [&](double t, const Vec3& point) {
            const SurfaceParameter place = shape_->place(point);
            if (place.face != kNone) first = {place.face, place.uv, t, eval(place.face, place.uv)};
            return first.has_value();
        });
        return first;
    }

    bool meets(const Ray& ray, double t_min, double t_max) const override {
        bool found = false;
        for_each_root(ray, t_min, [&](double t, const Vec3& point) {
            found = t < t_max && shape_->has(point);
            return found;
        });
        return found;
    }

  private:
    /// Calls use(t, point) for t > t_min where the ray meets the uncut shape, ascending, until it returns
    /// true; the point is in the shape's frame.
    template <typename Use>
    void for_each_root(const Ray& ray, double t_min, Use&& use) const {
        // Start from the ray's point nearest to the centre: the equation then has numbers of the shape's own
        // size. Near the apex of a cone, where both roots are one, they are as small as the distance from it.
        const Mat3 local_from_world = glm::transpose(world_from_local_);
        const Vec3 direction = local_from_world * ray.direction;
        Vec3 origin = local_from_world * (ray.origin - center_);
        const double squared = dot(direction, direction);
        if (!(squared > 0)) return;
        const double start = dot(shape_->equation_center() - origin, direction) / squared;
        origin += start * direction;

        for (double root : quadric_roots(shape_->equation({origin, direction}))) {
            const double t = start + root;
            if (!std::isfinite(t) || !(t > t_min)) continue;
            if (use(t, origin + root * direction)) return;
        }
    }

    PrimitiveKind kind_;
    std::unique_ptr<PrimitiveShape> shape_;
    Vec3 center_;
    Mat3 world_from_local_;  // columns: tangent, axis x tangent, axis
};

void check_positive(double value, const char* what) {
    if (!(value > 0) || !std::isfinite(value))
        throw InputError("", "primitive", std::string(what) + " must be a positive number");
}

void check_sizes(const Primitive& primitive) {
    PrimitiveKind kind = primitive.kind;
    std::visit([](auto& one) { for_each_length(one, check_positive); }, kind);
    if (const auto* lens = std::get_if<LensPrimitive>(&kind))
        if (const char* fault = lens_fault(lens->front, lens->back, lens->thickness, lens->hole))
            throw InputError("", "primitive", std::string("no lens: ") + fault);
    const Vec3& c = primitive.center;
    if (!std::isfinite(c.x) || !std::isfinite(c.y) || !std::isfinite(c.z))
        throw InputError("", "primitive", "center must be finite");
}

Mat3 frame_of(const Primitive& primitive) {
    const Vec3 axis = normalize_or_zero(primitive.axis);
    const Vec3 side = normalize_or_zero(cross(axis, normalize_or_zero(primitive.tangent)));
    if (side == Vec3(0))
        throw InputError("", "primitive", "axis and tangent must be two different directions");
    return Mat3(cross(side, axis), side, axis);
}

}  // namespace

std::unique_ptr<Surface> make_primitive_surface(const Primitive& primitive) {
    check_sizes(primitive);
    const Mat3 frame = frame_of(primitive);
    return std::visit(
        [&]<typename Kind>(const Kind& kind) -> std::unique_ptr<Surface> {
            if constexpr (std::is_same_v<Kind, LensPrimitive>)
                return make_lens_surface(kind, primitive.center, frame);
            else
                return std::make_unique<PrimitiveSurface>(primitive, make_shape(kind), frame);
        },
        primitive.kind);
}

}  // namespace trilens
