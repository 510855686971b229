// trilens shoot: what rays meet, event by event.
#include <trilens/project.h>
#include <trilens/utilities.h>

#include <algorithm>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print/print.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

struct ShootOptions {
    SceneOptions scene;
    std::vector<std::string> pixel;
    std::string pixels, rays, path;
    bool events = false;
};

const LineForm kPlaceForm{2, "x,y", "film places"};
const LineForm kRayForm{6, "origin x,y,z and direction x,y,z", "rays"};

std::vector<double> numbers_of(const std::string& file, const LineForm& form) {
    return is_standard_stream(file) ? parse_numbers(standard_input(form.what + " are"), kStandardInput, form)
                                    : read_numbers(file, form);
}

std::vector<double> wanted_places(const ShootOptions& options) {
    if (!options.pixels.empty()) return numbers_of(options.pixels, kPlaceForm);
    std::vector<double> numbers;
    for (const std::string& text : options.pixel)
        for (const double number : parse_numbers(text, "--pixel", kPlaceForm)) numbers.push_back(number);
    return numbers;
}

ShotRays shoot(const Renderer& renderer, const ShootOptions& options, const ShootRequest& request) {
    if (options.rays.empty()) {
        const std::vector<double> at = wanted_places(options);
        std::vector<Vec2> places;
        for (std::size_t i = 0; i + 1 < at.size(); i += 2) places.emplace_back(at[i], at[i + 1]);
        return renderer.shoot(places, request);
    }
    const std::vector<double> at = numbers_of(options.rays, kRayForm);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i + 5 < at.size(); i += 6)
        rays.push_back({{at[i], at[i + 1], at[i + 2]}, {at[i + 3], at[i + 4], at[i + 5]}});
    return renderer.shoot(rays, request);
}

Answer run(const ShootOptions& options, Console& console) {
    console.files().reads({options.scene.scene, options.pixels, options.rays});
    if (!options.pixel.empty() + !options.pixels.empty() + !options.rays.empty() != 1)
        throw UsageError("shoot needs one of --pixel X,Y, --pixels FILE.csv and --rays FILE.csv");
    if (is_standard_stream(options.scene.scene) &&
        (is_standard_stream(options.pixels) || is_standard_stream(options.rays)))
        throw UsageError("the scene and the rays cannot both be standard input");
    ShootRequest request;
    if (!options.path.empty()) request.path = EventWord(options.path);
    const Renderer renderer = load_smooth_renderer(options.scene, console);
    request.camera = find_camera(renderer.scene(), options.scene.camera);
    const Stopwatch watch;
    const ShotRays shots = shoot(renderer, options, request);

    Answer answer;
    answer.fields["seconds"] = watch.seconds();
    const auto count_of = [&](ShotState state) {
        return std::count_if(shots.rays.begin(), shots.rays.end(),
                             [&](const ShotRay& ray) { return ray.state == state; });
    };
    for (const auto& [state, name] : EnumNames<ShotState>::kTable)
        answer.fields["counts"][name] = count_of(state);
    const auto cut =
        std::count_if(shots.rays.begin(), shots.rays.end(), [](const ShotRay& ray) { return ray.cut; });
    answer.fields["cut"] = cut;
    if (cut > 0)
        console.warn(
            fmt::format("{} of {} paths end where they would meet another optic: the scene's maxDepth "
                        "is {}",
                        cut, shots.rays.size(), renderer.scene().render.max_depth));
    if (console.wants_json()) answer.fields["rays"] = shots_json(renderer, shots);
    answer.text = options.events ? shot_events_text(renderer, shots) : shots_text(renderer, shots);
    console.note_stage(fmt::format("shot {} rays", shots.rays.size()), watch);
    return answer;
}

}  // namespace

Command shoot_command() {
    auto options = std::make_shared<ShootOptions>();
    Command command{
        .name = "shoot", .summary = "what the rays of film places meet, event by event", .schema = "shoot"};
    command.options =
        joined({scene_argument(options->scene),
                scene_overrides(options->scene),
                {{.names = "--pixel",
                  .target = &options->pixel,
                  .help = "a place of the film, a pixel's centre at .5; may be given several times",
                  .value = "X,Y"},
                 {.names = "--pixels",
                  .target = &options->pixels,
                  .help = "a file of x,y per line, or - for standard input; a header line is allowed",
                  .value = "FILE.csv",
                  .offer = Offer::kFile},
                 {.names = "--rays",
                  .target = &options->rays,
                  .help = "rays of one's own instead: a file of origin and direction per line, six numbers, "
                          "world frame",
                  .value = "FILE.csv",
                  .offer = Offer::kFile},
                 {.names = "--path",
                  .target = &options->path,
                  .help = "the events that each path must have: R reflected, T transmitted, ? either, or D: "
                          "seen directly; "
                          "without it the stronger way is taken where glass parts light",
                  .value = "WORD"},
                 {.names = "--events",
                  .target = &options->events,
                  .help = "text: a line for each meeting with an optic, instead of one for each ray"}}});
    command.body = [options](Console& console) { return run(*options, console); };
    return command;
}

}  // namespace trilens
