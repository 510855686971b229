#include "trilens/engine_study.h"

#include <algorithm>
#include <filesystem>

#include "base/files/check_output.h"
#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/stopwatch.h"
#include "render/engines/engine.h"
#include "report/plot.h"
#include "sweep/store/own_files.h"
#include "trilens/render.h"

namespace trilens {
namespace {

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
    const Viewer viewer = make_viewer(world, frame, engine, {});
    const Stopwatch watch;
    SampleViews views;
    viewer({0, 0, film.width, film.height, 1}, views);
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
        text += fmt::format(
            "{},{},{},{},{},{},{},{},{},{},{},{},{:.6g},{:.4g},{:.4g}\n", row.scene, row.resolution,
            curves_name(row.params.curves), has_pieces(row) ? std::to_string(row.params.pieces) : "",
            clip_name(row.params.clip), row.pixels, row.optic_pixels, row.differing, row.direct, row.reflect,
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
    const SweepTalk& talk;

    bool is_too_large(const ClassicParams& params) const {
        if (params.curves != Curves::kTessellate) return false;
        const double pieces = params.pieces;
        const double triangles = pieces * pieces * static_cast<double>(world.objects.size());
        if (triangles <= kMostTriangles) return false;
        if (talk.warn)
            talk.warn(fmt::format("{}, {}: left out, it would cut the scene into {:.0f} million triangles",
                                  name, classic_name(params), 1e-6 * triangles));
        return true;
    }

    std::vector<StudyRow> rows(const std::vector<ClassicParams>& ways) const {
        const std::string resolution = resolution_text(world, frame.resolution);
        const SeenPicture exact = look(world, frame, Engine::kExact);
        Progress progress;
        if (talk.progress) progress = talk.progress(name + " at n = " + resolution);
        std::vector<StudyRow> rows;
        for (const ClassicParams& params : ways) {
            if (progress.cancelled()) throw Interrupted();
            if (is_too_large(params)) continue;
            StudyRow row = compare(exact, look(world, frame, params));
            row.scene = name;
            row.resolution = resolution;
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

/// Refuses a folder in which a file of somebody's would be lost: a plot of this name that no study wrote, or
/// an input.
void claim_folder(const std::string& folder, const std::vector<std::string>& scenes) {
    make_folder(folder);
    for (const char* name : {"engines.csv", "clipping.csv"}) check_writable(folder + "/" + name, scenes);
    std::vector<std::string> plots{"engines.svg"};
    for (const std::string& scene : scenes)
        plots.push_back(std::filesystem::path(scene).stem().string() + ".svg");
    if (!std::filesystem::exists(folder + "/engines.csv")) begin_report_list(folder, "plots");
    OwnReportFiles(folder, "plots").will_write(plots);
}

}  // namespace

EngineStudy study_engines(const StudyRequest& request, const SweepTalk& talk) {
    std::vector<std::string> files;
    for (const SceneRequest& scene : request.scenes) files.push_back(scene.file);
    require_distinct_names(files);
    EngineStudy study;
    std::vector<StudyRow> complete;  // of the scenes that could be drawn in every way
    int complete_scenes = 0;
    claim_folder(request.folder, files);
    for (const SceneRequest& file : request.scenes) {
        Scene scene = load_scene(file);
        if (talk.warn)
            for (const std::string& warning : scene.warnings) talk.warn(warning);
        const std::size_t camera = find_camera(scene, request.camera);
        const Renderer renderer(std::move(scene), talk.warn);
        Subject subject{
            std::filesystem::path(file.file).stem().string(), renderer.world(), {camera, 0}, talk};
        const std::vector<StudyRow> rows = subject.rows(ways_to_draw_curves());
        study.curves.insert(study.curves.end(), rows.begin(), rows.end());
        if (rows.size() == ways_to_draw_curves().size()) {
            complete.insert(complete.end(), rows.begin(), rows.end());
            ++complete_scenes;
        }
        replace_text_file(request.folder + "/plots/" + subject.name + ".svg", share_plot(subject.name, rows));
        for (const int n : kResolutions) {
            subject.frame.resolution = n;
            for (const StudyRow& row : subject.rows(ways_to_clip())) study.clipping.push_back(row);
        }
        // After every scene, so that an interrupted study keeps what it has.
        replace_text_file(request.folder + "/engines.csv", table_csv(study.curves));
        replace_text_file(request.folder + "/clipping.csv", table_csv(study.clipping));
    }
    for (const char* name : {"engines.csv", "clipping.csv"})
        study.files.push_back(request.folder + "/" + name);
    if (!complete.empty()) {
        study.files.push_back(request.folder + "/plots/engines.svg");
        replace_text_file(study.files.back(),
                          share_plot(std::to_string(complete_scenes) + " scenes", complete));
    }
    return study;
}

}  // namespace trilens
