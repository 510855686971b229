// trilens lens: the first-order quantities of a lens file, its Seidel sums, and the spots of its beams.
#include <trilens/scene.h>
#include <trilens/surface.h>

#include <array>
#include <cmath>
#include <numbers>

#include "cli/commands.h"
#include "cli/print/print.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

struct LensOptions {
    std::string lens, glasses, output;
    std::string line = "d";
    double field = 0, pupil = 0, shift = 0;
    int rings = SpotRequest().rings;
};

/// Null where one is infinite: JSON has no such number.
template <typename T, std::size_t kCount>
Json numbers_json(const T& of, const std::array<NamedNumber<T>, kCount>& numbers) {
    Json json;
    for (const auto& [name, number] : numbers)
        json[name] = std::isfinite(of.*number) ? Json(of.*number) : Json();
    return json;
}

/// As transverse aberrations: `scale` of the sums, and twice that of the chromatic ones.
std::string terms_line(const std::string& name, const SeidelTerms& t, double scale) {
    constexpr double kColumn = 1000;  // what has as many digits before the point, and six behind it, fits
    std::string text = fmt::format("{:>7}", name);
    for (const double sum : {t.spherical, t.coma, t.astigmatism, t.petzval, t.distortion, 2 * t.axial_colour,
                             2 * t.lateral_colour}) {
        const double number = sum * scale + 0.0;  // never -0
        text +=
            std::fabs(number) < kColumn ? fmt::format(" {:10.6f}", number) : fmt::format(" {:10.3e}", number);
    }
    return text + "\n";
}

std::string first_order_text(const FirstOrder& first) {
    std::string text = fmt::format("focal length {:.6g}, back focal length {:.6g}", first.focal_length,
                                   first.back_focal_length);
    if (first.f_number > 0) text += fmt::format(", f/{:.3g}", first.f_number);
    text += fmt::format("\nprincipal planes {:.6g} behind the first vertex, {:.6g} behind the last\n",
                        first.front_principal, first.back_principal);
    text += fmt::format("entrance pupil {:.6g} behind the first vertex, radius {:.6g}\n",
                        first.entrance_pupil, first.entrance_radius);
    text += fmt::format("exit pupil {:.6g} behind the last vertex, radius {:.6g}\n", first.exit_pupil,
                        first.exit_radius);
    return text + fmt::format("Petzval radius {:.6g}\n", first.petzval_radius);
}

/// Null where it gathers nothing along x.
void add_section_along_x(const LensPrescription& lens, SpectralLine line, Answer& answer) {
    Json& along_x = answer.fields["first_order_x"];
    try {
        const FirstOrder first = first_order(section_of(lens, LensSection::kX), line);
        along_x = numbers_json(first, kFirstOrderNumbers);
        answer.text += fmt::format("along x: focal length {:.6g}, back focal length {:.6g}\n",
                                   first.focal_length, first.back_focal_length);
    } catch (const InputError&) {
        along_x = Json();
        answer.text += "along x: no focal length\n";
    }
}

/// Of the section that gathers light; what another one lacks is null.
Answer first_order_answer(const LensPrescription& lens, const FirstOrder& first, LensSection section,
                          SpectralLine line) {
    Answer answer;
    answer.fields["lens"] = lens.name;
    answer.fields["line"] = std::string(name_of(line));
    answer.text = fmt::format("{}: {} surfaces, length {:.6g}\n", lens.name, lens.rows.size(), first.length);
    const Json numbers = numbers_json(first, kFirstOrderNumbers);
    const bool is_along_x = section == LensSection::kX;
    answer.fields["first_order"] = is_along_x ? Json() : numbers;
    if (is_along_x) {
        answer.fields["first_order_x"] = numbers;
        answer.text += "along y: no focal length; along x:\n";
    }
    answer.text += first_order_text(first);
    if (!is_along_x && !is_round(lens)) add_section_along_x(lens, line, answer);
    return answer;
}

/// As transverse aberrations in the paraxial focus, the form of published tables.
std::string seidel_text(const SeidelSums& seidel) {
    const double scale = 1 / (2 * seidel.image_slope);
    std::string text =
        fmt::format("\n{:>7} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10}\n", "surface", "spherical",
                    "coma", "astigm.", "Petzval", "distort.", "axial c.", "lateral c.");
    for (std::size_t i = 0; i < seidel.rows.size(); ++i)
        text += terms_line(std::to_string(i + 1), seidel.rows[i], scale);
    return text + terms_line("sum", seidel.sum, scale);
}

void add_seidel(const LensPrescription& section, const LensOptions& options, double pupil, Answer& answer) {
    const double slope = std::tan(options.field * std::numbers::pi / 180);
    const SeidelSums seidel = seidel_sums(section, {pupil, slope});
    Json& sums = answer.fields["seidel"];
    sums = {{"pupil_radius", pupil},
            {"field_degrees", options.field},
            {"image_slope", seidel.image_slope},
            {"image_height", seidel.image_height},
            {"sum", numbers_json(seidel.sum, kSeidelNumbers)},
            {"surfaces", Json::array()}};
    for (const SeidelTerms& row : seidel.rows) sums["surfaces"].push_back(numbers_json(row, kSeidelNumbers));
    answer.text += seidel_text(seidel);
}

/// `height`: of its centroid, in the section.
void add_spot(const Spot& spot, double height, Answer& answer, Console& console) {
    if (spot.points.empty()) {
        answer.fields["spot"] = {{"rays", 0}, {"asked", spot.asked}};
        for (const char* number : {"centroid", "rms_radius", "radius"})
            answer.fields["spot"][number] = Json();
        console.warn(
            "no ray of the spot's beam comes through the lens: its rims, or total reflection, stop all");
        return;
    }
    answer.fields["spot"] = {{"rays", spot.points.size()},
                             {"asked", spot.asked},
                             {"centroid", {spot.centroid.x, spot.centroid.y}},
                             {"rms_radius", spot.rms_radius},
                             {"radius", spot.radius}};
    answer.text += fmt::format("\nspot of {} of {} rays: rms radius {:.4g}, radius {:.4g}, at {:.6g}\n",
                               spot.points.size(), spot.asked, spot.rms_radius, spot.radius, height);
}

void warn_of(const LensPrescription& lens, LensSection section, Console& console) {
    for (const LensRow& row : lens.rows)
        if (outreaches_terms(row.side)) console.warn(lens.file + ": " + row.place + ": " + kOutreachesTerms);
    for (const LensFault& fault : lens_faults(lens))
        console.warn(lens.file + ": " + lens.rows[fault.row].place + ": " + fault.what);
    if (!is_centred(lens))
        console.warn("first order and Seidel's sums take its surfaces as if none were tilted or decentred");
    if (section == LensSection::kX)
        console.warn(
            "along y it has no focal length: first order, Seidel's sums, the field and the pupil are "
            "those of its section along x");
    else if (!is_round(lens))
        console.warn("first order, Seidel's sums and the pupil are those of its section along y");
}

Answer run(const LensOptions& options, Console& console) {
    console.files().reads({options.lens});
    if (!options.glasses.empty()) console.files().reads({options.glasses});
    const LensPrescription lens = load_lens(options.lens, options.glasses);
    const LensSection section = imaging_section(lens);
    warn_of(lens, section, console);
    const SpectralLine line = *find_named<SpectralLine>(options.line);
    const LensPrescription cut = section_of(lens, section);
    const FirstOrder first = first_order(cut, line);
    Answer answer = first_order_answer(lens, first, section, line);

    const double pupil = options.pupil > 0 ? options.pupil : first.entrance_radius;
    if (!(pupil > 0) || !std::isfinite(pupil)) {
        console.warn("the stop has no aperture: give --pupil for aberrations and spots");
        return answer;
    }
    add_seidel(cut, options, pupil, answer);
    const Spot spot = spot_of(lens, {pupil, options.field, line, options.rings, options.shift});
    add_spot(spot, section == LensSection::kX ? spot.centroid.x : spot.centroid.y, answer, console);
    if (options.output.empty()) return answer;
    std::string table = "x,y\n";
    for (const Vec2& p : spot.points) table += fmt::format("{},{}\n", p.x, p.y);
    const Answer written = write_output(options.output, table, console);
    answer.fields.update(written.fields);
    if (is_standard_stream(options.output)) answer.text = written.text;
    return answer;
}

}  // namespace

Command lens_command() {
    auto options = std::make_shared<LensOptions>();
    Command command{.name = "lens",
                    .summary = "a lens file's focal length, pupils, Seidel sums, and spots of real rays",
                    .schema = "lens"};
    command.options = {{.names = "LENS",
                        .target = &options->lens,
                        .help = "a Zemax file (.zmx), a CODE V sequence (.seq), or JSON with surfaces",
                        .offer = Offer::kFile,
                        .is_required = true},
                       {.names = "--glasses",
                        .target = &options->glasses,
                        .help = "a catalogue of glasses whose names come before those that are built in",
                        .value = "FILE.agf",
                        .offer = Offer::kFile},
                       {.names = "--field",
                        .target = &options->field,
                        .help = "degrees from the axis of the chief ray and of the spot's beam",
                        .range = {-89, 89}},
                       {.names = "--pupil",
                        .target = &options->pupil,
                        .help = "radius of the beam in the entrance pupil; 0: the stop's",
                        .range = {0, 1e9}},
                       {.names = "--line",
                        .target = &options->line,
                        .help = "the spectral line of first order and spot",
                        .choices = names_of<SpectralLine>()},
                       {.names = "--rings",
                        .target = &options->rings,
                        .help = "rings of rays in the spot's beam",
                        .range = {1, 200}},
                       {.names = "--shift",
                        .target = &options->shift,
                        .help = "the spot's plane behind the paraxial focus, along the light",
                        .range = {-1e9, 1e9}},
                       {.names = "-o,--output",
                        .target = &options->output,
                        .help = "x,y of the spot's rays, one per line",
                        .value = "SPOT.csv",
                        .offer = Offer::kFile}};
    command.body = [options](Console& console) { return run(*options, console); };
    return command;
}

}  // namespace trilens
