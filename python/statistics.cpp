// What is known of a picture's making, as a dict.
#include "bindings.h"

namespace trilens::python {

py::dict statistics_dict(const Picture& picture) {
    const LayerStatistics& counts = picture.statistics;
    py::dict statistics;
    statistics["optic_pixels"] = counts.optic_pixels;
    statistics["pixels_without_ray"] = counts.pixels_without_ray;
    statistics["subdivided_pixels"] = counts.subdivided_pixels;
    statistics["traced_pixels"] = counts.traced_pixels;
    statistics["layered_pixels"] = counts.layered_pixels;
    statistics["projected_facets"] = counts.projected_facets;
    statistics["certified_pixels"] = counts.certified_pixels;
    statistics["certified_error"] = counts.certified_error;
    statistics["predicted_error"] = counts.predicted_error;
    py::list probes;
    for (const OpticProbes& one : counts.probes) {
        py::dict of_optic;
        of_optic["object"] = one.object;
        of_optic["surveyed_facets"] = one.surveyed;
        of_optic["least_samples"] = one.least_samples;
        of_optic["cost"] = one.cost;
        of_optic["saved"] = one.saved;
        probes.append(of_optic);
    }
    statistics["probes"] = probes;
    statistics["outline_pixels"] = counts.outline_pixels;
    statistics["deep_pixels"] = counts.deep_pixels;
    statistics["marks"] = counts.marks;
    statistics["hidden_marks"] = counts.hidden_marks;
    statistics["crowded_marks"] = counts.crowded_marks;
    statistics["unseen_marks"] = counts.unseen_marks;
    statistics["fragment_pixels"] = counts.fragment_pixels;
    statistics["fragments"] = counts.fragments;
    statistics["fragments_per_pixel"] = counts.fragments_per_pixel();
    statistics["rays_by_sample"] = counts.rays_by_sample;
    statistics["pixels_shaded_by_sample"] = counts.pixels_shaded_by_sample;
    statistics["prepare_seconds"] = picture.prepare_seconds;
    statistics["draw_seconds"] = picture.draw_seconds;
    return statistics;
}

}  // namespace trilens::python
