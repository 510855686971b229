#include "cli/options.h"

#include <algorithm>
#include <filesystem>

namespace trilens {
namespace {

std::string scene_name(const std::string& file) {
    return std::filesystem::path(file).stem().string();
}

/// The folder of one of the scenes: the sweep's own, or one below it where there are several.
std::string folder_of(const SweepOptions& options, const std::string& scene) {
    return options.scenes.size() <= 1 ? options.output : options.output + "/" + scene_name(scene);
}

std::string axis_names() {
    std::string names;
    for (const AxisKind& kind : axis_kinds()) names += (names.empty() ? "" : ", ") + kind.name;
    return names;
}

}  // namespace

std::vector<std::string> command_words(const SweepOptions& options, const std::string& scene) {
    std::vector<std::string> words = {"trilens", "sweep", "run"};
    const auto add = [&](const char* name, const std::string& value) {
        words.insert(words.end(), {name, value});
    };
    if (!scene.empty()) words.push_back(scene);
    for (const std::string& over : options.over) add("--over", over);
    if (options.zip) words.push_back("--zip");
    if (!options.truth.empty() && options.truth != "limit") add("--truth", options.truth);
    if (options.repeats > 0) add("--repeat", std::to_string(options.repeats));
    if (!options.scene.camera.empty()) add("--camera", options.scene.camera);
    if (!options.scene.size.empty()) add("--size", options.scene.size);
    if (options.scene.spp > 0) add("--spp", std::to_string(options.scene.spp));
    if (!options.scene.filter.empty()) add("--filter", options.scene.filter);
    if (options.scene.max_depth >= 0) add("--max-depth", std::to_string(options.scene.max_depth));
    for (const std::string& set : options.scene.set) add("--set", set);
    add("-o", folder_of(options, scene));
    return words;
}

namespace {

std::string command_line(const SweepOptions& options, const std::string& scene) {
    std::string line;
    for (const std::string& word : command_words(options, scene))
        line += (line.empty() ? "" : " ") + shell_quoted(word);
    return line;
}

SweepRequest sweep_request(const SweepOptions& options, const std::string& scene) {
    SceneOptions one = options.scene;
    one.scene = scene;
    SweepRequest request;
    request.scene = scene_request(one);
    request.camera = options.scene.camera;
    if (!options.over.empty()) request.over.clear();
    for (const std::string& over : options.over) request.over.push_back(parse_over(over));
    request.zip = options.zip;
    if (!options.truth.empty()) request.truth = options.truth;
    request.shard = options.shard;
    request.jobs = options.jobs;
    request.repeats = std::max(1, options.repeats);
    request.memory_limit = options.memory * (1 << 20);
    request.folder = folder_of(options, scene);
    request.replace = options.replace;
    request.command = command_line(options, scene);
    return request;
}

/// A sweep file says for itself what scenes and axes there are.
SweepRequest request_of_file(const SweepOptions& options, const std::string& file) {
    if (!options.over.empty() || options.zip || !options.truth.empty())
        throw UsageError(file + " is a sweep file: it says itself what --over, --zip and --truth say");
    SweepRequest request = sweep_request(options, file);
    request.scene.file.clear();
    return read_sweep_file(file, std::move(request));
}

}  // namespace

std::vector<SweepRequest> sweep_requests(const SweepOptions& options) {
    require_distinct_names(options.scenes);
    const bool has_file = std::ranges::any_of(options.scenes, is_sweep_file);
    if (has_file && options.scenes.size() > 1)
        throw UsageError("a sweep file stands alone: it names its scenes");
    const bool has_scene_axis = std::ranges::any_of(
        options.over, [](const std::string& over) { return over.rfind("scene=", 0) == 0; });
    if (options.scenes.empty() != has_scene_axis)
        throw UsageError(has_scene_axis ? "scenes are named by --over scene=... and beside it"
                                        : "a sweep needs scenes, a sweep file, or --over scene=A,B");
    if (has_file) return {request_of_file(options, options.scenes[0])};
    if (has_scene_axis) return {sweep_request(options, "")};
    std::vector<SweepRequest> requests;
    for (const std::string& scene : options.scenes) requests.push_back(sweep_request(options, scene));
    return requests;
}

std::vector<Option> sweep_options(SweepOptions& options) {
    return joined(
        {{{.names = "SCENES",
           .target = &options.scenes,
           .help = "scene files, several make a gallery; or one sweep file; none with --over scene=A,B",
           .offer = Offer::kScene},
          {.names = "-o,--output",
           .target = &options.output,
           .help = "folder for the results",
           .value = "DIR",
           .offer = Offer::kFolder,
           .is_required = true},
          {.names = "--over",
           .target = &options.over,
           .help = "what is varied, every combination where given several times: " + axis_names() +
                   ", or a /json/pointer of the scene; values: 1,2,4 or 1..64:x2 or 8..32:+8; default: "
                   "resolution=1..16:x2",
           .value = "AXIS=VALUES"},
          {.names = "--zip",
           .target = &options.zip,
           .help = "take the axes' values pair by pair, not in every combination"},
          {.names = "--truth",
           .target = &options.truth,
           .help = "what runs are compared with: the exact surface or the same facets, ray traced",
           .choices = {"limit", "facets"}},
          {.names = "--shard",
           .target = &options.shard,
           .help = "do part i of n only: i/n, or auto in a job array",
           .value = "i/n"},
          {.names = "-j,--jobs",
           .target = &options.jobs,
           .help = "runs at once, as far as memory allows; times are then no measurements",
           .range = {1, 1024}},
          {.names = "--repeat",
           .target = &options.repeats,
           .help = "draw each picture R times after one that is not counted: median and spread of its time",
           .value = "R",
           .range = {1, 1000}},
          {.names = "--memory",
           .target = &options.memory,
           .help = "MiB that the runs at work may need together; default: most of what is free",
           .value = "MIB",
           .range = {0, 1e9}},
          {.names = "--replace",
           .target = &options.replace,
           .help =
               "start the folder afresh, whatever sweep it holds (else another sweep's is refused); files "
               "that no sweep wrote stay"}},
         scene_overrides(options.scene)});
}

}  // namespace trilens
