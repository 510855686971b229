#include "view/painter.h"

#include <trilens/error.h>
#include <trilens/utilities.h>

#include <algorithm>
#include <cmath>

#include "view/birds_eye.h"
#include "view/light_changes.h"

namespace trilens {
namespace {

/// A picture that takes longer is drawn coarsely first.
constexpr double kLongSeconds = 0.06;
constexpr int kBirdsEyeSamples = 2;  // 2 x 2
constexpr int kFineSamples = 4, kFinestSamples = 8;

/// Pixels along a coarse picture's pixel; at first as many, then as the time of the last one asks.
constexpr int kMostCoarse = 16;
constexpr int kLeastCoarsePixels = 8;  // along its shorter side

int coarse_factor(int wanted, const Film& film) {
    while (wanted > 1 && std::min(film.width, film.height) / wanted < kLeastCoarsePixels) wanted /= 2;
    return wanted;
}

int next_coarse_factor(int factor, double seconds) {
    if (seconds > 2 * kLongSeconds) return std::min(2 * factor, kMostCoarse);
    return 4 * seconds < 1.5 * kLongSeconds ? std::max(factor / 2, 2) : factor;
}

}  // namespace

struct Painter::Work {
    DrawOrder order;
    Drawn drawn;
    DrawStage next = DrawStage::kDone;
    Json base_json;              // with the bird's-eye camera
    std::optional<Scene> base;   // of base_json
    std::optional<Scene> scene;  // of the state
    std::optional<Renderer> renderer, birds_eye;
    bool renderer_is_current = false;  // its scene is the state's, but for the film
    Film film_now;                     // of the renderer
    double full_seconds = 16;          // that all pixels took last; at first much
    int coarse = kMostCoarse;
    Image projected, truth;  // of the state, at the stage drawn last
    std::vector<LayerComparison> layers;
    std::vector<std::string> scene_warnings;
    WatchStage watcher;
    std::vector<FacetEdge> facet_edges;  // for the watcher

    const ViewSettings& settings() const { return order.state.settings; }

    void load() {
        Json json = *order.state.scene;
        if (!json.contains("cameras") || !json.at("cameras").is_array())
            throw InputError(order.file, "/cameras", "is missing");
        json["cameras"].push_back(birds_eye_camera(base ? *base : Scene(), settings().birds_eye));
        auto changes = base ? light_changes(base_json, json) : std::nullopt;
        if (!changes) {
            Scene read = parse_scene(json.dump(), order.folder, {}, order.file);
            // The bird's eye looks at the whole scene, which is known now.
            json["cameras"].back() = birds_eye_camera(read, settings().birds_eye);
            base = std::move(read);
            base_json = std::move(json);
            base->resolved = base_json.dump(-1, ' ', false, Json::error_handler_t::replace);
            base->cameras.back() =
                parse_scene(R"({"version":1,"cameras":[)" + base_json["cameras"].back().dump() + "]}")
                    .cameras.at(0);
            drawn.animation = find_animation(*base);
            changes.emplace();
        }
        scene =
            drawn.animation || !changes->empty() ? scene_at_frame(*base, settings().time, *changes) : *base;
        scene_warnings = scene->warnings;
        renderer_is_current = false;
        if (settings().frame.camera + 1 >= scene->cameras.size())
            throw UsageError("the scene has no camera number " + std::to_string(settings().frame.camera));
    }

    /// The state's scene with another film into the renderer.
    void use_film(int width, int height, int spp) {
        if (renderer_is_current && film_now.width == width && film_now.height == height &&
            film_now.spp == spp)
            return;
        Scene with = *scene;
        with.film.width = width;
        with.film.height = height;
        with.film.spp = spp;
        if (renderer)
            renderer->change(std::move(with));
        else
            renderer.emplace(std::move(with));
        film_now = renderer->scene().film;
        renderer_is_current = true;
    }

    PictureRequest request(Engine engine) const {
        PictureRequest request;
        request.frame = settings().frame;
        request.engine = engine;
        if (settings().compares()) return request;  // with all that is compared
        request.layers.layers = {"Z"};
        if (!settings().layer.empty()) request.layers.layers.push_back(settings().layer);
        const Overlays& overlays = settings().overlays;
        if (overlays.facets || overlays.method) request.layers.layers.push_back("optic");
        if (overlays.method) request.layers.layers.push_back("stat");
        return request;
    }

    Image draw(Engine engine, const Progress& progress) {
        const Warn warn = [this](const std::string& message) {
            if (std::find(drawn.warnings.begin(), drawn.warnings.end(), message) == drawn.warnings.end())
                drawn.warnings.push_back(message);
        };
        Picture picture = renderer->draw(request(engine), progress, warn);
        if (engine == settings().engine) drawn.statistics = picture.statistics;
        return std::move(picture.image);
    }

    /// The picture of the chosen engine; `engine`: the one that draws it.
    void draw_projected(const Film& film, Engine engine, const Progress& progress) {
        const Stopwatch watch;
        use_film(film.width, film.height, film.spp);
        projected = draw(engine, progress);
        drawn.optics = renderer->optics();
        drawn.draw_seconds = watch.seconds();
        const bool has_truth = truth.width == projected.width && truth.height == projected.height;
        drawn.order = order.number;
        drawn.film_width = scene->film.width;
        drawn.film_height = scene->film.height;
        drawn.left = side(settings().left, has_truth, drawn.left);
        drawn.right = settings().wipe < 1 ? side(settings().right, has_truth, drawn.right) : nullptr;
        const Overlays& overlays = settings().overlays;
        drawn.overlay =
            overlays.facets || overlays.method
                ? std::make_shared<Pixels>(overlay_pixels(projected, overlays.facets, overlays.method))
                : nullptr;
    }

    Film with_samples(int spp) const {
        Film film = scene->film;
        film.spp = spp;
        return film;
    }

    /// A light's way through optics, by beams in the projector, is searched point by point in the truth.
    bool has_caustics() const {
        const auto lights = base_json.find("lights");
        return lights != base_json.end() &&
               std::any_of(lights->begin(), lights->end(),
                           [](const Json& light) { return light.value("caustics", false); });
    }

    /// Where all pixels take long, fewer of them. A facet there holds few samples, or none: to follow the
    /// rays of these takes less than to prepare it, but for caustics.
    void draw_coarse(const Progress& progress) {
        const int factor = coarse_factor(coarse, scene->film);
        if (full_seconds <= kLongSeconds || factor == 1) return;
        Film film = with_samples(1);
        film.width = std::max(1, film.width / factor);
        film.height = std::max(1, film.height / factor);
        const bool traces = settings().engine == Engine::kExact && !has_caustics();
        draw_projected(film, traces ? Engine::kLimitTruth : settings().engine, progress);
        coarse = next_coarse_factor(factor, drawn.draw_seconds);
    }

    /// One side of the wipe, from the pictures of now; `before` where the truth is not drawn yet.
    std::shared_ptr<const Pixels> side(ShownPicture what, bool has_truth,
                                       const std::shared_ptr<const Pixels>& before) const {
        const auto kept = [](Pixels pixels) { return std::make_shared<const Pixels>(std::move(pixels)); };
        const std::string& layer = settings().layer;
        if (what == ShownPicture::kProjected) return kept(tone_pixels(projected, layer, settings().tone));
        if (!has_truth) return before;
        if (what == ShownPicture::kTruth) return kept(tone_pixels(truth, layer, settings().tone));
        if (what == ShownPicture::kDifference)
            return kept(difference_pixels(truth, projected, layer, settings().difference_scale));
        if (what == ShownPicture::kFlip) {
            const std::vector<float> flip = layer_flip(truth, projected, layer);
            return kept(heat_pixels(flip, projected.data_width, projected.data_height, 1));
        }
        const std::vector<float> lengths = displacement_lengths(layers, truth.pixels());
        return kept(heat_pixels(lengths, truth.data_width, truth.data_height, scale_end(lengths)));
    }

    void draw_comparison(int spp, const Progress& progress) {
        use_film(scene->film.width, scene->film.height, spp);
        Image drawn_truth = draw(Engine::kLimitTruth, progress);
        if (projected.data_width != drawn_truth.data_width) projected = draw(settings().engine, progress);
        truth = std::move(drawn_truth);
        const bool moves = settings().shows(ShownPicture::kDisplacement);
        // Pixels of several samples have no one place that they show.
        if (spp == 1) layers = moves ? compare_layers(truth, projected) : std::vector<LayerComparison>{};
        auto known = std::make_shared<ShownComparison>();
        CompareOptions options;
        options.layer = settings().layer;
        known->metrics = compare(truth, projected, options).metrics;
        if (!layers.empty()) {
            const Displacement total = total_displacement(layers, "");
            known->displacement = total.summary;
            known->lost = total.lost;
            known->displacement_end = scale_end(displacement_lengths(layers, truth.pixels()));
        }
        drawn.comparison = std::move(known);
        drawn.left = side(settings().left, true, drawn.left);
        if (settings().wipe < 1) drawn.right = side(settings().right, true, drawn.right);
    }

    void draw_lines(const Progress& progress) {
        use_film(scene->film.width, scene->film.height, 1);
        drawn.edges = nullptr;
        drawn.folds = nullptr;
        LineDrawing lines;
        const Overlays& overlays = settings().overlays;
        const bool facets = watcher && overlays.facets;
        facet_edges.clear();
        if (overlays.edges || overlays.folds || overlays.caustics || facets) {
            LineChoice choice;
            choice.folds = overlays.folds;
            choice.caustics = overlays.caustics;
            choice.facets = facets;
            lines = renderer->draw_lines(settings().frame, choice);
        }
        facet_edges = std::move(lines.facet_edges);
        if (overlays.edges)
            drawn.edges = std::make_shared<const std::vector<EdgeLine>>(std::move(lines.edge_lines));
        if (overlays.folds)
            drawn.folds = std::make_shared<const std::vector<FoldCurve>>(std::move(lines.fold_curves));
        const double reach = scene_reach(*base);
        drawn.pixel_paths = nullptr;
        if (settings().pixel)
            drawn.pixel_paths = std::make_shared<const std::vector<PathLine>>(
                pixel_paths(*renderer, request(Engine::kExact), *settings().pixel, reach));
        drawn.place_images = nullptr;
        if (const auto place = wanted_place())
            drawn.place_images =
                std::make_shared<const PlaceImages>(place_images(*renderer, settings().frame, *place));
        drawn.birds_eye = nullptr;
        if (!settings().birds_eye.shown) return;
        BirdsEyeRequest wanted;
        wanted.camera = settings().frame.camera;
        wanted.reach = reach;
        wanted.pixel_paths = drawn.pixel_paths.get();
        wanted.place_images = drawn.place_images.get();
        wanted.caustics = &lines.caustics;
        wanted.tone = settings().tone;
        const std::vector<Vec3> corners = camera_corners(*renderer, wanted.camera, reach / 4);
        Scene seen = birds_eye_scene(*renderer, wanted.camera, wanted.pixel_paths, wanted.place_images);
        seen.film.width = std::max(1, scene->film.width / 2);
        seen.film.height = std::max(1, scene->film.height / 2);
        seen.film.spp = kBirdsEyeSamples;
        if (birds_eye)
            birds_eye->change(std::move(seen));
        else
            birds_eye.emplace(std::move(seen));
        drawn.birds_eye =
            std::make_shared<const ShownBirdsEye>(draw_birds_eye(*birds_eye, wanted, corners, progress));
    }

    std::optional<Vec3> wanted_place() {
        if (!settings().pick) return settings().place;
        if (!settings().pick->in_birds_eye)
            return shown_place(*renderer, settings().frame.camera, settings().pick->at);
        if (!birds_eye) return std::nullopt;  // what was never shown cannot be pointed at
        return shown_place(*birds_eye, birds_eye->scene().cameras.size() - 1, settings().pick->at);
    }

    bool has_lines() const {
        return settings().overlays.edges || settings().overlays.folds || settings().pixel ||
               settings().place || settings().pick || settings().birds_eye.shown || drawn.edges ||
               drawn.folds || drawn.pixel_paths || drawn.place_images || drawn.birds_eye ||
               (watcher && (settings().overlays.facets || !facet_edges.empty()));
    }

    void draw_stage(const Progress& progress) {
        const Film& film = scene->film;
        switch (next) {
            case DrawStage::kCoarse:
                draw_coarse(progress);
                break;
            case DrawStage::kPixels:
                draw_projected(with_samples(1), settings().engine, progress);
                full_seconds = drawn.draw_seconds;
                break;
            case DrawStage::kLines:
                if (has_lines()) draw_lines(progress);
                break;
            case DrawStage::kComparison:
                if (settings().compares()) draw_comparison(1, progress);
                break;
            case DrawStage::kFine:
            case DrawStage::kFinest: {
                const int spp = next == DrawStage::kFine ? kFineSamples : kFinestSamples;
                if (spp <= film.spp && next == DrawStage::kFine) break;
                draw_projected(with_samples(std::max(spp, film.spp)), settings().engine, progress);
                if (settings().compares()) draw_comparison(std::max(spp, film.spp), progress);
                break;
            }
            case DrawStage::kDone:
                break;
        }
    }
};

Painter::Painter() : work_(std::make_unique<Work>()) {}
Painter::~Painter() = default;

void Painter::begin(const DrawOrder& order) {
    const bool is_new_scene = !work_->scene || *work_->order.state.scene != *order.state.scene ||
                              work_->order.state.settings.time != order.state.settings.time ||
                              work_->order.state.settings.birds_eye != order.state.settings.birds_eye ||
                              work_->order.folder != order.folder || !work_->drawn.error.empty();
    work_->order = order;
    work_->next = DrawStage::kDone;
    work_->drawn.error.clear();
    try {
        if (is_new_scene) work_->load();
        work_->drawn.warnings = work_->scene_warnings;
        work_->truth = {};
        work_->layers.clear();
        if (!order.state.settings.compares()) work_->drawn.comparison = nullptr;
        check_tone_mapping(order.state.settings.tone);
        work_->next = DrawStage::kCoarse;
    } catch (const Error& error) {
        work_->drawn.error = error.what();
    }
}

bool Painter::draw_next(const Progress& progress) {
    if (work_->next == DrawStage::kDone) return false;
    const Drawn before = work_->drawn;
    try {
        work_->draw_stage(progress);
    } catch (const Interrupted&) {
        work_->drawn = before;
        throw;
    } catch (const Error& error) {
        work_->drawn = before;
        if (work_->next == DrawStage::kLines) {  // a mark off the film: pictures still get better
            work_->drawn.warnings.push_back(error.what());
            work_->next = DrawStage::kComparison;
            return true;
        }
        work_->drawn.error = error.what();
        work_->next = DrawStage::kDone;
        return false;
    }
    work_->drawn.stage = work_->next;
    work_->next = static_cast<DrawStage>(static_cast<int>(work_->next) + 1);
    if (work_->next == DrawStage::kDone) work_->drawn.stage = DrawStage::kDone;
    if (work_->watcher)
        work_->watcher({work_->drawn, work_->projected, work_->truth, work_->facet_edges},
                       work_->drawn.warnings);
    return work_->next != DrawStage::kDone;
}

void Painter::watch(WatchStage watch) {
    work_->watcher = std::move(watch);
}

DrawStage Painter::next() const {
    return work_->next;
}

const Drawn& Painter::drawn() const {
    return work_->drawn;
}

Image Painter::picture() {
    if (!work_->scene || !work_->drawn.error.empty()) throw UsageError(work_->drawn.error);
    Work& work = *work_;
    work.use_film(work.scene->film.width, work.scene->film.height, work.scene->film.spp);
    PictureRequest request;
    request.frame = work.settings().frame;
    request.engine = work.settings().engine;
    return work.renderer->draw(request).image;
}

std::string Painter::svg() {
    if (!work_->scene || !work_->drawn.error.empty()) throw UsageError(work_->drawn.error);
    Work& work = *work_;
    work.use_film(work.scene->film.width, work.scene->film.height, 1);
    LineChoice choice;
    choice.folds = work.settings().overlays.folds;
    return work.renderer->draw_lines(work.settings().frame, choice).svg;
}

}  // namespace trilens
