#include "render/project/image_light.h"

#include <algorithm>
#include <cmath>

#include "base/math/box.h"
#include "shade/optic_weights.h"
#include "shade/shade.h"

namespace trilens {
namespace {

Vec3 transmittance(const Material* glass, double way) {
    return glass ? volume_transmittance(*glass, way) : Vec3(1);
}

/// Cosine of the angle of incidence of light that goes along `in` to the optic and along `out` from it.
double incidence_cosine(Path path, const Vec3& in, const Vec3& out, double eta) {
    if (path == Path::kReflect) return std::sqrt(std::clamp((1 - dot(in, out)) / 2, 0.0, 1.0));
    const Vec3 normal = normalize_or_zero(eta * in - out);  // Snell: n1 in - n2 out is along the normal
    return std::clamp(std::fabs(dot(in, normal)), 0.0, 1.0);
}

}  // namespace

Vec3 weight_over_one(const World& world, const Frame& frame, const OneEventWay& way) {
    const Optic& optic = world.optics[way.optic];
    const Media around = frame.camera_media.none() ? Media() : frame.camera_media.of(way.view);
    const Vec3 to_optic = way.from - way.view.origin, on = way.point - way.from;
    const Vec3 in = normalize_or_zero(way.view.direction), out = normalize_or_zero(on);
    const Material* before = glass_around(world, around);
    const Vec3 arriving = transmittance(before, length(to_optic));
    if (optic.mirror) {
        const double cosine = incidence_cosine(Path::kReflect, in, out, 1);
        const Material& metal = world.scene.materials[optic.material];
        return arriving * optic_weights(metal, {cosine, way.front}, world.scene.render.fresnel).reflect *
               transmittance(before, length(on));
    }
    const GlassInterface glass = interface_of(world, way.optic, around, way.front);
    const double cosine = incidence_cosine(way.path, in, out, eta_of(glass, -1));
    const OpticWeights weights = interface_weights(glass, cosine, world.scene.render.fresnel);
    return way.path == Path::kReflect ? arriving * weights.reflect * transmittance(glass.before, length(on))
                                      : arriving * weights.refract * transmittance(glass.after, length(on));
}

std::optional<Vec3> weight_over_several(const PathWorld& paths, const EventsWay& way) {
    Vec3 weight(1), from = way.start;
    Colours colours = kAllColours;
    Media media = way.around;
    for (std::size_t i = 0; i < way.events.size(); ++i) {
        const PathEvent& event = way.events[i];
        const Vec3 to = event.point - from;
        weight *= body_transmittance(paths, active_medium(paths, media), length(to));
        const Meeting at{event.optic, normalize_or_zero(to), event.point, event.normal, event.front};
        const Branches ways = branches(paths, at, media, colours);
        // Where glass parts them green comes first.
        const auto taken = std::find_if(ways.begin(), ways.end(), [&](const Branch& one) {
            return one.step.event == event.event && (way.colours.empty() || one.colours == way.colours[i]);
        });
        if (taken == ways.end()) return std::nullopt;
        weight *= taken->weight;
        media = taken->media;
        colours = taken->colours;
        from = event.point;
    }
    return weight * body_transmittance(paths, active_medium(paths, media), length(way.point - from));
}

Vec3 weight_of_direct(const World& world, const Frame& frame, const Ray& view, double way) {
    if (frame.camera_media.none()) return Vec3(1);
    return transmittance(glass_around(world, frame.camera_media.of(view)), way);
}

namespace {

/// A segment is free if what it meets lies within this share of its ends; at its start, of the size of what
/// may hide something, where that is less: all there is lies at the start of a way to infinity.
constexpr double kSightFreeShare = 1e-6;

double size_of_all(const World& world) {
    Box box;
    for (const Vec3& point : world.objects.points) box.include(point);
    double size = box.empty() ? 0 : length(box.size());
    for (std::size_t i = 0; i < world.optics.size(); ++i)
        size = std::max(size, 2 * limit_tracer(world, i).size());
    return size;
}

}  // namespace

double OcclusionQueries::after_start(const Ray& segment) const {
    const double size = size_.get([&] { return std::make_unique<double>(size_of_all(world_)); });
    const double way = length(segment.direction);
    return way > size ? kSightFreeShare * (size / way) : kSightFreeShare;
}

bool OcclusionQueries::is_free_of_objects(const Vec3& from, const Vec3& to) const {
    const Ray segment{from, to - from};
    return !object_tracer(world_).occluded(segment, after_start(segment), 1 - kSightFreeShare);
}

bool OcclusionQueries::is_free_of_facets(const Ray& segment, std::size_t optic) const {
    return !frame_.optics[optic].facets->tracer().occluded(segment, after_start(segment),
                                                           1 - kSightFreeShare);
}

bool OcclusionQueries::is_free_of_surface(const Ray& segment, std::size_t optic) const {
    return !limit_tracer(world_, optic).meets(segment, after_start(segment), 1 - kSightFreeShare);
}

bool OcclusionQueries::is_free_of_optic(const Vec3& from, const Vec3& to, std::size_t optic) const {
    const Ray segment{from, to - from};
    return exact_ ? is_free_of_surface(segment, optic) : is_free_of_facets(segment, optic);
}

bool OcclusionQueries::sees(const Vec3& from, const Vec3& to, Id on_facet) const {
    if (!is_free_of_objects(from, to)) return false;
    const Ray segment{from, to - from};
    for (std::size_t i = 0; i < world_.optics.size(); ++i)
        if (i == on_facet ? !is_free_of_facets(segment, i) : !is_free_of_optic(from, to, i)) return false;
    return true;
}

bool OcclusionQueries::goes_straight(const Vec3& from, const Vec3& to, Id on_facet) const {
    const Ray segment{from, to - from};
    for (std::size_t i = 0; i < world_.optics.size(); ++i)
        if (i == on_facet ? !is_free_of_facets(segment, i) : !is_free_of_surface(segment, i)) return false;
    return true;
}

}  // namespace trilens
