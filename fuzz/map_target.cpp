// Fuzz target of maps: random scenes whose films are mapped onto panoramas and objects, and back; every place
// of a map is followed along its own ray, and what rays show of a target is in its map.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "fuzz/random_scene.h"
#include "fuzz/target.h"
#include "inverse/maps/target.h"
#include "render/world/world.h"
#include "trilens/image.h"
#include "trilens/maps.h"
#include "trilens/render.h"
#include "trilens/scene.h"

using namespace trilens;

namespace trilens_fuzz {
namespace {

constexpr int kDepth = 1;  // of paths: meetings with optics after the first
constexpr std::array kWords{"R", "T", "RR", "RT", "TR", "TT"};

constexpr int kMostOptics = 2;  // the search for paths over more takes seconds

/// A target's pixel, its middle.
Vec2 middle_of(int x, int y) {
    return {x + 0.5, y + 0.5};
}

std::size_t index_of(int x, int y, int width) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

/// What a target is made of, and where rays show it.
struct Mapped {
    const Renderer& renderer;
    const Scene& scene;
    TargetRequest request;
    Target target;

    Mapped(const Renderer& drawn, const Scene& of, const TargetDescription& description)
        : renderer(drawn), scene(of), target(description, of) {
        request.target = description;
        request.proxy.kind = ProxyKind::kInfinity;
    }

    /// What a followed ray shows of the target: a unit direction, or a point; none where it shows another
    /// thing.
    std::optional<Vec3> shown(const ShotRay& ray) const {
        if (!ray.followed()) return std::nullopt;
        if (target.has_directions()) return ray.direction;
        if (ray.state != ShotState::kSeen || ray.object != request.target.object) return std::nullopt;
        return ray.position;
    }
    /// Whether no optic hides what it shows; objects hide no direction.
    bool is_free(const ShotRay& ray) const {
        return !ray.cut && (!target.has_directions() || ray.state == ShotState::kEscapes);
    }
    std::optional<Vec2> pixel(const ShotRay& ray) const {
        const std::optional<Vec3> what = shown(ray);
        if (!what) return std::nullopt;
        return target.has_directions() ? target.pixel_of_direction(*what)
                                       : target.pixel_of_point(*what, ray.primitive);
    }
};

constexpr int kLargestCell = 4;  // pixels of the target between neighbours of the film

/// Pixels of the film about a place of an unwrapped map among which what it says must be shown, and of the
/// target that a place may be off.
constexpr double kNear = 0.1;

/// Whether `project` lists an image there: of what is smaller than the distance of the rays about a place.
bool is_projected(const Mapped& mapped, const Vec3& wanted, const Vec2& place) {
    const std::vector<Vec3> one{wanted};
    const PointProjection found = mapped.target.has_directions()
                                      ? mapped.renderer.project_directions(one).front()
                                      : mapped.renderer.project(one).front();
    return std::ranges::any_of(found.images,
                               [&](const WorldImage& image) { return length(image.pixel - place) < kNear; });
}

/// The rays about each place that a map has show what it says on all sides of it: of some word of events,
/// unless what one shows ends so near.
void require_places(const Mapped& mapped, const FilmMap& map) {
    std::vector<Vec2> places;
    std::vector<Vec3> wanted;
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x) {
            const std::size_t at = index_of(x, y, map.width);
            if (!map.valid[at]) continue;
            const Vec2 p(map.x[at], map.y[at]);
            for (const Vec2& off :
                 {Vec2(0), Vec2(kNear, 0), Vec2(-kNear, 0), Vec2(0, kNear), Vec2(0, -kNear)})
                places.push_back(p + off);
            const std::optional<TargetPlace> place = mapped.target.place(middle_of(x, y));
            require(place.has_value(), "a map has a pixel that is none of its target's");
            wanted.push_back(place->at);
        }
    std::vector<bool> is_right(wanted.size()), is_told(wanted.size());
    for (const char* word : kWords) {
        ShootRequest shoot;
        shoot.path = EventWord(word);
        const ShotRays shot = mapped.renderer.shoot(places, shoot);
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            std::array<std::optional<Vec3>, 5> ends;
            for (std::size_t k = 0; k < 5; ++k) ends[k] = mapped.shown(shot.rays[5 * i + k]);
            const auto count = std::ranges::count_if(ends, [](const auto& end) { return end.has_value(); });
            if (count == 0) continue;
            is_told[i] = true;
            double reach = 0;
            for (std::size_t k = 1; k < 5 && count == 5; ++k)
                reach = std::max(reach, length(*ends[k] - *ends[0]));
            is_right[i] = is_right[i] || count < 5 || length(wanted[i] - *ends[0]) <= reach;
        }
    }
    for (std::size_t i = 0; i < wanted.size(); ++i)
        require(is_right[i] || (!is_told[i] && is_projected(mapped, wanted[i], places[5 * i])),
                fmt::format("an unwrapped map is astray: at {},{} the film does not show {},{},{}",
                            places[5 * i].x, places[5 * i].y, wanted[i].x, wanted[i].y, wanted[i].z));
}

/// A view has the pixels whose rays show the target, at the places where these end.
void require_view(const Mapped& mapped, const FilmMap& view, const ShotRays& shot) {
    for (std::size_t i = 0; i < view.valid.size(); ++i) {
        const bool shows = mapped.pixel(shot.rays[i]).has_value() && shot.rays[i].event_count > 0;
        require(shows == (view.valid[i] != 0),
                fmt::format("a view {} pixel {}, whose ray shows {}", view.valid[i] ? "has" : "lacks", i,
                            shows ? "the target" : "another thing"));
        if (!shows) continue;
        const Vec2 place = *mapped.pixel(shot.rays[i]);
        require(length(place - Vec2(view.x[i], view.y[i])) <= 1e-5 * (1 + length(place)),
                fmt::format("a view has pixel {} at {},{}, where its ray shows {},{}", i, view.x[i],
                            view.y[i], place.x, place.y));
    }
}

/// What one mirror reflects, or one body of glass refracts twice: the ways that an unwrapped map has.
bool is_usual(const World& world, std::span<const PathEvent> events) {
    if (events.size() == 1) return events[0].event == Event::kReflect && world.optics[events[0].optic].mirror;
    return events.size() == 2 && events[0].event == Event::kTransmit && events[1].event == Event::kTransmit &&
           events[0].optic == events[1].optic;
}

bool is_same_way(std::span<const PathEvent> a, std::span<const PathEvent> b) {
    return std::ranges::equal(a, b, [](const PathEvent& one, const PathEvent& other) {
        return one.optic == other.optic && one.event == other.event && one.front == other.front;
    });
}

/// Where a target's pixel lies in a cell of four corners, along its sides; none outside, and in cells that
/// are turned over.
std::optional<Vec2> place_in_cell(const std::array<Vec2, 4>& corners, const Vec2& pixel) {
    const Vec2 u = corners[1] - corners[0], v = corners[2] - corners[0], w = pixel - corners[0];
    const double area = cross(u, v);
    if (std::fabs(area) < 1e-3) return std::nullopt;
    const Vec2 at(cross(w, v) / area, cross(u, w) / area);
    if (at.x < 0.1 || at.y < 0.1 || at.x + at.y > 0.9) return std::nullopt;
    return at;
}

/// Where the four pixels from this one on show the target; none where their ways are not one, or usual.
std::optional<std::array<Vec2, 4>> shown_cell(const Mapped& mapped, const ShotRays& shot, int x, int y) {
    const int width = mapped.scene.film.width;
    const auto events = shot.events_of(shot.rays[index_of(x, y, width)]);
    if (!is_usual(mapped.renderer.world(), events)) return std::nullopt;
    std::array<Vec2, 4> corners;
    for (int k = 0; k < 4; ++k) {
        const ShotRay& ray = shot.rays[index_of(x + k % 2, y + k / 2, width)];
        const std::optional<Vec2> at = mapped.pixel(ray);
        if (!at || !mapped.is_free(ray) || !is_same_way(events, shot.events_of(ray)) ||
            std::max({ray.weight.x, ray.weight.y, ray.weight.z}) <= 1e-3)
            return std::nullopt;
        corners[static_cast<std::size_t>(k)] = *at;
    }
    const auto [low, high] = std::ranges::minmax(corners, {}, &Vec2::x);
    if (high.x - low.x > kLargestCell) return std::nullopt;  // a seam, or a fold
    return corners;
}

/// Whether a place of the film shows a pixel of the target in this way.
bool is_shown(const Mapped& mapped, const Vec2& film, const Vec2& pixel, std::span<const PathEvent> way) {
    const ShotRays there = mapped.renderer.shoot(std::vector<Vec2>{film});
    const std::optional<Vec2> shown = mapped.pixel(there.rays[0]);
    return shown && is_same_way(way, there.events_of(there.rays[0])) && length(*shown - pixel) <= kNear;
}

/// What rays show of the target, in the same way all about, is in its map.
void require_complete(const Mapped& mapped, const FilmMap& map, const ShotRays& shot) {
    const Film& film = mapped.scene.film;
    const auto require_cell = [&](int x, int y, const std::array<Vec2, 4>& corners) {
        const auto way = shot.events_of(shot.rays[index_of(x, y, film.width)]);
        const int left = static_cast<int>(corners[0].x), top = static_cast<int>(corners[0].y);
        for (int py = std::max(0, top - kLargestCell); py < std::min(map.height, top + kLargestCell); ++py)
            for (int px = std::max(0, left - kLargestCell); px < std::min(map.width, left + kLargestCell);
                 ++px) {
                const std::optional<Vec2> at = place_in_cell(corners, middle_of(px, py));
                if (!at || map.valid[index_of(px, py, map.width)]) continue;
                const Vec2 place = middle_of(x, y) + *at;
                require(!is_shown(mapped, place, middle_of(px, py), way),
                        fmt::format("an unwrapped map lacks {},{}, which the film shows at {},{}", px, py,
                                    place.x, place.y));
            }
    };
    for (int y = 0; y + 1 < film.height; ++y)
        for (int x = 0; x + 1 < film.width; ++x)
            if (const auto corners = shown_cell(mapped, shot, x, y)) require_cell(x, y, *corners);
}

/// A photograph that is white everywhere unwraps to white, wherever it is seen.
void require_white(const Mapped& mapped, const FilmMap& map) {
    const Film& film = mapped.scene.film;
    Image white;
    white.width = white.data_width = film.width;
    white.height = white.data_height = film.height;
    for (const char* name : {"R", "G", "B"})
        white.channels.push_back(
            {name, std::vector<float>(static_cast<std::size_t>(film.width * film.height), 1)});
    UnwrapRequest request;
    static_cast<TargetRequest&>(request) = mapped.request;
    request.divide_weight = false;
    const Image made = unwrap(mapped.renderer, request, {photo_of(white, "white")}).image;
    const std::vector<float>& seen = made.find("A")->floats();
    for (const char* name : {"R", "G", "B"}) {
        const std::vector<float>& colour = made.find(name)->floats();
        for (std::size_t i = 0; i < seen.size(); ++i)
            require(std::fabs(colour[i] - (seen[i] > 0 ? 1 : 0)) <= 1e-5,
                    fmt::format("a white photograph unwraps to {} at {}, seen {}", colour[i], i, seen[i]));
    }
    require(std::ranges::equal(seen, map.valid, [](float a, unsigned char b) { return (a > 0) == (b != 0); }),
            "what is unwrapped and its map differ in what is seen");
}

void require_laws(const Mapped& mapped) {
    std::vector<Vec2> middles;
    const Film& film = mapped.scene.film;
    for (int y = 0; y < film.height; ++y)
        for (int x = 0; x < film.width; ++x) middles.push_back(middle_of(x, y));
    const ShotRays shot = mapped.renderer.shoot(middles);
    FilmMapRequest request;
    static_cast<TargetRequest&>(request) = mapped.request;
    request.way = MapWay::kView;
    answer([&] { require_view(mapped, make_map(mapped.renderer, request), shot); });
    request.way = MapWay::kUnwrap;
    FilmMap map;
    const auto made = [&] { return make_map(mapped.renderer, request); };
    if (answer([&] { map = on_threads(1, made); }) == Answer::kRefused) {
        map.width = request.target.width, map.height = request.target.height;
        map.valid.assign(static_cast<std::size_t>(map.width * map.height), 0);
    } else {
        const FilmMap again = on_threads(3, made);
        require(again.x == map.x && again.y == map.y, "a map depends on the number of threads");
        require_places(mapped, map);
        require_white(mapped, map);
    }
    require_complete(mapped, map, shot);
}

}  // namespace

Answer random_maps(std::string_view bytes) {
    const RandomScene random = make_random_scene(bytes);
    return answer([&] {
        try {
            Scene scene = parse_scene(random.json);
            scene.render.max_depth = kDepth;
            int optics = 0;
            std::erase_if(scene.meshes, [&](const Mesh& mesh) {
                return mesh.role == Role::kOptic && ++optics > kMostOptics;
            });
            for (Mesh& mesh : scene.meshes) mesh.resolution = std::min(mesh.resolution, 8);
            const Renderer renderer(scene);
            TargetDescription sky;
            sky.width = 12, sky.height = 6;
            require_laws(Mapped(renderer, scene, sky));
            const auto object = std::ranges::find(scene.meshes, Role::kObject, &Mesh::role);
            TargetDescription surface;
            surface.kind = TargetKind::kObject;
            surface.object = static_cast<Id>(object - scene.meshes.begin());
            surface.width = surface.height = 10;
            // Objects without a map of their surface are refused.
            answer([&] { require_laws(Mapped(renderer, scene, surface)); });
        } catch (const ComputationError& error) {  // a legal scene has maps
            throw Defect(std::string("a scene that was read is not mapped: ") + error.what());
        }
    });
}

}  // namespace trilens_fuzz
