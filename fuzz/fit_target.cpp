// Fuzz target of calibration: pairs of pixels and points that exact rays of a random scene make; a fit that
// begins at the truth stays there, one that begins beside it comes no farther from its pairs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fuzz/grammar.h"
#include "fuzz/random_scene.h"
#include "fuzz/target.h"
#include "trilens/fit.h"
#include "trilens/render.h"
#include "trilens/scene.h"

using namespace trilens;

namespace trilens_fuzz {
namespace {

constexpr std::size_t kOfRequest = 12;  // bytes, before the scene's
constexpr std::size_t kMostPairs = 24;
constexpr double kPixels = 1e-3;     // that exact pairs may be off
constexpr double kNearTruth = 1e-3;  // relative: from where a fit that its pairs tell all of finds the truth

/// What rays through the middles of pixels see, directly or over one or two optics.
std::vector<Correspondence> exact_pairs(const Renderer& renderer, const Scene& scene) {
    std::vector<Vec2> places;
    for (int y = 0; y < scene.film.height; y += 2)
        for (int x = 0; x < scene.film.width; x += 2) places.push_back({x + 0.5, y + 0.5});
    const ShotRays shot = renderer.shoot(places);
    std::vector<Correspondence> pairs;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const ShotRay& ray = shot.rays[i];
        const double share = std::max({ray.weight.x, ray.weight.y, ray.weight.z});
        if (ray.state != ShotState::kSeen || ray.cut || share < 1e-3) continue;
        Correspondence pair;
        pair.pixel = places[i];
        pair.point = ray.position;
        for (const PathEvent& event : shot.events_of(ray))
            if (event.event != Event::kPass) pair.path += event.event == Event::kReflect ? 'R' : 'T';
        if (pair.path.size() > 2 || pair.path.size() != ray.event_count) continue;
        if (pair.path.empty()) pair.path = "D";
        pairs.push_back(pair);
    }
    // Evenly over the film.
    std::vector<Correspondence> some;
    const std::size_t count = std::min(kMostPairs, pairs.size());
    for (std::size_t k = 0; k < count; ++k) some.push_back(pairs[k * pairs.size() / count]);
    return some;
}

/// Whether `project` lists the image that the pair is: of paths over several optics it may miss some, and
/// says so.
bool is_projected(const Renderer& renderer, const Correspondence& pair) {
    const std::vector<PointProjection> found = renderer.project(std::vector<Vec3>{pair.point});
    return std::ranges::any_of(found.front().images, [&](const WorldImage& image) {
        return image.refined && length(image.pixel - pair.pixel) < kPixels;
    });
}

/// Numbers of the first optic, or of the camera, and by how much a fit begins beside them, relative.
struct Unknown {
    std::vector<std::string> pointers;
    double beside = 0;
};

Unknown unknown_of(Choices& choose, const Scene& scene) {
    Unknown unknown;
    unknown.beside = choose.of(std::array{0.0, kNearTruth, 1e-2});
    const std::string& json = scene.resolved;
    const bool has_eye = json.find("\"lookAt\"") != std::string::npos;
    const bool has_place = !scene.meshes.empty() && scene.meshes.front().primitive.has_value();
    switch (choose.below(4)) {
        case 0:
            if (has_place) unknown.pointers.push_back("/meshes/0/primitive/center");
            break;
        case 1:
            if (has_eye) unknown.pointers.push_back("/cameras/0/lookAt/eye");
            break;
        case 2:
            if (has_place) unknown.pointers = {"/meshes/0/primitive/center", "/meshes/0/primitive/radius"};
            break;
        default:
            if (json.find("\"yfov\"") != std::string::npos) unknown.pointers = {"/cameras/0/yfov"};
    }
    if (unknown.pointers.empty()) unknown.pointers.push_back("/meshes/0/transform/translate");
    return unknown;
}

void require_numbers(const FitResult& fit, std::size_t pairs) {
    require(std::isfinite(fit.rms) && std::isfinite(fit.rms_start) && std::isfinite(fit.noise),
            "a fit whose residual is no number");
    require(fit.pairs.size() == pairs && fit.used + fit.lost + fit.outliers == pairs,
            "a fit that has lost count of its pairs");
    for (const FittedParameter& one : fit.parameters)
        require(std::isfinite(one.value) && std::isfinite(one.sigma) && one.sigma >= 0,
                "a fitted number that is none: " + one.pointer);
    for (const FittedPair& pair : fit.pairs)
        require(pair.state == PairState::kLost || std::isfinite(length(pair.residual)),
                "a residual that is no number");
}

void require_fit(const std::string& json, Choices& choose) {
    const Scene scene = parse_scene(json);
    const Renderer renderer(scene);
    std::vector<Correspondence> pairs = exact_pairs(renderer, scene);
    FitRequest request;
    const Unknown unknown = unknown_of(choose, scene);
    request.free = unknown.pointers;
    if (choose.chance(64)) {
        request.match = FitMatch::kNearest;
        std::erase_if(pairs, [&](const Correspondence& pair) { return !is_projected(renderer, pair); });
    }
    const auto fitted = [&] { return fit_scene(scene, pairs, request); };
    const FitResult truth = on_threads(1, fitted);
    require_numbers(truth, pairs.size());
    require(truth.rms_start <= kPixels,
            fmt::format("exact pairs are {} pixels off where the fit begins", truth.rms_start));
    require(truth.rms <= kPixels, fmt::format("a fit leaves the truth, for {} pixels", truth.rms));
    require(std::ranges::none_of(truth.warnings,
                                 [](const std::string& warning) {
                                     return warning.find("does not end in what it began in") !=
                                            std::string::npos;
                                 }),
            "a camera leaves the truth's glass");

    require(on_threads(3, fitted).document == truth.document, "a fit depends on the number of threads");

    if (unknown.beside == 0) return;
    std::vector<SceneOverride> moved;
    double reach = 0;  // a length of the scene, for places at its origin
    for (const Correspondence& pair : pairs) reach = std::max(reach, 0.1 * length(pair.point));
    for (const FittedParameter& one : truth.parameters) {
        const double size = one.start != 0 ? std::fabs(one.start) : reach;
        const double value = one.start + unknown.beside * choose.between(-1, 1) * size;
        moved.push_back({one.pointer, fmt::format("{}", value)});
    }
    const FitResult fit = fit_scene(parse_scene(truth.document, "", moved), pairs, request);
    require_numbers(fit, pairs.size());
    require(
        fit.rms <= fit.rms_start * (1 + 1e-6) + kPixels || !fit.warnings.empty(),
        fmt::format("a fit comes farther from its pairs and says nothing: {} to {}", fit.rms_start, fit.rms));
    const bool is_told = fit.rank == fit.parameters.size() && fit.lost == 0 && truth.lost == 0;
    if (unknown.beside > kNearTruth || !is_told) return;
    require(fit.rms <= std::max(kPixels, 0.1 * fit.rms_start),
            fmt::format("a fit from near the truth ends {} pixels off it, of {}", fit.rms, fit.rms_start));
}

}  // namespace

Answer random_fit(std::string_view bytes) {
    Choices choose(bytes.substr(0, std::min(bytes.size(), kOfRequest)));
    const RandomScene random = make_random_scene(bytes.substr(std::min(bytes.size(), kOfRequest)));
    return answer([&] { require_fit(random.json, choose); });
}

}  // namespace trilens_fuzz
