// trilens anamorph: pages for mirror anamorphoses, at true scale.
#include <trilens/anamorph.h>
#include <trilens/error.h>
#include <trilens/utilities.h>
#include <limits>
#include <memory>
#include <sstream>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print/print.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

struct AnamorphOptions {
    SceneOptions scene;
    std::string picture, page, paper, orientation = "auto", unit = "cm", bleed = "2mm", window, optic, output,
                                      seen;
    double dpi = AnamorphRequest().dpi, tolerance = AnamorphRequest().tolerance;
    bool fit = false, verify = false;
};

/// The paper as it lies: its longer side along the page's longer one, or as asked.
PaperSize paper_of(const AnamorphOptions& options, const Scene& scene, Id page) {
    PaperSize paper = parse_paper(options.paper);
    bool landscape = options.orientation == "landscape";
    if (options.orientation == "auto") {
        const std::optional<FlatRectangle> flat = flat_rectangle(scene.meshes[page].object);
        landscape = flat && length(flat->u) > length(flat->v);
    }
    if (landscape == (paper.width < paper.height)) std::swap(paper.width, paper.height);
    return paper;
}

PictureWindow window_of(const std::string& text) {
    PictureWindow window{};
    std::istringstream stream(text);
    std::string part;
    std::size_t count = 0;
    for (; std::getline(stream, part, ','); ++count) {
        std::istringstream number(part);
        if (count >= 4 || !(number >> window[count]) || !number.eof()) count = 9;
    }
    if (count != 4) throw UsageError("--window is x0,y0,x1,y1 in pixels of the film, not \"" + text + "\"");
    return window;
}

AnamorphRequest request_of(const AnamorphOptions& options, const Renderer& renderer, Console& console) {
    const Scene& scene = renderer.scene();
    AnamorphRequest request;
    request.page = find_mesh(scene, options.page);
    if (!options.paper.empty()) request.paper = paper_of(options, scene, request.page);
    request.optic = optic_named(renderer, options.optic);
    if (!options.window.empty()) request.window = window_of(options.window);
    request.dpi = options.dpi;
    request.unit = parse_unit(options.unit);
    request.bleed = parse_length(options.bleed);
    request.tolerance = options.tolerance;
    request.frame.camera = find_camera(scene, options.scene.camera);
    console.files().reads({options.picture});
    request.picture = read_photo(options.picture).picture;
    request.picture_name = options.picture;
    if (!request.picture->alpha.empty() && !request.picture->is_premultiplied)
        console.warn(options.picture + ": its alpha is not looked at: colours that it hides are printed");
    return request;
}

void warn_of(const Anamorph& made, const AnamorphOptions& options, Console& console) {
    if (made.coverage < 0.995)
        console.warn(fmt::format(
            "{:.1f} % of the window do not show the page over a mirror: the picture is cut there; {}",
            100 * (1 - made.coverage),
            options.window.empty() ? "no window of the picture's shape that is whole was found"
                                   : "--fit finds the largest window that is whole"));
    if (made.conflict > 0.01)
        console.warn(
            fmt::format("{:.1f} % of the window show places of the page a second time, which fit the larger "
                        "image alone",
                        100 * made.conflict));
}

Answer run(const AnamorphOptions& options, Console& console) {
    console.files().reads({options.scene.scene});
    check_page_name(options.output);
    check_output(options.output, console);
    if (options.fit && !options.window.empty())
        throw UsageError("--fit chooses the window: give one of both");
    if (!options.seen.empty()) {
        if (!options.verify) throw UsageError("--seen writes what --verify sees: add it");
        image_format(options.seen);
        check_output(options.seen, console);
    }
    const Renderer renderer = load_smooth_renderer(options.scene, console);
    const AnamorphRequest request = request_of(options, renderer, console);
    const Stopwatch watch;
    const Anamorph made = make_anamorph(renderer, request, console.progress("anamorph"));
    const double seconds = watch.seconds();
    console.note_stage(fmt::format("made {} x {} dots from {} exact places", made.page.width,
                                   made.page.height, made.exact_places),
                       watch);
    warn_of(made, options, console);
    write_page(options.output, made.page);

    Answer answer = name_output(options.output, console);
    answer.fields["dots"] = {made.page.width, made.page.height};
    answer.fields["paper_mm"] = {made.page.paper.width, made.page.paper.height};
    answer.fields["window"] = made.window;
    answer.fields["coverage"] = made.coverage;
    answer.fields["conflict"] = made.conflict;
    answer.fields["extents_mm"] = made.extents;
    answer.fields["exact_places"] = made.exact_places;
    answer.fields["worst_accepted_px"] = made.worst_accepted;
    answer.fields["seconds"] = seconds;
    if (!options.verify) return answer;
    const AnamorphCheck check = verify_anamorph(renderer, request, made, console.progress("verify"));
    if (!options.seen.empty()) write_image(options.seen, check.seen);
    answer.fields["psnr_db"] = json_number(check.psnr_db);
    answer.fields["compared_pixels"] = check.pixels;
    answer.text += fmt::format("\nseen in the mirror: {:.1f} dB against the picture over {} pixels",
                               check.psnr_db, check.pixels);
    return answer;
}

}  // namespace

Command anamorph_command() {
    auto options = std::make_shared<AnamorphOptions>();
    Command command{.name = "anamorph",
                    .summary = "a page to print, on which a mirror straightens a picture",
                    .schema = "anamorph"};
    command.options = joined(
        {scene_argument(options->scene),
         {{.names = "--picture",
           .target = &options->picture,
           .help = "what the mirror is to show",
           .value = "FILE",
           .offer = Offer::kImage,
           .is_required = true},
          {.names = "--page",
           .target = &options->page,
           .help = "the flat object that is printed",
           .value = "OBJECT",
           .is_required = true},
          {.names = "-o,--output",
           .target = &options->output,
           .help = "the page: .pdf, .svg or .png",
           .value = "FILE",
           .offer = Offer::kFile,
           .is_required = true},
          {.names = "--paper",
           .target = &options->paper,
           .help =
               "A0 to A6, letter, legal, tabloid or WxH in millimetres, centred on the page; default: the "
               "page's own size",
           .value = "SIZE"},
          {.names = "--orientation",
           .target = &options->orientation,
           .help = "of the paper; auto: as the page lies",
           .choices = {"auto", "portrait", "landscape"}},
          {.names = "--unit",
           .target = &options->unit,
           .help = "of the scene: mm, cm, dm, m, km, in or ft",
           .value = "UNIT"},
          {.names = "--dpi", .target = &options->dpi, .help = "dots per inch", .range = {1, 4800}},
          {.names = "--bleed",
           .target = &options->bleed,
           .help = "how far the picture's rim is drawn on beyond it, as 0.2cm; without a unit, millimetres",
           .value = "LENGTH"},
          {.names = "--window",
           .target = &options->window,
           .help = "where on the film the picture is to be seen",
           .value = "x0,y0,x1,y1"},
          {.names = "--fit",
           .target = &options->fit,
           .help = "the largest window that is whole; the default"},
          {.names = "--optic", .target = &options->optic, .help = "only this mirror", .value = "NAME"},
          {.names = "--tolerance",
           .target = &options->tolerance,
           .help = "film pixels that places between exact ones may be off",
           .range = {1e-9, 100}},
          {.names = "--verify",
           .target = &options->verify,
           .help = "ray trace the scene with the page in it, and say how near the picture is seen (PSNR)"},
          {.names = "--seen",
           .target = &options->seen,
           .help = "with --verify: the film that is seen",
           .value = "FILE",
           .offer = Offer::kImage}},
         scene_overrides_but_optic(options->scene)});
    command.body = [options](Console& console) { return run(*options, console); };
    return command;
}

}  // namespace trilens
