// trilens fit: parameters of a scene from pairs of pixels and world points.
#include <trilens/fit.h>
#include <trilens/utilities.h>

#include <charconv>
#include <cmath>
#include <filesystem>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print/print.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

struct CalibrationOptions {
    SceneOptions scene;
    std::string points, output, report, path;
    std::vector<std::string> free, prior;
    std::string loss = "huber:8", match = "ray";
    double sigma = 0.5;
};

double number_of(const std::string& text, const std::string& what) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        throw UsageError(what + " needs a number, not \"" + text + "\"");
    return value;
}

double huber_of(const std::string& loss) {
    if (loss == "none") return std::numeric_limits<double>::infinity();
    if (!loss.starts_with("huber:")) throw UsageError("--loss is none or huber:SIGMAS, not \"" + loss + "\"");
    const double threshold = number_of(loss.substr(6), "--loss huber:");
    if (!(threshold > 0)) throw UsageError("--loss huber: needs a number above 0, not " + loss.substr(6));
    return threshold;
}

/// POINTER=VALUE+-SIGMA, with VALUE a number or [a,b,c].
PriorValue prior_of(const std::string& text) {
    const std::size_t equals = text.find('='), spread = text.find("+-");
    if (equals == std::string::npos || spread == std::string::npos || spread < equals)
        throw UsageError("--prior needs POINTER=VALUE+-SIGMA, not \"" + text + "\"");
    PriorValue prior;
    prior.pointer = text.substr(0, equals);
    std::string values = text.substr(equals + 1, spread - equals - 1);
    if (values.size() > 1 && values.front() == '[' && values.back() == ']')
        values = values.substr(1, values.size() - 2);
    for (std::size_t from = 0; from <= values.size();) {
        const std::size_t comma = std::min(values.find(',', from), values.size());
        prior.values.push_back(number_of(values.substr(from, comma - from), "--prior"));
        from = comma + 1;
    }
    prior.sigma = number_of(text.substr(spread + 2), "--prior's SIGMA");
    return prior;
}

/// Pointers, of which one option may give several with commas between them.
std::vector<std::string> pointers_of(const std::vector<std::string>& given) {
    std::vector<std::string> pointers;
    for (const std::string& text : given)
        for (std::size_t from = 0; from <= text.size();) {
            const std::size_t comma = std::min(text.find(",/", from), text.size());
            pointers.push_back(text.substr(from, comma - from));
            from = comma + 1;
        }
    return pointers;
}

/// The fitted scene as a file that lies where the output does.
std::string document_for(const std::string& output, const Scene& scene, const FitResult& result) {
    const std::string folder =
        is_standard_stream(output) ? scene.folder : std::filesystem::absolute(output).parent_path().string();
    return scene_document(parse_scene(result.document, scene.folder, {}, "fitted"), folder);
}

Answer run(const CalibrationOptions& options, Console& console) {
    FitRequest request;
    request.free = pointers_of(options.free);
    for (const std::string& prior : options.prior) request.priors.push_back(prior_of(prior));
    request.path = options.path;
    request.match = options.match == "ray"       ? FitMatch::kRay
                    : options.match == "nearest" ? FitMatch::kNearest
                                                 : FitMatch::kId;
    request.huber = huber_of(options.loss);
    request.sigma = options.sigma;
    console.files().reads({options.scene.scene, options.points});
    const Scene scene = load_scene(options.scene, console);
    warn_of_roughness(scene, console);
    const std::vector<Correspondence> pairs =
        is_standard_stream(options.points)
            ? parse_correspondences(standard_input("pairs are"), kStandardInput)
            : read_correspondences(options.points);
    check_scene_output(options.output, console);
    if (!options.report.empty()) check_output(options.report, console);

    const Stopwatch watch;
    const FitResult result = fit_scene(scene, pairs, request, console.progress("fit"));
    const double seconds = watch.seconds();
    console.note_stage(fmt::format("fitted {} parameters", result.parameters.size()), watch);
    for (const std::string& warning : result.warnings) console.warn(warning);
    if (!options.report.empty()) replace_text_file(options.report, fit_html(scene, pairs, result));
    Answer answer = fit_answer(result, pairs);
    answer.fields["seconds"] = seconds;
    if (!result.undetermined.empty()) {
        std::string motions;
        for (const std::string& motion : result.undetermined)
            motions += (motions.empty() ? "" : "; ") + motion;
        const std::string message = "the pairs do not tell of " + motions +
                                    ": hold it fixed, or give it a --prior; nothing is written to " +
                                    options.output;
        console.error(message);
        answer.errors.push_back(message);
        answer.code = ExitCode::kComputation;
        return answer;
    }
    if (!result.converged)
        console.warn(
            "the fit has not come to rest: it took all its iterations, or no step finds what its derivatives "
            "promise");
    write_output(options.output, document_for(options.output, scene, result), console);
    answer.fields["output"] = options.output;
    return answer;
}

}  // namespace

Command fit_command() {
    auto options = std::make_shared<CalibrationOptions>();
    Command command{.name = "fit",
                    .summary = "parameters of mirrors, glass and cameras from pairs of pixels and points",
                    .schema = "fit"};
    command.options = joined(
        {scene_argument(options->scene),
         scene_overrides(options->scene),
         {{.names = "--points",
           .target = &options->points,
           .help = "pairs, a line each: x,y,X,Y,Z (pixel, world point); a header may name the columns, and "
                   "sigma, camera, path, image beside them",
           .value = "PAIRS.csv",
           .offer = Offer::kFile,
           .is_required = true},
          {.names = "--free",
           .target = &options->free,
           .help =
               "what is unknown: JSON pointers of numbers or of arrays of numbers; several times, or with "
               "commas",
           .value = "POINTER",
           .is_required = true},
          {.names = "-o,--output",
           .target = &options->output,
           .help = "the scene with what was found",
           .value = "FITTED.json",
           .offer = Offer::kFile,
           .is_required = true},
          {.names = "--prior",
           .target = &options->prior,
           .help = "holds a free number near a value: POINTER=VALUE+-SIGMA",
           .value = "PRIOR"},
          {.names = "--loss",
           .target = &options->loss,
           .help = "huber:SIGMAS, standard deviations from which a residual counts linearly, or none",
           .value = "LOSS"},
          {.names = "--path",
           .target = &options->path,
           .help = "what happens at the optics that a ray meets: R reflected, T transmitted, ? either; D: "
                   "seen directly. Else mirrors reflect and glass transmits",
           .value = "WORD"},
          {.names = "--match",
           .target = &options->match,
           .help = "ray: follow the pixel's ray, which needs no image; nearest: the point's image nearest to "
                   "the pixel; id: the image that the column `image` names",
           .choices = {"ray", "nearest", "id"}},
          {.names = "--sigma",
           .target = &options->sigma,
           .help = "standard deviation of the pixels, of pairs without their own",
           .range = {1e-6, 1e6}},
          {.names = "--report",
           .target = &options->report,
           .help = "a page with parameters, correlations and residuals",
           .value = "FILE.html",
           .offer = Offer::kFile}}});
    command.body = [options](Console& console) { return run(*options, console); };
    return command;
}

}  // namespace trilens
