// How the classic engine's picture comes near the exact one over K, and what its ways to clip leave
// uncovered. Use: bench_engine_study SCENE... -o FOLDER [-n N] [--camera NAME]; writes engines.csv,
// clipping.csv and plots/*.svg.

#include <algorithm>
#include <filesystem>

#include <CLI/CLI.hpp>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "render/engines/engine.h"
#include "report/plot.h"
#include "trilens/render.h"
#include "trilens/scene.h"

namespace {

using namespace trilens;

/// One way to draw one scene, compared with the exact engine pixel by pixel.
struct StudyRow {
    std::string scene;
    std::string resolution;  // of each optic, separated by blanks
    ClassicParams params;
    std::size_t pixels = 0, optic_pixels = 0;
    std::size_t differing = 0, direct = 0, reflect = 0, refract = 0;  // pixels
    std::size_t uncovered = 0;  // where the exact engine sees something that the classic one sees nothing for
    double exact_seconds = 0, classic_seconds = 0;

    double share() const {
        return pixels > 0 ? static_cast<double>(differing) / static_cast<double>(pixels) : 0;
    }
};

constexpr int kPieces[] = {1, 2, 4, 8, 16, 32};
constexpr int kResolutions[] = {1, 2, 5, 16};
constexpr double kMostTriangles = 2e7;  // a scene cut into more is left out

/// What a pixel's centre shows, as triangles of World::objects.
struct Seen {
    Id direct = kNone, optic = kNone, reflect = kNone, refract = kNone;
};

struct SeenPicture {
    std::vector<Seen> pixel;
    double seconds = 0;
};

/// What all pixels of the film show; preparing the scene is not in the time.
SeenPicture look(const World& world, const FrameParams& frame, const EngineChoice& engine) {
    const Film& film = world.scene.film;
    const std::unique_ptr<Viewer> viewer = make_viewer(world, frame, engine, Warn());
    const Stopwatch watch;
    SampleViews views;
    viewer->view({0, 0, film.width, film.height, 1}, views);
    SeenPicture picture;
    picture.seconds = watch.seconds();
    for (const SampleView& view : views.samples)
        picture.pixel.push_back({view.hit.triangle, view.optic, views.hit(view, Path::kReflect).triangle,
                                 views.hit(view, Path::kRefract).triangle});
    return picture;
}

std::string resolution_text(const World& world, int resolution) {
    std::string text;
    for (const Optic& optic : world.optics)
        text += (text.empty() ? "" : " ") + std::to_string(grid_resolution(optic, resolution));
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

bool has_pieces(const StudyRow& row) {
    return row.params.curves == Curves::kSlices || row.params.curves == Curves::kTessellate;
}

std::string table_csv(const std::vector<StudyRow>& rows) {
    std::string text =
        "scene,resolution,curves,pieces,clip,pixels,optic_pixels,differing,direct,reflect,refract,uncovered,"
        "differing_share,exact_seconds,classic_seconds\n";
    for (const StudyRow& row : rows) {
        text += fmt::format(
            "{},{},{},{},{},{},{},{},{},{},{},{},{:.6g},{:.4g},{:.4g}\n", row.scene, row.resolution,
            name_of(row.params.curves), has_pieces(row) ? std::to_string(row.params.pieces) : "",
            name_of(row.params.clip), row.pixels, row.optic_pixels, row.differing, row.direct, row.reflect,
            row.refract, row.uncovered, row.share(), row.exact_seconds, row.classic_seconds);
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

/// One scene of the study.
struct Subject {
    std::string name;
    const World& world;
    FrameParams frame;

    bool is_too_large(const ClassicParams& params) const {
        if (params.curves != Curves::kTessellate) return false;
        const double pieces = params.pieces;
        const double triangles = pieces * pieces * static_cast<double>(world.objects.size());
        if (triangles <= kMostTriangles) return false;
        fmt::print(stderr, "{}, {}: left out, it would cut the scene into {:.0f} million triangles\n", name,
                   classic_name(params), 1e-6 * triangles);
        return true;
    }

    std::vector<StudyRow> rows(const std::vector<ClassicParams>& ways) const {
        const std::string resolution = resolution_text(world, frame.resolution);
        const SeenPicture exact = look(world, frame, Engine::kExact);
        fmt::print(stderr, "{} at n = {}\n", name, resolution);
        std::vector<StudyRow> rows;
        for (const ClassicParams& params : ways) {
            if (is_too_large(params)) continue;
            StudyRow row = compare(exact, look(world, frame, params));
            row.scene = name;
            row.resolution = resolution;
            row.params = params;
            rows.push_back(row);
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

std::string table_text(const std::vector<StudyRow>& rows) {
    std::string text = fmt::format("{:<14} {:>4}  {:<27} {:>8} {:>9} {:>10} {:>9} {:>9}\n", "scene", "n",
                                   "classic", "pixels", "differing", "share", "uncovered", "seconds");
    for (const StudyRow& row : rows)
        text += fmt::format("{:<14} {:>4}  {:<27} {:>8} {:>9} {:>9.4f}% {:>9} {:>9.3f}\n", row.scene,
                            row.resolution, classic_name(row.params), row.pixels, row.differing,
                            100 * row.share(), row.uncovered, row.classic_seconds);
    return text;
}

struct StudyRequest {
    std::vector<std::string> scenes;
    std::string camera;  // empty: each scene's own
    std::string folder;
    int resolution = 2;  // while K varies
};

/// Draws every scene in every way, and writes the tables and plots after each, so that an interrupted study
/// keeps what it has.
void study_engines(const StudyRequest& request) {
    std::vector<StudyRow> curves, clipping;
    std::vector<StudyRow> complete;  // of the scenes that could be drawn in every way
    int complete_scenes = 0;
    make_folder(request.folder + "/plots");
    const auto warn = [](const std::string& warning) { fmt::print(stderr, "warning: {}\n", warning); };
    for (const std::string& file : request.scenes) {
        SceneRequest asked;
        asked.file = file;
        asked.resolution = request.resolution;
        Scene scene = load_scene(asked);
        for (const std::string& warning : scene.warnings) warn(warning);
        const std::size_t camera = find_camera(scene, request.camera);
        const Renderer renderer(std::move(scene), warn);
        Subject subject{std::filesystem::path(file).stem().string(), renderer.world(), {camera, 0}};
        const std::vector<StudyRow> rows = subject.rows(ways_to_draw_curves());
        curves.insert(curves.end(), rows.begin(), rows.end());
        if (rows.size() == ways_to_draw_curves().size()) {
            complete.insert(complete.end(), rows.begin(), rows.end());
            ++complete_scenes;
        }
        replace_text_file(request.folder + "/plots/" + subject.name + ".svg", share_plot(subject.name, rows));
        for (const int n : kResolutions) {
            subject.frame.resolution = n;
            for (const StudyRow& row : subject.rows(ways_to_clip())) clipping.push_back(row);
        }
        replace_text_file(request.folder + "/engines.csv", table_csv(curves));
        replace_text_file(request.folder + "/clipping.csv", table_csv(clipping));
    }
    if (!complete.empty())
        replace_text_file(request.folder + "/plots/engines.svg",
                          share_plot(std::to_string(complete_scenes) + " scenes", complete));
    fmt::print("{}\n{}", table_text(curves), table_text(clipping));
}

}  // namespace

int main(int count, char** words) {
    StudyRequest request;
    CLI::App app{"The classic engine against the exact one: curves and clipping."};
    app.add_option("SCENES", request.scenes, "scene files")->required();
    app.add_option("-o,--output", request.folder, "folder for the tables and plots")->required();
    app.add_option("-n,--resolution", request.resolution,
                   "resolution of the optics while K varies; default: 2")
        ->check(CLI::Range(1, 1024));
    app.add_option("--camera", request.camera, "a camera by name; default: each scene's own");
    CLI11_PARSE(app, count, words);
    try {
        study_engines(request);
    } catch (const std::exception& error) {
        fmt::print(stderr, "bench_engine_study: {}\n", error.what());
        return 1;
    }
    return 0;
}
