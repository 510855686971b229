#include "cli/options.h"

#include <trilens/error.h>
#include <trilens/utilities.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <iterator>

#include "terminal/libraries.h"

namespace trilens {

namespace {

std::vector<SceneOverride> file_overrides(const SceneOptions& options) {
    std::vector<SceneOverride> overrides;
    for (const std::string& text : options.set) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || text.empty() || text[0] != '/')
            throw UsageError("--set needs /json/pointer=VALUE, not \"" + text + "\"");
        overrides.push_back({text.substr(0, equals), text.substr(equals + 1)});
    }

    // Options that have a place in the file are overrides too, so that the resolved scene holds them.
    if (!options.size.empty()) {
        const std::vector<int> size = parse_integers(options.size, 'x', 2, "--size");
        const auto [least, most] = std::minmax(size[0], size[1]);
        if (least < 1 || most > kMostFilmSide || 1LL * least * most > kMostPixels)
            throw UsageError(fmt::format("--size {} is no film: 1 to {} a side, at most {} pixels",
                                         options.size, kMostFilmSide, kMostPixels));
        overrides.push_back({"/film/width", std::to_string(size[0])});
        overrides.push_back({"/film/height", std::to_string(size[1])});
    }
    if (options.spp > 0) overrides.push_back({"/film/spp", std::to_string(options.spp)});
    if (!options.filter.empty()) overrides.push_back({"/film/filter", '"' + options.filter + '"'});
    if (options.max_depth >= 0) overrides.push_back({"/render/maxDepth", std::to_string(options.max_depth)});
    return overrides;
}

/// What -n says.
struct Resolutions {
    int of_all = 0;  // 0: as the scene says
    std::vector<std::pair<std::string, int>> of_optic;
};

Resolutions resolutions_of(const std::vector<std::string>& texts) {
    Resolutions resolutions;
    std::size_t of_all = 0;
    for (const std::string& text : texts) {
        const std::size_t equals = text.rfind('=');
        const std::string number = equals == std::string::npos ? text : text.substr(equals + 1);
        int n = 0;
        const auto [stop, error] = std::from_chars(number.data(), number.data() + number.size(), n);
        if (error != std::errc() || stop != number.data() + number.size() || n < 1 || n > kMaxResolution)
            throw UsageError(fmt::format(
                "-n/--resolution takes an integer from 1 to {}, or NAME=N for one optic, not \"{}\"",
                kMaxResolution, text));
        if (equals == std::string::npos) {
            resolutions.of_all = n;
            ++of_all;
        } else {
            resolutions.of_optic.emplace_back(text.substr(0, equals), n);
        }
    }
    if (of_all > 1)
        throw UsageError(
            fmt::format("-n/--resolution takes one value for every optic and is given {} times", of_all));
    return resolutions;
}

double seconds_of(const std::string& text) {
    double seconds = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
    if (error != std::errc() || stop != text.data() + text.size() || !(std::abs(seconds) <= 1e9))
        throw UsageError("--time takes seconds, not \"" + text + "\"");
    return seconds;
}

/// OpenEXR's first four bytes.
bool is_exr(const std::string& bytes) {
    return bytes.rfind("\x76\x2f\x31\x01", 0) == 0;
}

}  // namespace

std::string standard_input(const std::string& expected) {
    std::string text{std::istreambuf_iterator<char>(std::cin), std::istreambuf_iterator<char>()};
    if (std::cin.bad()) throw InputError(kStandardInput, "", "cannot be read");
    if (text.empty()) throw InputError(kStandardInput, "", "is empty; " + expected + " expected there");
    return text;
}

namespace {

Scene read_standard_input(const SceneRequest& request) {
    const std::string text = standard_input("a scene is");
    if (is_exr(text)) throw InputError(kStandardInput, "", "is an image; name its file instead of -");
    Scene scene = parse_scene(text, "", request.overrides, kStandardInput, request.import);
    if (request.resolution != 0) set_resolution(scene, request.resolution);
    return scene;
}

std::string scene_note(const SceneOptions& options, const Scene& scene) {
    const SceneInfo found = make_scene_info(scene);
    return fmt::format(
        "read {}: {} optics, {} objects with {} triangles, {} lights, {} cameras, film {} x {}, {} samples",
        is_standard_stream(options.scene) ? kStandardInput : options.scene, found.optics, found.objects,
        found.triangles, found.lights, found.cameras.size(), scene.film.width, scene.film.height,
        scene.film.spp * scene.film.spp);
}

}  // namespace

std::vector<Option> scene_argument(SceneOptions& options) {
    return {
        {.names = "SCENE",
         .target = &options.scene,
         .help =
             "scene file (JSON), a glTF (.gltf, .glb), a calibrated camera behind its port (Calibmar's "
             "calibration.yaml, COLMAP's cameras.txt), an image that carries its scene, or - for standard "
             "input",
         .offer = Offer::kScene,
         .is_required = true},
        {.names = "-n,--resolution",
         .target = &options.resolution,
         .help = "N x N facets per quad face of every optic; NAME=N: of that one; may be given several times",
         .value = "N",
         .check = [](const std::vector<std::string>& texts) { resolutions_of(texts); }}};
}

namespace {

std::vector<Option> json_overrides(SceneOptions& options) {
    return {{.names = "--size", .target = &options.size, .help = "film size in pixels", .value = "WxH"},
            {.names = "--spp",
             .target = &options.spp,
             .help = "S x S samples per pixel",
             .value = "S",
             .range = {1, kMaxSpp}},
            {.names = "--filter",
             .target = &options.filter,
             .help = "how samples make a pixel's colour; other than box also from pixels around",
             .choices = names_of<FilterKind>()},
            {.names = "--camera",
             .target = &options.camera,
             .help = "camera by name; default: the first",
             .value = "NAME"},
            {.names = "--max-depth",
             .target = &options.max_depth,
             .help = "optic hits after the first",
             .range = {0, kMostDepth}},
            {.names = "--set",
             .target = &options.set,
             .help = "replace a value of the scene; may be given several times",
             .value = "/json/pointer=VALUE"}};
}

std::vector<Option> gltf_optics(SceneOptions& options) {
    return {{.names = "--optic",
             .target = &options.optics,
             .help =
                 "of a glTF: its meshes, nodes or materials of such a name are optics; may be given several "
                 "times",
             .value = "PATTERN"}};
}

std::vector<Option> gltf_moment(SceneOptions& options) {
    return {{.names = "--time",
             .target = &options.time,
             .help = "of a glTF: its meshes, cameras and lights as its animation has them then",
             .value = "SECONDS",
             .check = [](const std::vector<std::string>& texts) { seconds_of(texts.back()); }},
            {.names = "--animation",
             .target = &options.animation,
             .help = "of a glTF: which animation; default: the first",
             .value = "NAME"}};
}

}  // namespace

std::vector<Option> scene_overrides(SceneOptions& options) {
    return joined({json_overrides(options), gltf_optics(options), gltf_moment(options)});
}

std::vector<Option> scene_overrides_but_optic(SceneOptions& options) {
    return joined({json_overrides(options), gltf_moment(options)});
}

std::vector<Option> window_options(SceneOptions& options) {
    return {
        {.names = "--crop",
         .target = &options.crop,
         .help = "draw this window of pixels only",
         .value = "x0,y0,x1,y1"},
        {.names = "--aov",
         .target = &options.aov,
         .help =
             "layers beside RGBA: all, or a list of Z,optic,direct,reflect,refract,path,stat,magnification,"
             "position,ray,bound,coverage; without it, all but the last seven",
         .value = "LIST"}};
}

SceneRequest scene_request(const SceneOptions& options) {
    SceneRequest request{
        options.scene, file_overrides(options), resolutions_of(options.resolution).of_all, {}};
    request.import.optics = options.optics;
    if (!options.time.empty()) request.import.time = seconds_of(options.time);
    request.import.animation = options.animation;
    return request;
}

Scene load_scene(const SceneOptions& options, Console& console) {
    console.files().reads({options.scene});
    const Stopwatch watch;
    SceneRequest request = scene_request(options);
    request.progress = console.progress("reading the scene");
    stop_at_once(true);  // nothing is written yet
    Scene scene = is_standard_stream(options.scene) ? read_standard_input(request) : load_scene(request);
    for (const auto& [optic, n] : resolutions_of(options.resolution).of_optic)
        set_resolution(scene, n, optic);
    for (const FileRead& file : scene.files) console.files().reads({file.path});
    for (const std::string& warning : scene.warnings) console.warn(warning);
    console.note_stage(scene_note(options, scene), watch);
    return scene;
}

Renderer load_renderer(const SceneOptions& options, Console& console) {
    Scene scene = load_scene(options, console);
    const Stopwatch watch;
    Renderer renderer(std::move(scene), console.warner());
    console.note_stage(fmt::format("made surfaces and trees: {} facets, {} triangles", renderer.facet_count(),
                                   renderer.triangle_count()),
                       watch);
    return renderer;
}

void warn_of_roughness(const Scene& scene, Console& console) {
    for (const Mesh& mesh : scene.meshes)
        if (mesh.role == Role::kOptic && scene.materials[mesh.material].roughness_factor > 0)
            console.warn(mesh.name +
                         " is rough, and answers are those of a smooth optic: where the middle of what it "
                         "shows of a ray lies");
}

Renderer load_smooth_renderer(const SceneOptions& options, Console& console) {
    Renderer renderer = load_renderer(options, console);
    warn_of_roughness(renderer.scene(), console);
    return renderer;
}

LayerRequest layer_request(const SceneOptions& options) {
    LayerRequest request;
    if (!options.crop.empty()) {
        const std::vector<int> window = parse_integers(options.crop, ',', 4, "--crop");
        if (window == std::vector<int>(4, 0))
            throw UsageError("--crop " + options.crop + " is no window of the film");
        request = {window[0], window[1], window[2], window[3], {}};
    }
    if (options.aov.empty()) return request;
    if (options.aov == "all") {
        request.layers = layer_names();
        return request;
    }
    std::size_t from = 0;
    while (from <= options.aov.size()) {
        const std::size_t comma = std::min(options.aov.find(',', from), options.aov.size());
        request.layers.push_back(options.aov.substr(from, comma - from));
        from = comma + 1;
    }
    return request;
}

SweepObserver sweep_talk(Console& console) {
    return {[&console](const std::string& job) { return console.progress(job); }, console.warner()};
}

std::vector<Option> direction_options(DirectionOptions& options) {
    return {{.names = "--center",
             .target = &options.center,
             .help = "where directions start: optic (the middle of the optics) or a point",
             .value = "X,Y,Z"},
            {.names = "--proxy",
             .target = &options.proxy,
             .help = "how far what a direction shows is: scene (its objects), infinity, sphere:R, "
                     "box:x0,y0,z0,x1,y1,z1, or a mesh.obj",
             .value = "PROXY"},
            {.names = "--optic", .target = &options.optic, .help = "only over this optic", .value = "NAME"},
            {.names = "--path",
             .target = &options.path,
             .help = "how light comes from the optic; default: reflect by mirrors, refract by glass",
             .choices = {"reflect", "refract", "direct"}}};
}

std::optional<std::size_t> optic_named(const Renderer& renderer, const std::string& name) {
    if (name.empty()) return std::nullopt;
    const std::vector<OpticInfo> optics = renderer.optics();
    std::vector<std::string> names;
    for (std::size_t o = 0; o < optics.size(); ++o) {
        if (optics[o].name == name) return o;
        names.push_back(optics[o].name);
    }
    throw UsageError("there is no optic \"" + name + "\"" + suggestion(name, names));
}

std::optional<Vec3> center_given(const std::string& text) {
    if (text == "optic") return std::nullopt;
    const std::optional<Vec3> point = parse_point(text);
    if (!point) throw UsageError("--center is \"optic\" or X,Y,Z, not \"" + text + "\"");
    return point;
}

std::optional<Path> path_given(const std::string& text) {
    if (text.empty()) return std::nullopt;
    return text == "direct" ? Path::kDirect : text == "refract" ? Path::kRefract : Path::kReflect;
}

TargetRequest target_request(const Renderer& renderer, const DirectionOptions& options, const std::string& to,
                             double tolerance) {
    TargetRequest request;
    request.target = parse_target(to, renderer.scene());
    request.proxy = parse_proxy(options.proxy);
    request.center = center_given(options.center);
    request.optic = optic_named(renderer, options.optic);
    request.path = path_given(options.path);
    request.tolerance = tolerance;
    return request;
}

}  // namespace trilens
