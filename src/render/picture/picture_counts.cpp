#include "render/picture/picture_counts.h"

#include <algorithm>

#include "paths/trace/follow.h"

namespace trilens {
namespace {

/// Whether a path that the scene asks for has no ray at this sample, and not because all light is reflected.
bool lacks_ray(const World& world, const SampleViews& views, const SampleView& view) {
    if (view.optic == kNone) return false;
    const Optic& optic = world.optics[view.optic];
    const RenderSettings& settings = world.scene.render;
    const Incidence& incidence = views.on_optic(view).incidence;
    if (optic.mirror) return settings.reflect && !views.find(view, Path::kReflect);
    return settings.refract && !views.find(view, Path::kRefract) && !view.traced &&
           !reflects_totally(interface_of(world, view.optic, views.around_of(view), incidence.front),
                             incidence.cosine);
}

}  // namespace

void count_pixel(const World& world, const SampleViews& middle, const SampleView& view,
                 LayerStatistics& counts) {
    if (view.optic == kNone) return;
    const OpticView& on_optic = middle.on_optic(view);
    ++counts.optic_pixels;
    counts.pixels_without_ray += lacks_ray(world, middle, view);
    counts.traced_pixels += view.traced;
    counts.layered_pixels += !view.traced && view.nested > 0;
    counts.subdivided_pixels += !view.traced && view.level > 0;
    counts.faint_light = std::max(counts.faint_light, of_worst_colour(on_optic.cut.faint));
    counts.predicted_error = std::max(counts.predicted_error, on_optic.predicted);
    counts.certified_pixels += on_optic.bound > 0;
    counts.certified_error = std::max(counts.certified_error, on_optic.bound);
    counts.deep_light = std::max(counts.deep_light, of_worst_colour(on_optic.cut.too_deep));
    const double deep = of_worst_colour(on_optic.deep);
    counts.deep_pixels += deep > kLeastWeight;
    counts.deep_sum += deep;
}

void merge_counts(const LayerStatistics& from, LayerStatistics& to) {
    to.optic_pixels += from.optic_pixels;
    to.pixels_without_ray += from.pixels_without_ray;
    to.traced_pixels += from.traced_pixels;
    to.layered_pixels += from.layered_pixels;
    to.subdivided_pixels += from.subdivided_pixels;
    to.faint_light = std::max(to.faint_light, from.faint_light);
    to.predicted_error = std::max(to.predicted_error, from.predicted_error);
    to.certified_pixels += from.certified_pixels;
    to.certified_error = std::max(to.certified_error, from.certified_error);
    to.unbounded_pixels += from.unbounded_pixels;
    to.outline_pixels += from.outline_pixels;
    to.deep_light = std::max(to.deep_light, from.deep_light);
    to.deep_pixels += from.deep_pixels;
    to.deep_sum += from.deep_sum;
    to.fragment_pixels += from.fragment_pixels;
    to.fragments += from.fragments;
    to.rays_by_sample += from.rays_by_sample;
    to.pixels_shaded_by_sample += from.pixels_shaded_by_sample;
    to.projected_facets = std::max(to.projected_facets, from.projected_facets);
    to.crowded_out = std::max(to.crowded_out, from.crowded_out);
}

}  // namespace trilens
