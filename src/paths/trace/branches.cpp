// Snell and Fresnel between the media on both sides of an interface.
#include "paths/trace/path_world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "reflect/reflection.h"
#include "refract/refraction.h"
#include "shade/microfacets.h"
#include "shade/optic_weights.h"
#include "shade/shade.h"

namespace trilens {

namespace {

/// The part of `weight` in these colours.
Vec3 masked(const Vec3& weight, Colours colours) {
    if (colours == kAllColours) return weight;
    Vec3 one(0);
    one[colours] = weight[colours];
    return one;
}

/// An interface with the media on its sides, for one ray that arrives.
struct Interface {
    const PathWorld& world;
    const Meeting& at;
    Media before, after;
    Vec3 normal;  // on the ray's side

    /// Two bodies of one material that touch or overlap have none.
    GlassInterface glass() const {
        return {felt_glass(world, before), felt_glass(world, after),
                world.optics[at.optic].material->base_color_factor};
    }
    double eta(Colours colours) const { return eta_of(glass(), colours); }
    bool disperses() const {
        const auto [from, to, tint] = glass();
        return (from && from->dispersion > 0) || (to && to->dispersion > 0);
    }
};

/// How one colour parts at an interface.
struct Parted {
    double reflectance = 0;
    double sine2 = 0;               // squared, of the angle of refraction
    std::optional<Vec3> refracted;  // unit direction; none on total internal reflection
};

Parted part(const Interface& interface, Colours colours) {
    const double eta = interface.eta(colours);
    Parted parted;
    parted.refracted = refracted(interface.at.incoming, interface.normal, eta);
    const double cosine = -dot(interface.at.incoming, interface.normal);
    parted.sine2 = eta * eta * std::max(0.0, 1 - cosine * cosine);
    if (!parted.refracted)
        parted.reflectance = 1;
    else if (interface.world.fresnel)
        parted.reflectance = fresnel_reflectance(std::clamp(cosine, 0.0, 1.0), eta);
    return parted;
}

Branches glass_branches(const Interface& interface, Colours colours) {
    const Meeting& at = interface.at;
    const Vec3 tint = interface.world.optics[at.optic].material->base_color_factor;
    Branches ways;
    Vec3 reflectance(0), sine2(0);
    const auto transmit = [&](const Parted& parted, Colours of) {
        if (!parted.refracted) return;
        ways.push_back({{at.optic, Event::kTransmit},
                        *parted.refracted,
                        masked((1 - parted.reflectance) * tint, of),
                        interface.after,
                        of,
                        ways.empty(),
                        Vec3(parted.sine2)});
    };
    if (colours == kAllColours && interface.disperses()) {
        for (const Colours of : {Colours{1}, Colours{0}, Colours{2}}) {  // green leads
            const Parted parted = part(interface, of);
            reflectance[of] = parted.reflectance;
            sine2[of] = parted.sine2;
            transmit(parted, of);
        }
    } else {
        const Parted parted = part(interface, colours);
        reflectance = masked(Vec3(parted.reflectance), colours);
        sine2 = Vec3(parted.sine2);
        transmit(parted, colours);
    }
    if (reflectance != Vec3(0))
        ways.push_back({{at.optic, Event::kReflect},
                        mirrored(at.incoming, interface.normal),
                        reflectance,
                        interface.before,
                        colours,
                        ways.empty(),
                        sine2});
    return ways;
}

double alpha_of(const PathWorld& world, Id optic) {
    const double roughness = world.optics[optic].material->roughness_factor;
    return roughness * roughness;
}

/// Of what leaves a microfacet in proportion to how much of it is seen, takes away what others mask on its
/// way out, and what would go to the wrong side. With visible normals that is all that is left of the BRDF,
/// or of the BTDF, times the cosine, over the density. Source: Heitz 2018.
void mask_microfacets(const RoughSurface& surface, const Vec3& microfacet, Branches& ways) {
    const double density = visible_density(surface, microfacet), cosine = dot(surface.view, microfacet);
    const Branch* end = std::remove_if(ways.begin(), ways.end(), [&](Branch& way) {
        const bool reflects = way.step.event == Event::kReflect;
        const double out = dot(surface.normal, way.direction) * (reflects ? 1 : -1);
        if (!(out > 0)) return true;
        way.weight *= ggx_masking(surface.alpha * surface.alpha, out);
        // Directions turn four times as far, in solid angle, as microfacets that mirror; of those that
        // refract Snell's law tells (Walter et al. 2007, equation 17).
        double turn = 4 * cosine;
        if (!reflects) {
            const double behind = -dot(way.direction, microfacet), sine2 = 1 - cosine * cosine;
            const double eta = sine2 > 0 ? std::sqrt((1 - behind * behind) / sine2) : 1;
            const double off = eta * cosine - behind;
            turn = behind > 0 ? off * off / behind : 0;
        }
        way.lobe = density > 0 ? turn / density : 0;
        return false;
    });
    ways.resize(static_cast<std::size_t>(end - ways.begin()));
}

}  // namespace

Vec3 body_transmittance(const PathWorld& world, Id body, double way) {
    return body == kNone ? Vec3(1) : volume_transmittance(*world.optics[body].material, way);
}

Branches branches(const PathWorld& world, const Meeting& at, const Media& media, Colours colours) {
    const PathOptic& optic = world.optics[at.optic];
    const Vec3 facing = at.front ? at.normal : -at.normal;
    const bool is_rough = at.microfacet != Vec3(0);
    const Vec3 normal = is_rough ? at.microfacet : facing;
    if (optic.mirror) {
        const double cosine = std::clamp(-dot(at.incoming, normal), 0.0, 1.0);
        const Vec3 weight = optic_weights(*optic.material, {cosine, at.front}, world.fresnel).reflect;
        Branches way{Branch{{at.optic, Event::kReflect},
                            mirrored(at.incoming, normal),
                            masked(weight, colours),
                            media,
                            colours,
                            true}};
        if (is_rough) mask_microfacets({facing, -at.incoming, alpha_of(world, at.optic)}, at.microfacet, way);
        return way;
    }

    const std::optional<MediaSides> sides = sides_of(media, at.optic, at.front);
    if (!sides) return {};
    const Interface interface { world, at, sides->before, sides->after, normal };
    const GlassInterface glass = interface.glass();
    if (glass.before == glass.after)
        return Branches{Branch{{at.optic, Event::kPass},
                               at.incoming,
                               masked(Vec3(1), colours),
                               interface.after,
                               colours,
                               true}};
    Branches ways = glass_branches(interface, colours);
    if (is_rough) mask_microfacets({facing, -at.incoming, alpha_of(world, at.optic)}, at.microfacet, ways);
    return ways;
}

Meeting with_microfacet(const PathWorld& world, Meeting at, const Vec2& place) {
    const double alpha = alpha_of(world, at.optic);
    if (alpha > 0)
        at.microfacet = visible_normal({at.front ? at.normal : -at.normal, -at.incoming, alpha}, place);
    return at;
}

namespace {

/// Unit directions and their opposites, so that a plane has half of them on each side; none along an axis,
/// where edges and planes of scenes like to lie.
constexpr std::array<Vec3, 10> kDirections{
    Vec3(0.36, 0.48, 0.8),   Vec3(-0.36, -0.48, -0.8), Vec3(0.8, -0.36, -0.48), Vec3(-0.8, 0.36, 0.48),
    Vec3(-0.6, 0.64, -0.48), Vec3(0.6, -0.64, 0.48),   Vec3(0.64, 0.48, -0.6),  Vec3(-0.64, -0.48, 0.6),
    Vec3(0.48, -0.6, 0.64),  Vec3(-0.48, 0.6, -0.64)};

/// A body, and how far it is to its skin.
using Held = std::pair<double, Id>;

/// Those left last were entered first.
Media nested(std::vector<Held> held) {
    std::sort(held.begin(), held.end());
    held.resize(std::min<std::size_t>(held.size(), Media::kMost));
    Media media;
    for (auto one = held.rbegin(); one != held.rend(); ++one) media.enter(one->second);
    return media;
}

LeavesBody leaving(const PathWorld& world) {
    return [&world](Id body, const Ray& ray) -> std::optional<double> {
        const PathOptic& optic = world.optics[body];
        return optic.mirror ? std::nullopt : leaves_at(optic.tracer->first_hit(ray), ray);
    };
}

}  // namespace

Media bodies_along(const LeavesBody& leaves, const std::vector<Id>& asked, const Ray& ray) {
    std::vector<Held> held;
    for (const Id body : asked)
        if (const auto t = leaves(body, ray)) held.emplace_back(*t, body);
    return nested(std::move(held));
}

Media bodies_along(const PathWorld& world, const std::vector<Id>& asked, const Ray& ray) {
    return bodies_along(leaving(world), asked, ray);
}

EnclosingBodies enclosing_bodies(const LeavesBody& leaves, const std::vector<Id>& asked, const Vec3& point) {
    std::vector<Held> held;
    EnclosingBodies around;
    for (const Id body : asked) {
        double way = 0;
        std::size_t votes = 0;
        for (const Vec3& direction : kDirections)
            if (const auto t = leaves(body, {point, direction})) {
                way += *t;
                ++votes;
            }
        if (votes > 0 && votes < kDirections.size()) around.unsure.push_back(body);
        if (2 * votes > kDirections.size()) held.emplace_back(way / static_cast<double>(votes), body);
    }
    around.media = nested(std::move(held));
    return around;
}

EnclosingBodies enclosing_bodies(const PathWorld& world, const std::vector<Id>& asked, const Vec3& point) {
    return enclosing_bodies(leaving(world), asked, point);
}

}  // namespace trilens
