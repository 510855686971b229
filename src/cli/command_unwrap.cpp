// trilens unwrap: photographs of mirrors into panoramas, cube maps, planes and textures.
#include <trilens/maps.h>
#include <trilens/utilities.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <sstream>
#include <utility>

#include "cli/commands.h"
#include "cli/options.h"
#include "cli/print/print.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

struct UnwrapOptions {
    SceneOptions scene;
    std::vector<std::string> photos, masks, exposures;
    DirectionOptions direction;
    std::string to, images = "best", output;
    double white = 0, min_resolution = 0, tolerance = UnwrapRequest().tolerance;
    bool keep_weight = false;
};

/// "FILE" or "CAMERA=FILE": the camera by name, else the scene's in their order.
UnwrapPhoto photo_from(const std::string& text, std::size_t index, const UnwrapOptions& options,
                       const Renderer& renderer, Console& console) {
    const Scene& scene = renderer.scene();
    const std::size_t equals = text.find('=');
    std::string file = text;
    std::size_t camera = options.photos.size() == 1 ? find_camera(scene, options.scene.camera) : index;
    if (equals != std::string::npos) {
        camera = find_camera(scene, text.substr(0, equals));
        file = text.substr(equals + 1);
    }
    if (camera >= scene.cameras.size())
        throw UsageError(fmt::format("photograph {} has no camera: the scene has {}; CAMERA=FILE names one",
                                     index + 1, scene.cameras.size()));
    console.files().reads({file});
    UnwrapPhoto photo = read_photo(file);
    if (!photo.picture->alpha.empty() && !photo.picture->is_premultiplied)
        console.warn(file + ": its alpha is not looked at; --mask says where a photograph is not to be used");
    photo.camera = camera;
    if (index < options.masks.size()) {
        console.files().reads({options.masks[index]});
        photo.mask = read_photo(options.masks[index]).picture;
    }
    if (index < options.exposures.size()) {
        std::istringstream number(options.exposures[index]);
        if (!(number >> photo.exposure) || !number.eof() || !(photo.exposure > 0))
            throw UsageError("--exposure is a positive number, not \"" + options.exposures[index] + "\"");
    }
    photo.white = options.white;
    return photo;
}

UnwrapRequest request_of(const UnwrapOptions& options, const Renderer& renderer) {
    UnwrapRequest request{target_request(renderer, options.direction, options.to, options.tolerance)};
    if (options.images == "blend") {
        request.images = UnwrapImages::kBlend;
    } else if (options.images != "best") {
        request.rank = parse_integers(options.images, ',', 1, "--images")[0];
    }
    request.min_resolution = options.min_resolution;
    request.divide_weight = !options.keep_weight;
    return request;
}

Answer run(const UnwrapOptions& options, Console& console) {
    console.files().reads({options.scene.scene});
    check_output(options.output, console);
    if (!is_standard_stream(options.output)) image_format(options.output);
    if (std::max(options.masks.size(), options.exposures.size()) > options.photos.size())
        throw UsageError("there are more masks or exposures than photographs");
    const Renderer renderer = load_smooth_renderer(options.scene, console);
    const UnwrapRequest request = request_of(options, renderer);
    std::vector<UnwrapPhoto> photos;
    for (std::size_t i = 0; i < options.photos.size(); ++i)
        photos.push_back(photo_from(options.photos[i], i, options, renderer, console));

    const Stopwatch watch;
    const Unwrapped made = unwrap(renderer, request, photos, console.progress("unwrap"));
    const double seconds = watch.seconds();
    console.note_stage(
        fmt::format("unwrapped {} photographs: {} exact places", photos.size(), made.exact_places), watch);
    const ImageFormat format =
        is_standard_stream(options.output) ? ImageFormat::kExr : image_format(options.output);
    Answer answer = write_output(options.output, made.image, {format, {}}, console);
    answer.fields["width"] = request.target.width;
    answer.fields["height"] = request.target.height;
    answer.fields["coverage"] = made.coverage;
    answer.fields["resolution_median"] = made.resolution_median;
    answer.fields["exact_places"] = made.exact_places;
    answer.fields["worst_accepted_px"] = made.worst_accepted;
    answer.fields["seconds"] = seconds;
    console.note(fmt::format("{:.1f} % of the target are seen, in the median at {:.3g} pixels per {}",
                             100 * made.coverage, made.resolution_median,
                             has_directions(request.target.kind) ? "degree" : "unit"));
    return answer;
}

}  // namespace

Command unwrap_command() {
    auto options = std::make_shared<UnwrapOptions>();
    Command command{.name = "unwrap",
                    .summary = "photographs of mirrors into panoramas, cube maps, planes and textures",
                    .schema = "unwrap"};
    command.options = joined(
        {scene_argument(options->scene),
         {{.names = "PHOTO",
           .target = &options->photos,
           .help = "a picture of the film's size, or CAMERA=FILE; several: by the scene's cameras in order",
           .offer = Offer::kImage,
           .is_required = true},
          {.names = "--to",
           .target = &options->to,
           .help = "equirect:WxH, cubemap:N, fisheye:N[:DEGREES], plane:ox,oy,oz,ux,uy,uz,vx,vy,vz,WxH "
                   "(lower left corner, side to "
                   "the right, side upward), or an object as NAME or NAME:WxH",
           .value = "TARGET",
           .is_required = true},
          {.names = "-o,--output",
           .target = &options->output,
           .help = "the picture: .exr (with resolution and source places) or .png",
           .value = "FILE",
           .offer = Offer::kImage,
           .is_required = true},
          {.names = "--images",
           .target = &options->images,
           .help = "of several images: best (resolved), blend, or the N-th best",
           .value = "best|blend|N"},
          {.names = "--min-resolution",
           .target = &options->min_resolution,
           .help = "leave out what the photograph resolves worse, in its pixels per degree or unit",
           .range = {0, std::numeric_limits<double>::infinity()}},
          {.names = "--mask",
           .target = &options->masks,
           .help = "of each photograph: where it is dark nothing is taken",
           .value = "FILE",
           .offer = Offer::kImage},
          {.names = "--exposure",
           .target = &options->exposures,
           .help = "of each photograph: what its values are divided by; longer ones are taken first",
           .value = "E"},
          {.names = "--white",
           .target = &options->white,
           .help =
               "photographs' values from here on are clipped, and taken only where nothing else is; 0: none",
           .range = {0, std::numeric_limits<double>::infinity()}},
          {.names = "--tolerance",
           .target = &options->tolerance,
           .help = "pixels of the photograph that places between exact ones may be off",
           .range = {1e-9, 100}},
          {.names = "--keep-weight",
           .target = &options->keep_weight,
           .help = "do not divide by what mirrors and glass leave of the light"}},
         direction_options(options->direction),
         scene_overrides_but_optic(options->scene)});
    command.body = [options](Console& console) { return run(*options, console); };
    return command;
}

}  // namespace trilens
