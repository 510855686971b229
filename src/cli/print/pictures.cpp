#include "cli/print/print.h"

#include <trilens/utilities.h>

#include <algorithm>
#include <cstdio>

#include "terminal/libraries.h"

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

Json probes_of(const Renderer& renderer, const LayerStatistics& counts) {
    Json all = Json::array();
    for (const OpticProbes& one : counts.probes)
        all.push_back({{"object", renderer.scene().meshes[one.object].name},
                       {"surveyed_facets", one.surveyed},
                       {"least_samples", one.least_samples},
                       {"cost", one.cost},
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
            {"probes", probes_of(renderer, picture.statistics)},
            {"projected_facets", picture.statistics.projected_facets},
            {"predicted_error", picture.statistics.predicted_error},
            {"certified_pixels", picture.statistics.certified_pixels},
            {"certified_error", picture.statistics.certified_error},
            {"outline_pixels", picture.statistics.outline_pixels},
            {"marks", picture.statistics.marks},
            {"hidden_marks", picture.statistics.hidden_marks},
            {"crowded_marks", picture.statistics.crowded_marks},
            {"unseen_marks", picture.statistics.unseen_marks},
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
    if (!choice.caustics) fields["marks"] = drawing.marks;
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

namespace {

void write_bytes(const void* bytes, std::size_t size) {
    stop_at_once(true);  // a pipe that nobody reads
    if (std::fwrite(bytes, 1, size, stdout) != size || std::fflush(stdout) != 0)
        throw OutputError("standard output", "cannot be written");
}

Answer named(const std::string& output) {
    Answer answer;
    answer.is_report = true;
    answer.fields["output"] = output;
    if (!is_standard_stream(output)) answer.text = output;
    return answer;
}

Answer answer_of(const std::string& output, const Stopwatch& watch, Console& console) {
    console.note_stage("wrote " + (is_standard_stream(output) ? "standard output" : output), watch);
    return named(output);
}

}  // namespace

void check_output(const std::string& output, Console& console) {
    if (is_standard_stream(output) && console.is_stdout_answered())
        throw UsageError(
            "-o - and --json both write to standard output; give one of them a file: --json=FILE");
    console.files().writes(output);
}

void check_scene_output(const std::string& output, Console& console) {
    const std::string ending = file_ending(output);
    if (!is_standard_stream(output) && !ending.empty() && ending != ".json")
        throw UsageError("the output \"" + output + "\" is a scene file: its name ends in .json");
    check_output(output, console);
}

Answer name_output(const std::string& output, Console& console) {
    console.note("wrote " + output + " meanwhile");
    return named(output);
}

Answer write_output(const std::string& output, const Image& image, const OutputFormat& format,
                    Console& console) {
    const Stopwatch watch;
    if (is_standard_stream(output)) {
        const std::vector<unsigned char> bytes = encode_image_as(image, format.file, format.tone);
        write_bytes(bytes.data(), bytes.size());
    } else {
        write_image_as(output, image, format.file, format.tone);
    }
    return answer_of(output, watch, console);
}

Answer write_output(const std::string& output, std::span<const unsigned char> encoded, Console& console) {
    const Stopwatch watch;
    if (is_standard_stream(output))
        write_bytes(encoded.data(), encoded.size());
    else
        replace_file(output, encoded);
    return answer_of(output, watch, console);
}

Answer write_output(const std::string& output, const std::string& text, Console& console) {
    const Stopwatch watch;
    if (is_standard_stream(output))
        write_bytes(text.data(), text.size());
    else
        replace_text_file(output, text);
    return answer_of(output, watch, console);
}

}  // namespace trilens
