#include "inverse/maps/film_map.h"

#include <algorithm>
#include <utility>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "inverse/maps/film_images.h"
#include "inverse/maps/film_targets.h"
#include "inverse/maps/film_witness.h"
#include "inverse/maps/sampled_map.h"
#include "render/frame/frame.h"
#include "render/world/world.h"

namespace trilens {
namespace {

constexpr std::size_t kFewestRays = 256;  // shot between two looks at whether to stop
constexpr double kShareOfRays = 0.7;      // of a view's time: the pixels' own rays

FilmMap empty_map(int width, int height, int source_width, int source_height) {
    FilmMap map;
    map.width = width;
    map.height = height;
    map.source_width = source_width;
    map.source_height = source_height;
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    map.x.assign(pixels, -1);
    map.y.assign(pixels, -1);
    for (std::vector<float>& values : map.jacobian) values.assign(pixels, 0);
    map.valid.assign(pixels, 0);
    return map;
}

/// Of several images of a pixel the best resolved.
void fill(const SampledMap& sampled, FilmMap& map) {
    sampled.for_each_pixel([&](int x, int y, std::span<const MapImage> images) {
        if (images.empty()) return;
        const MapImage& image = best_resolved(images);
        const std::size_t at =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) + static_cast<std::size_t>(x);
        map.x[at] = static_cast<float>(image.position.x);
        map.y[at] = static_cast<float>(image.position.y);
        for (int k = 0; k < 4; ++k) map.jacobian[k][at] = static_cast<float>(image.jacobian[k % 2][k / 2]);
        map.valid[at] = 1;
    });
    map.exact_places = sampled.exact_count();
    map.worst_accepted = sampled.worst_accepted();
}

/// Where a target lies on a film, or the other way round.
struct MapMaker {
    const World& world;
    const FilmMapRequest& request;
    const Target& target;
    const Proxy& proxy;
    const Progress& progress;

    FilmMap unwrap() const;
    FilmMap view() const;
};

FilmMap MapMaker::unwrap() const {
    const FilmImagesParams params{request.frame, request.optic,
                                  request.path,  !target.has_directions() || proxy.is_hidden_by_objects(),
                                  false,         progress.cancel};
    FilmMap map = empty_map(request.target.width, request.target.height, world.scene.film.width,
                            world.scene.film.height);
    fill(map_onto_film(world, places_on_film(params, request, target, proxy), progress), map);
    if (map.valid_count() == 0)
        throw InputError(scene_title(world.scene), "",
                         "nothing of the target is seen on the film within an optic");
    return map;
}

/// Every pixel's own ray says whether it shows the target, and where; the lattice, how that changes.
FilmMap MapMaker::view() const {
    FilmTargetsParams params;
    params.shoot = {request.frame.camera, request.word};
    params.optic = request.optic;
    params.over_optics = !world.optics.empty();
    ShownPixels shown = find_shown_pixels(world, params, target, proxy, progress.part(0, kShareOfRays));
    if (std::ranges::all_of(shown.history, [](std::uint64_t history) { return history == 0; }))
        throw InputError(scene_title(world.scene), "",
                         "the film shows nothing of the target in the middle of any pixel");

    const Progress rest = progress.part(kShareOfRays, 1 - kShareOfRays);
    const EvaluateMap evaluate = [&](std::span<const Vec2> pixels, std::span<MapImages> images) {
        Portions portions(kFewestRays, pixels.size());
        for (std::size_t first = 0, count = 0; first < pixels.size(); first += count) {
            rest.stop_if_cancelled();
            count = portions.next(pixels.size() - first);
            find_film_targets(world, params, target, proxy, pixels.subspan(first, count),
                              images.subspan(first, count));
        }
    };
    const Film& film = world.scene.film;
    FilmMap map = empty_map(film.width, film.height, request.target.width, request.target.height);
    fill(SampledMap({map.width, map.height, first_cell(false), request.tolerance}, evaluate, rest,
                    {{shown.x, shown.y, shown.history}}),
         map);
    map.x = std::move(shown.x);
    map.y = std::move(shown.y);
    map.exact_places = map.valid.size();
    return map;
}

}  // namespace

std::size_t FilmMap::valid_count() const {
    return static_cast<std::size_t>(std::count(valid.begin(), valid.end(), 1));
}

int first_cell(bool visibility) {
    return visibility ? 8 : 16;
}

Vec3 center_of_directions(const World& world, const std::optional<Vec3>& asked,
                          const std::optional<std::size_t>& optic) {
    if (asked) return *asked;
    Box box;
    for (std::size_t o = 0; o < world.optics.size(); ++o)
        if (!optic || *optic == o)
            for (const Vec3& point : optic_facets(world, o, world.optics[o].resolution)->grid().points)
                box.include(point);
    return box.empty() ? Vec3(0) : 0.5 * (box.low + box.high);
}

void check_target_request(const World& world, const TargetRequest& request) {
    if (request.optic && *request.optic >= world.optics.size()) throw UsageError("there is no such optic");
    if (!(request.tolerance > 0)) throw UsageError("the tolerance is a positive number of pixels");
}

FilmMap make_film_map(const World& world, const FilmMapRequest& request, const Progress& progress) {
    check_target_request(world, request);
    const Target target(request.target, world.scene);
    const Proxy proxy(request.proxy, world, center_of_directions(world, request.center, request.optic));
    const bool unwraps = request.way == MapWay::kUnwrap;
    if (!unwraps && request.path) throw UsageError("a path goes with the way unwrap; a view takes a word");
    if (unwraps && request.word.asks())
        throw UsageError("a word of events goes with the way view; an unwrap takes a path");
    const MapMaker maker{world, request, target, proxy, progress};
    return unwraps ? maker.unwrap() : maker.view();
}

}  // namespace trilens
