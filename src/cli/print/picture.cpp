#include "cli/print/picture.h"

#include <algorithm>

#include "terminal/format.h"

namespace trilens {
namespace {

/// Of the optics' pixels: projected through whole facets or layers, through parts of facets, and traced.
Json shares_of(const LayerStatistics& counts) {
    const auto all = static_cast<double>(std::max<std::size_t>(counts.optic_pixels, 1));
    const auto share = [&](std::size_t pixels) { return static_cast<double>(pixels) / all; };
    return {{"projected", share(counts.optic_pixels - counts.subdivided_pixels - counts.traced_pixels)},
            {"divided", share(counts.subdivided_pixels)},
            {"traced", share(counts.traced_pixels)}};
}

Json looks_of(const Renderer& renderer, const LayerStatistics& counts) {
    Json all = Json::array();
    for (const OpticLooks& one : counts.looks)
        all.push_back({{"object", renderer.scene().meshes[one.object].name},
                       {"surveyed_facets", one.surveyed},
                       {"least_samples", one.least_samples},
                       {"look", one.look},
                       {"saved", one.saved}});
    return all;
}

}  // namespace

Json picture_fields(const Renderer& renderer, const Picture& picture) {
    return {{"width", picture.image.width},
            {"height", picture.image.height},
            {"triangles", renderer.triangle_count()},
            {"facets", renderer.facet_count()},
            {"optic_pixels", picture.statistics.optic_pixels},
            {"pixels_without_ray", picture.statistics.pixels_without_ray},
            {"subdivided_pixels", picture.statistics.subdivided_pixels},
            {"traced_pixels", picture.statistics.traced_pixels},
            {"layered_pixels", picture.statistics.layered_pixels},
            {"shares", shares_of(picture.statistics)},
            {"looks", looks_of(renderer, picture.statistics)},
            {"projected_facets", picture.statistics.projected_facets},
            {"predicted_error", picture.statistics.predicted_error},
            {"outline_pixels", picture.statistics.outline_pixels},
            {"fragment_pixels", picture.statistics.fragment_pixels},
            {"fragments", picture.statistics.fragments},
            {"fragments_per_pixel", picture.statistics.fragments_per_pixel()},
            {"rays_by_sample", picture.statistics.rays_by_sample},
            {"pixels_shaded_by_sample", picture.statistics.pixels_shaded_by_sample},
            {"left_out",
             {{"faint", picture.statistics.faint_light},
              {"deep", picture.statistics.deep_light},
              {"deep_pixels", picture.statistics.deep_pixels}}},
            {"prepare_seconds", picture.prepare_seconds},
            {"draw_seconds", picture.draw_seconds}};
}

Json drawing_fields(const Film& film, const LineChoice& choice, const LineDrawing& drawing) {
    Json fields{{"engine", "exact"}, {"width", film.width}, {"height", film.height}};
    if (!choice.caustics)
        fields.update(Json{{"wire", choice.wire}, {"curves", drawing.curves}, {"arcs", drawing.arcs}});
    fields["folds"] = drawing.folds;
    if (!choice.caustics) return fields;
    std::size_t triangles = 0, segments = 0;
    for (const LineDrawing::Caustic& one : drawing.caustics)
        triangles += one.sheet.triangles.size(), segments += one.sheet.segments.size();
    fields["caustics"] = {
        {"sheets", drawing.caustics.size()}, {"triangles", triangles}, {"segments", segments}};
    return fields;
}

std::string picture_note(const Picture& picture) {
    return fmt::format(
        "drew {} x {} pixels, {} of them of optics ({} in layers, {} subdivided, {} traced): prepared in "
        "{:.3f} s, "
        "drawn in {:.3f} s",
        picture.image.width, picture.image.height, picture.statistics.optic_pixels,
        picture.statistics.layered_pixels, picture.statistics.subdivided_pixels,
        picture.statistics.traced_pixels, picture.prepare_seconds, picture.draw_seconds);
}

}  // namespace trilens
