#include "shade/light_batch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/light_batch.cpp"
#include <hwy/foreach_target.h>
#include "base/math/double_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens::light_kernels {
namespace HWY_NAMESPACE {
using namespace lanes::HWY_NAMESPACE;
namespace hn = hwy::HWY_NAMESPACE;

// All in the order of sample_light() and shade_hit(), so that it rounds alike.

static_assert(kShadeLanes % kWidth == 0);

HWY_INLINE Truth is_positive(Number x) {
    return hn::Gt(x, number(0));
}

struct Basis {
    Vector first, second;
};
/// As tangent_basis.
HWY_INLINE Basis basis_of(const Vector& n) {
    const Number sign = hn::CopySign(number(1), n.z);
    const Number a = hn::Div(number(-1), hn::Add(sign, n.z));
    const Number b = hn::Mul(hn::Mul(n.x, n.y), a);
    return {{hn::Add(number(1), hn::Mul(hn::Mul(hn::Mul(sign, n.x), n.x), a)), hn::Mul(sign, b),
             hn::Mul(hn::Neg(sign), n.x)},
            {b, hn::Add(sign, hn::Mul(hn::Mul(n.y, n.y), a)), hn::Neg(n.y)}};
}
HWY_INLINE Vector across(const Basis& basis, double x, double y) {
    return plus(times(number(x), basis.first), times(number(y), basis.second));
}

/// A light's sample as the points of a register see it; without `lit` the rest is anything.
struct Seen {
    Vector toward, target;
    Number irradiance;
    Truth lit;
};

HWY_INLINE Seen see(const FarLightLanes& light, const Vector& position, const Vector&) {
    return {vector(light.toward), plus(position, vector(light.far)), number(light.irradiance),
            hn::FirstN(kTag, kWidth)};
}

HWY_INLINE Seen see(const PointLightLanes& light, const Vector& position, const Vector&) {
    const Vector target = vector(light.position), way = minus(target, position);
    const Number distance2 = dot(way, way);
    const Vector toward = unit_or_zero(way);
    Number irradiance = hn::Div(number(light.intensity), distance2);
    if (light.is_spot) {
        const Number inside =
            hn::Sub(hn::Neg(dot(vector(light.direction), toward)), number(light.outer_cosine));
        const Number share = hn::Div(inside, number(light.fall_off));
        const Number within = hn::IfThenElse(hn::Lt(share, number(0)), number(0), smaller(share, number(1)));
        irradiance = hn::Mul(irradiance, hn::Mul(within, within));
    }
    return {toward, target, irradiance, is_positive(distance2)};
}

HWY_INLINE Seen see(const FlatLightLanes& light, const Vector& position, const Vector&) {
    const FlatPart& part = light.part;
    const Vector way = minus(vector(part.position), position);
    const Number distance2 = dot(way, way);
    const Vector toward = unit_or_zero(way);
    const Number cosine = hn::Neg(dot(toward, vector(part.normal)));
    return {toward, vector(light.target),
            hn::Mul(hn::Div(cosine, distance2), number(part.area * part.radiance)),
            hn::And(is_positive(distance2), is_positive(cosine))};
}

HWY_INLINE Seen see(const SphereLightLanes& light, const Vector& position, const Vector&) {
    // The direction, as cone_direction has it.
    const double radius2 = light.light.radius * light.light.radius;
    const Vector way = minus(vector(light.light.position), position);
    const Number distance2 = dot(way, way);
    const Number sine2 = hn::Div(number(radius2), distance2);
    const Number from_one = hn::Div(sine2, hn::Add(number(1), hn::Sqrt(hn::Sub(number(1), sine2))));
    const double share = std::min(dot(light.disk, light.disk), 1.0);
    const Number height = hn::Mul(number(share), from_one);
    const Number out = hn::Sqrt(larger(hn::Mul(height, hn::Sub(number(2), height)), number(0)));
    const Number scale = share > 0 ? hn::Div(out, number(std::sqrt(share))) : number(0);
    const Vector axis = unit_or_zero(way);
    const Vector toward =
        unit_or_zero(plus(times(hn::Sub(number(1), height), axis),
                          times(scale, across(basis_of(axis), light.disk.x, light.disk.y))));

    // Where it meets the sphere first.
    const Number middle = dot(way, toward);
    const Number depth =
        hn::Sqrt(larger(hn::Sub(number(radius2), hn::Sub(distance2, hn::Mul(middle, middle))), number(0)));
    const Number solid_angle = hn::Mul(number(2 * std::numbers::pi), from_one);
    return {toward, plus(position, times(hn::Sub(middle, depth), toward)),
            hn::Mul(hn::Div(solid_angle, number(light.light.samples)), number(light.intensity)),
            hn::Gt(distance2, number(radius2))};
}

HWY_INLINE Seen see(const HemisphereLightLanes& light, const Vector& position, const Vector& normal) {
    const Vector toward = unit_or_zero(
        plus(across(basis_of(normal), light.above.x, light.above.y), times(number(light.above.z), normal)));
    const Number facing = dot(toward, normal);
    return {toward, plus(position, times(number(light.far), toward)),
            hn::Mul(hn::Div(number(std::numbers::pi), hn::Mul(number(light.count), facing)),
                    number(light.intensity)),
            is_positive(facing)};
}

template <typename Light>
HWY_INLINE void find_light_of(ShadeBatch& batch, const Light& light, bool casts_shadows) {
    batch.lit = 0;
    for (std::size_t first = 0; first < batch.count; first += kWidth) {
        const Vector normal = load(batch.normal, first);
        const Seen seen = see(light, load(batch.position, first), normal);
        const Number cosine = dot(normal, seen.toward);
        Truth lit = hn::And(seen.lit, is_positive(cosine));
        lit = hn::AndNot(hn::Eq(seen.irradiance, number(0)), lit);
        if (casts_shadows) {
            // Light that arrives from behind a flat triangle is in the triangle's own shadow.
            const Truth before = is_positive(dot(load(batch.geometric_normal, first), seen.toward));
            lit = hn::And(lit, hn::Or(truth_of(batch.smooth >> first), before));
            store(minus(seen.target, load(batch.shadow_start, first)), batch.way, first);
        }
        hn::Store(hn::Mul(hn::Mul(number(std::numbers::inv_pi), seen.irradiance), cosine), kTag,
                  batch.irradiance + first);
        batch.lit |= bits_of(lit) << first;
    }
}

void find_light_here(ShadeBatch& batch, const LightLanes& light, bool casts_shadows) {
    std::visit([&](const auto& kind) { find_light_of(batch, kind, casts_shadows); }, light.kind);
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens::light_kernels
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trilens {
namespace light_kernels {
HWY_EXPORT(find_light_here);
}  // namespace light_kernels

void find_light(ShadeBatch& batch, const LightLanes& light, bool casts_shadows) {
    using namespace light_kernels;
    HWY_DYNAMIC_DISPATCH(find_light_here)(batch, light, casts_shadows);
}

namespace {

PointLightLanes lanes_of(const PointLight& light, double intensity) {
    PointLightLanes lanes;
    lanes.position = light.position;
    lanes.intensity = intensity;
    return lanes;
}

PointLightLanes lanes_of(const SpotLight& light, double intensity) {
    PointLightLanes lanes = lanes_of(PointLight{light.position}, intensity);
    const ConeCosines cone = cone_cosines(light);
    lanes.is_spot = true;
    lanes.direction = light.direction;
    lanes.outer_cosine = cone.outer;
    lanes.fall_off = cone.fall_off;
    return lanes;
}

}  // namespace

LightLanes light_lanes(const ShadeScene& scene, std::size_t light, std::size_t sample) {
    const double intensity = scene.lights[light].intensity;
    return std::visit(
        [&](const auto& kind) -> LightLanes {
            using Kind = std::decay_t<decltype(kind)>;
            if constexpr (requires { part_of(kind, intensity, sample); }) {
                const FlatPart part = part_of(kind, intensity, sample);
                return {FlatLightLanes{part, before_flat_light(part, scene.size)}};
            } else if constexpr (requires { lanes_of(kind, intensity); }) {
                return {lanes_of(kind, intensity)};
            } else if constexpr (std::is_same_v<Kind, SphereLight>) {
                const auto count = static_cast<std::size_t>(kind.samples);
                return {SphereLightLanes{kind, intensity, disk_place(stratified_place(sample, count))}};
            } else if constexpr (std::is_same_v<Kind, AmbientLight>) {
                const auto count = static_cast<std::size_t>(kind.samples);
                return {HemisphereLightLanes{hemisphere_direction(sample, count), intensity,
                                             static_cast<double>(count),
                                             occlusion_distance(kind, scene.size)}};
            } else {  // the same from everywhere: as the origin sees it
                const LightSample seen = light_sample(scene, light, sample, {Vec3(0), Vec3(0), scene.size});
                return {FarLightLanes{seen.toward, seen.target, seen.irradiance}, seen.color};
            }
        },
        scene.lights[light].kind);
}

}  // namespace trilens
#endif
