// trilens sweep engines: how the classic engine's picture comes near the exact one, and what its clipping
// leaves uncovered.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>

#include "base/error.h"
#include "cli/command.h"
#include "cli/scene_options.h"
#include "cli/views.h"
#include "sweep/files.h"
#include "sweep/plot.h"

namespace trilens {
namespace {

constexpr int kPieces[] = {1, 2, 4, 8, 16, 32};
constexpr int kResolutions[] = {1, 2, 5, 16};
constexpr double kMostTriangles = 2e7;  // a scene cut into more is left out

struct StudyOptions {
    SceneOptions scene;
    std::vector<std::string> scenes;
    std::string output;
};

/// What a pixel's centre shows, as triangles of World::objects.
struct Seen {
    Id direct = kNone, optic = kNone, reflect = kNone, refract = kNone;
};

struct StudyRow {
    std::string scene;
    std::string resolution;
    ClassicParams params;
    std::size_t pixels = 0, optic_pixels = 0;
    std::size_t differing = 0, direct = 0, reflect = 0, refract = 0;  // pixels
    std::size_t uncovered = 0;  // where the exact engine sees something that the classic one sees nothing for
    double exact_seconds = 0, classic_seconds = 0;

    double share() const {
        return static_cast<double>(differing) / static_cast<double>(std::max<std::size_t>(1, pixels));
    }
};

struct SeenPicture {
    std::vector<Seen> pixel;
    double seconds = 0;
};

/// What all pixels of the film show; preparing the scene is not in the time.
SeenPicture look(const World& world, std::size_t camera, const EngineChoice& engine, Console& console) {
    const Film& film = world.scene.film;
    const Viewer viewer = make_viewer(world, camera, engine, console.warner());
    const auto start = std::chrono::steady_clock::now();
    std::vector<SampleView> views(static_cast<std::size_t>(film.width) *
                                  static_cast<std::size_t>(film.height));
    viewer({0, 0, film.width, film.height, 1}, views);
    SeenPicture picture;
    picture.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const SampleView& view : views)
        picture.pixel.push_back(
            {view.hit.triangle, view.optic, view.reflect.hit.triangle, view.refract.hit.triangle});
    return picture;
}

std::string resolution_text(const World& world) {
    std::string text;
    for (const Optic& optic : world.optics)
        text += (text.empty() ? "" : " ") + std::to_string(optic.resolution);
    return text;
}

StudyRow compare(const SeenPicture& exact, const SeenPicture& classic) {
    StudyRow row;
    row.pixels = exact.pixel.size();
    row.exact_seconds = exact.seconds;
    row.classic_seconds = classic.seconds;
    for (std::size_t p = 0; p < row.pixels; ++p) {
        const Seen &a = exact.pixel[p], &b = classic.pixel[p];
        const bool direct = a.direct != b.direct, reflect = a.reflect != b.reflect,
                   refract = a.refract != b.refract;
        const auto lost = [](Id x, Id y) { return x != kNone && y == kNone; };
        row.optic_pixels += a.optic != kNone;
        row.direct += direct;
        row.reflect += reflect;
        row.refract += refract;
        row.differing += direct || reflect || refract;
        row.uncovered += lost(a.direct, b.direct) || lost(a.reflect, b.reflect) || lost(a.refract, b.refract);
    }
    return row;
}

std::string clip_name(Clip clip) {
    return clip == Clip::kScene ? "scene" : clip == Clip::kScreen ? "screen" : "none";
}

std::string curves_name(Curves curves) {
    return curves == Curves::kSlices       ? "slices"
           : curves == Curves::kTessellate ? "tessellate"
           : curves == Curves::kArcs       ? "arcs"
                                           : "straight";
}

bool has_pieces(const StudyRow& row) {
    return row.params.curves == Curves::kSlices || row.params.curves == Curves::kTessellate;
}

std::string table_csv(const std::vector<StudyRow>& rows) {
    std::string text =
        "scene,resolution,curves,pieces,clip,pixels,optic_pixels,differing,direct,reflect,refract,uncovered,"
        "differing_share,exact_seconds,classic_seconds\n";
    for (const StudyRow& row : rows) {
        char numbers[300];
        std::snprintf(numbers, sizeof numbers, "%zu,%zu,%zu,%zu,%zu,%zu,%zu,%.6g,%.4g,%.4g\n", row.pixels,
                      row.optic_pixels, row.differing, row.direct, row.reflect, row.refract, row.uncovered,
                      row.share(), row.exact_seconds, row.classic_seconds);
        text += row.scene + "," + row.resolution + "," + curves_name(row.params.curves) + "," +
                (has_pieces(row) ? std::to_string(row.params.pieces) : "") + "," +
                clip_name(row.params.clip) + "," + numbers;
    }
    return text;
}

std::string table_text(const std::vector<StudyRow>& rows) {
    char line[300];
    std::snprintf(line, sizeof line, "%-14s %4s  %-27s %8s %9s %10s %9s %9s\n", "scene", "n", "classic",
                  "pixels", "differing", "share", "uncovered", "seconds");
    std::string text = line;
    for (const StudyRow& row : rows) {
        std::snprintf(line, sizeof line, "%-14s %4s  %-27s %8zu %9zu %9.4f%% %9zu %9.3f\n", row.scene.c_str(),
                      row.resolution.c_str(), classic_name(row.params).c_str(), row.pixels, row.differing,
                      100 * row.share(), row.uncovered, row.classic_seconds);
        text += line;
    }
    return text;
}

/// Share of differing pixels over K, all rows together.
std::string share_plot(const std::string& title, const std::vector<StudyRow>& rows) {
    PlotParams params;
    params.title = "Classic against exact engine: " + title + ", n = " + rows.front().resolution;
    params.x_label = "K [parts of an edge; K × K triangles]";
    params.y_label = "pixels that differ [%]";
    const auto percent = [&](Curves curves, int pieces) {
        std::size_t differing = 0, pixels = 0;
        for (const StudyRow& row : rows) {
            if (row.params.curves != curves || (has_pieces(row) && row.params.pieces != pieces)) continue;
            differing += row.differing;
            pixels += row.pixels;
        }
        return 100.0 * static_cast<double>(differing) / static_cast<double>(std::max<std::size_t>(1, pixels));
    };
    std::vector<PlotSeries> series{{"slices", {}, std::nullopt}, {"tessellate", {}, std::nullopt}};
    for (const int k : kPieces) {
        series[0].points.push_back({k, percent(Curves::kSlices, k)});
        series[1].points.push_back({k, percent(Curves::kTessellate, k)});
    }
    series.push_back({"arcs, without any K", {}, std::nullopt});
    for (const int k : kPieces) series[2].points.push_back({k, percent(Curves::kArcs, 0)});
    return log_log_plot(params, series);
}

/// One scene of the study, drawn at whatever resolution its optics have.
struct Subject {
    std::string name;
    World& world;
    std::size_t camera = 0;
    Console& console;

    bool is_too_large(const ClassicParams& params) const {
        if (params.curves != Curves::kTessellate) return false;
        const double pieces = params.pieces;
        const double triangles = pieces * pieces * static_cast<double>(world.objects.size());
        if (triangles <= kMostTriangles) return false;
        char text[200];
        std::snprintf(text, sizeof text,
                      "%s, %s: left out, it would cut the scene into %.0f million triangles", name.c_str(),
                      classic_name(params).c_str(), 1e-6 * triangles);
        console.warn(text);
        return true;
    }

    std::vector<StudyRow> rows(const std::vector<ClassicParams>& ways) const {
        const SeenPicture exact = look(world, camera, Engine::kExact, console);
        const Progress progress = console.progress(name + " at n = " + resolution_text(world));
        std::vector<StudyRow> rows;
        for (const ClassicParams& params : ways) {
            if (progress.cancelled()) throw Interrupted();
            if (is_too_large(params)) continue;
            StudyRow row = compare(exact, look(world, camera, params, console));
            row.scene = name;
            row.resolution = resolution_text(world);
            row.params = params;
            rows.push_back(row);
            progress(static_cast<double>(rows.size()) / static_cast<double>(ways.size()));
        }
        return rows;
    }
};

std::vector<ClassicParams> ways_to_draw_curves() {
    std::vector<ClassicParams> ways{{}};
    for (const Curves curves : {Curves::kSlices, Curves::kTessellate})
        for (const int k : kPieces) ways.push_back({curves, Clip::kScene, k});
    return ways;
}

std::vector<ClassicParams> ways_to_clip() {
    std::vector<ClassicParams> ways;
    for (const Clip clip : {Clip::kScene, Clip::kScreen})
        for (const Curves curves : {Curves::kStraight, Curves::kTessellate, Curves::kSlices, Curves::kArcs})
            ways.push_back({curves, clip, 4});
    return ways;
}

Answer run(const StudyOptions& options, Console& console) {
    std::vector<StudyRow> curves, clipping,
        complete;  // complete: of the scenes that could be drawn in every way
    int complete_scenes = 0;
    make_folder(options.output + "/plots");
    for (const std::string& file : options.scenes) {
        SceneOptions scene = options.scene;
        scene.scene = file;
        const std::unique_ptr<World> world = load_world(scene, console);
        const Subject subject{std::filesystem::path(file).stem().string(), *world,
                              chosen_camera(scene, world->scene), console};
        const std::vector<StudyRow> rows = subject.rows(ways_to_draw_curves());
        curves.insert(curves.end(), rows.begin(), rows.end());
        if (rows.size() == ways_to_draw_curves().size()) {
            complete.insert(complete.end(), rows.begin(), rows.end());
            ++complete_scenes;
        }
        replace_text_file(options.output + "/plots/" + subject.name + ".svg", share_plot(subject.name, rows));
        for (const int n : kResolutions) {
            for (Optic& optic : world->optics) optic.resolution = n;
            for (const StudyRow& row : subject.rows(ways_to_clip())) clipping.push_back(row);
        }
        // After every scene, so that an interrupted study keeps what it has.
        replace_text_file(options.output + "/engines.csv", table_csv(curves));
        replace_text_file(options.output + "/clipping.csv", table_csv(clipping));
    }
    if (!complete.empty())
        replace_text_file(options.output + "/plots/engines.svg",
                          share_plot(std::to_string(complete_scenes) + " scenes", complete));
    Answer answer;
    answer.text = table_text(curves) + "\n" + table_text(clipping);
    for (const char* name : {"engines.csv", "clipping.csv", "plots/engines.svg"})
        answer.fields["files"].push_back(options.output + "/" + name);
    return answer;
}

}  // namespace

void register_sweep_engines(const CommandRegistry& registry, CLI::App& sweep) {
    auto options = std::make_shared<StudyOptions>();
    CLI::App* command =
        sweep.add_subcommand("engines", "the classic engine against the exact one: curves and clipping");
    command->add_option("SCENES", options->scenes, "scene files")->required();
    command->add_option("-o,--output", options->output, "folder for the tables and plots")
        ->required()
        ->type_name("DIR");
    options->scene.resolution = 2;
    command
        ->add_option("-n,--resolution", options->scene.resolution,
                     "resolution of the optics while K varies: coarse facets bend edges most")
        ->check(CLI::Range(1, 1024))
        ->capture_default_str()
        ->type_name("N");
    add_scene_overrides(*command, options->scene);
    registry.add(command, "sweep", [options](Console& console) { return run(*options, console); });
}

}  // namespace trilens
