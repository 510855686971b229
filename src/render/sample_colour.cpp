#include "render/sample_colour.h"

#include "render/surroundings.h"

namespace trilens {

double path_length(const PathEnd& end) {
    return end.hit.t * length(end.ray.direction);
}

SampleColour sample_colour(const World& world, const SampleViews& views, const SampleView& view) {
    const RenderSettings& settings = world.scene.render;
    SampleColour colour;
    if (view.ray.direction == Vec3(0)) return colour;  // the camera has no ray there
    colour.coverage = view.hit.seen() || view.optic != kNone ? 1 : 0;
    if (view.optic == kNone) {
        if (settings.direct)
            colour.direct = light_of_view(world, views, view) * shade_ray(world.shading, view.hit, view.ray);
        return colour;
    }
    const OpticWeights weights = first_weights(world, views, view);
    for (const PathEnd& end : views.ends_of(view)) {
        const bool reflected = end.path == Path::kReflect;
        const Vec3 weight = (reflected ? weights.reflect : weights.refract) * end.weight;
        if (weight == Vec3(0)) continue;
        Vec3 light = shade_ray(world.shading, end.hit, end.ray);
        if (end.medium != kNone && end.hit.seen())
            light *= volume_transmittance(world.scene.materials[world.optics[end.medium].material],
                                          path_length(end));
        (reflected ? colour.reflect : colour.refract) += weight * light;
    }
    return colour;
}

}  // namespace trilens
