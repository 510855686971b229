#include "thesis/search.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trilens {
namespace {

struct Start {
    FacetScene scene;
    double score = 0;
};

FacetScene random_scene(Dice& dice) {
    FacetScene scene;
    for (Ray& ray : scene.facet.corner) ray = {dice.normal(), dice.normal()};
    for (Vec3& corner : scene.triangle.corner) corner = 1.5 * dice.normal();
    return scene;
}

FacetScene moved(const FacetScene& from, double step, Dice& dice) {
    FacetScene scene = from;
    for (Ray& ray : scene.facet.corner) {
        ray.origin += step * dice.normal();
        ray.direction += step * dice.normal();
    }
    for (Vec3& corner : scene.triangle.corner) corner += step * dice.normal();
    return scene;
}

/// Keeps a step that scores higher; steps grow where they succeed and shrink where they fail.
Start climbed(Start at, const Configuration& wanted, const SearchParams& params, Dice& dice) {
    double step = 0.1;
    for (int i = 0; i < params.steps; ++i) {
        const FacetScene next = moved(at.scene, step, dice);
        const double score = configuration_of(next) == wanted ? score_of(next, params.weights) : 0;
        if (score > at.score)
            at = {next, score}, step = std::min(0.3, 2 * step);
        else
            step = std::max(1e-3, 0.97 * step);
    }
    return at;
}

}  // namespace

double Dice::one_normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
}

Vec3 Dice::normal() {
    const double x = one_normal(), y = one_normal(), z = one_normal();
    return {x, y, z};
}

Found search(const Configuration& wanted, std::uint64_t seed, const SearchParams& params) {
    Dice dice(seed);
    Found found;
    std::vector<Start> starts;
    while (found.draws < params.most_draws && starts.size() < static_cast<std::size_t>(params.starts)) {
        ++found.draws;
        const FacetScene scene = random_scene(dice);
        if (configuration_of(scene) == wanted) starts.push_back({scene, score_of(scene, params.weights)});
    }
    std::stable_sort(starts.begin(), starts.end(),
                     [](const Start& a, const Start& b) { return a.score > b.score; });
    Start best;
    for (std::size_t s = 0; s < std::min(starts.size(), static_cast<std::size_t>(params.improved)); ++s) {
        const Start top = climbed(starts[s], wanted, params, dice);
        if (top.score > best.score) best = top;
    }
    if (best.score > 0) found.framed = framed(best.scene, params.weights);
    return found;
}

}  // namespace trilens
