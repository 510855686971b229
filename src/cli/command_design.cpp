// trilens design: a freeform mirror, or a lens' front, for a wanted map.
#include <trilens/design.h>
#include <trilens/utilities.h>

#include <algorithm>
#include <span>

#include "cli/commands.h"
#include "cli/print/print.h"
#include "terminal/command.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

struct DesignOptions {
    std::string wish, output, stl, obj, sag, sphere, compare, method = "gauss-newton";
    bool schema = false, example = false;
    double thickness = 0;
};

Json errors_json(const DesignErrors& errors) {
    return {{"mean", json_number(errors.mean)},
            {"p95", json_number(errors.p95)},
            {"max", json_number(errors.max)}};
}

Answer design_answer(const Design& design) {
    Answer answer;
    answer.fields["error_degrees"] = errors_json(design.errors);
    answer.fields["curl_rms"] = json_number(design.curl);
    answer.fields["curl_rms_flat"] = json_number(design.curl_flat);
    answer.fields["sag"] = json_number(design.sag);
    answer.fields["smallest_radius"] = json_number(design.smallest_radius);
    answer.fields["iterations"] = design.iterations;
    answer.fields["converged"] = design.converged;
    answer.fields["controls"] = {design.surface.controls[0], design.surface.controls[1]};
    answer.text = fmt::format("off by {:.4g} degrees in the mean, {:.4g} at 95 %, {:.4g} at most\n",
                              design.errors.mean, design.errors.p95, design.errors.max);
    if (design.sphere) {
        const DesignErrors& errors = design.sphere->errors;
        answer.fields["sphere"] = {{"radius", json_number(design.sphere->radius)},
                                   {"error_degrees", errors_json(errors)}};
        answer.text += fmt::format("best sphere, of radius {:.4g}: {:.4g}, {:.4g}, {:.4g} degrees\n",
                                   design.sphere->radius, errors.mean, errors.p95, errors.max);
    }
    answer.text += fmt::format(
        "curl of the wish {:.3g} per unit of length; sag {:.4g}, smallest radius of curvature {:.4g}",
        design.curl, design.sag, design.smallest_radius);
    return answer;
}

void write_files(const DesignOptions& options, const DesignWish& wish, const Design& design) {
    const double side = std::max(wish.patch.size.x, wish.patch.size.y);
    if (!options.stl.empty()) {
        const std::string bytes = design_stl(design, options.thickness > 0 ? options.thickness : side / 20);
        replace_file(options.stl,
                     std::span(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
    }
    if (!options.obj.empty()) replace_text_file(options.obj, design_obj(design));
    if (!options.sag.empty()) replace_text_file(options.sag, design_sag_table(design));
    if (!options.sphere.empty())
        replace_text_file(options.sphere, design_scene(wish, design_of_sphere(wish, design)));
}

Answer run(const DesignOptions& options, Console& console) {
    if (options.schema)
        return Answer{.text = wish_schema(), .fields = {{"schema_document", Json::parse(wish_schema())}}};
    if (options.example)
        return Answer{.text = wish_example(), .fields = {{"wish", Json::parse(wish_example())}}};
    if (options.wish.empty() || options.output.empty())
        throw UsageError("design needs a wish and -o MIRROR.json; --example prints a wish to start from");
    console.files().reads({options.wish});
    const DesignWish wish = read_wish(options.wish);
    if (wish.lens && options.thickness > 0)
        throw UsageError("--thickness is of mirrors: the wish says how thick the lens is");
    check_scene_output(options.output, console);
    for (const std::string& file : {options.stl, options.obj, options.sag, options.sphere})
        if (!file.empty()) {
            if (is_standard_stream(file)) throw UsageError("only -o may write to standard output");
            check_output(file, console);
        }

    DesignRequest request;
    request.method = options.method == "picard" ? DesignMethod::kPicard : DesignMethod::kGaussNewton;
    request.compare_sphere = options.compare == "sphere" || !options.sphere.empty();
    const Stopwatch watch;
    const Design design = design_mirror(wish, request, console.progress("design"));
    const double seconds = watch.seconds();
    console.note_stage(std::string("designed the ") + optic_word(wish), watch);
    for (const std::string& warning : design.warnings) console.warn(warning);
    write_files(options, wish, design);
    Answer answer = design_answer(design);
    write_output(options.output, design_scene(wish, design), console);
    answer.fields["seconds"] = seconds;
    answer.fields["output"] = options.output;
    if (is_standard_stream(options.output)) answer.text.clear();
    return answer;
}

}  // namespace

Command design_command() {
    auto options = std::make_shared<DesignOptions>();
    Command command{.name = "design",
                    .summary = "a freeform mirror or lens in which an eye sees what is wished",
                    .schema = "design"};
    command.options = {
        {.names = "WISH",
         .target = &options->wish,
         .help = "a wish file: the eye, the mirror's or the lens' rectangle, and what is to be seen where",
         .offer = Offer::kFile},
        {.names = "-o,--output",
         .target = &options->output,
         .help = "the mirror or lens as a scene, with the eye as its camera",
         .value = "MIRROR.json",
         .offer = Offer::kFile},
        {.names = "--compare",
         .target = &options->compare,
         .help = "what the mirror is held against",
         .choices = {"sphere"}},
        {.names = "--sphere",
         .target = &options->sphere,
         .help = "the best sphere as a scene of the same kind",
         .value = "SPHERE.json",
         .offer = Offer::kFile},
        {.names = "--stl",
         .target = &options->stl,
         .help = "the mirror or lens as a closed body, for printing and milling",
         .value = "FILE.stl",
         .offer = Offer::kFile},
        {.names = "--thickness",
         .target = &options->thickness,
         .help = "of a mirror's body behind its lowest point; else a twentieth of its longer side",
         .range = {1e-9, 1e9}},
        {.names = "--obj",
         .target = &options->obj,
         .help = "the designed surface as polygons with normals",
         .value = "FILE.obj",
         .offer = Offer::kFile},
        {.names = "--sag",
         .target = &options->sag,
         .help = "a table of heights and normals",
         .value = "FILE.csv",
         .offer = Offer::kFile},
        {.names = "--method",
         .target = &options->method,
         .help = "gauss-newton: the rays that leave; picard: linear, for slopes, faster",
         .choices = {"gauss-newton", "picard"}},
        {.names = "--schema", .target = &options->schema, .help = "print the JSON Schema of wish files"},
        {.names = "--example",
         .target = &options->example,
         .help = "print a wish to start from: a driver's mirror"}};
    command.body = [options](Console& console) { return run(*options, console); };
    return command;
}

}  // namespace trilens
