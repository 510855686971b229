#include "inverse/maps/film_witness.h"

#include <algorithm>
#include <cmath>

#include "base/util/parallel.h"
#include "inverse/maps/film_targets.h"
#include "render/world/world.h"

namespace trilens {
namespace {

constexpr double kShareOfWitness = 0.2;  // of the time, about: the film's rays
constexpr double kSamePoint = 1e-5;  // of the way: a point at infinity is so far that it is off by 1e-6
constexpr double kLimit = 10;        // tolerances

/// Whether light goes on as is asked for at the first optic of a ray that was followed to its end.
bool is_on_way(const World& world, const FilmImagesParams& params, const ShotRays& shots,
               const ShotRay& shot) {
    if (!shot.followed() || shot.cut || shot.weight == Vec3(0)) return false;
    if (shot.event_count == 0) return params.path == Path::kDirect;
    const PathEvent& first = shots.events_of(shot)[0];
    if (params.optic && first.optic != *params.optic) return false;
    const Path way = first.event == Event::kReflect ? Path::kReflect : Path::kRefract;
    return way == params.path.value_or(world.optics[first.optic].mirror ? Path::kReflect : Path::kRefract);
}

/// What one ray for each pixel of the film shows.
class FilmWitness {
  public:
    FilmWitness(const World& world, const PlacesOnFilm& places, const Progress& progress);

    /// The witness must live longer.
    JudgePatch judge() const;

  private:
    struct Seen {
        std::uint32_t cell = 0;   // the pixel of the lattice whose middle is next to the left and above
        std::uint32_t pixel = 0;  // of the film
        float x = 0, y = 0;       // place
    };
    void ask(const World& world, const PlacesOnFilm& places, const EventWord& word, const Progress& progress);
    bool shows_all(const CellImages& cell, double limit) const;
    bool shows_nothing_else(const CellImages& cell) const;
    std::uint32_t cell_of(const Vec2& place) const;

    MapLattice lattice_;
    int film_width_, film_height_;
    bool has_glass_;
    std::vector<Seen> seen_;             // by cell
    std::vector<unsigned char> hidden_;  // per film pixel: its ray shows no place, and is the only one
};

FilmWitness::FilmWitness(const World& world, const PlacesOnFilm& places, const Progress& progress)
    : lattice_(places.lattice),
      film_width_(world.scene.film.width),
      film_height_(world.scene.film.height),
      has_glass_(std::ranges::any_of(world.optics, [](const auto& optic) { return !optic.mirror; })),
      hidden_(static_cast<std::size_t>(film_width_) * static_cast<std::size_t>(film_height_), 0) {
    std::vector<EventWord> words{EventWord()};
    if (has_glass_ && places.images.path == Path::kReflect) words.emplace_back("R");
    if (places.images.path == Path::kDirect) words = {EventWord("D")};
    const double share = 1 / double(words.size());
    for (std::size_t w = 0; w < words.size(); ++w)
        ask(world, places, words[w], progress.part(double(w) * share, share));
    std::ranges::sort(seen_, {}, [](const Seen& one) { return std::pair(one.cell, one.pixel); });
}

void FilmWitness::ask(const World& world, const PlacesOnFilm& places, const EventWord& word,
                      const Progress& progress) {
    const FilmImagesParams& params = places.images;
    shoot_film(world, {params.frame.camera, word}, progress, [&](std::size_t from, const ShotRays& shots) {
        std::vector<std::optional<Vec2>> shown(shots.rays.size());
        parallel_for(shown.size(), 256, [&](std::size_t first, std::size_t last) {
            for (std::size_t p = first; p < last; ++p) {
                const ShotRay& shot = shots.rays[p];
                if (is_on_way(world, params, shots, shot)) shown[p] = places.shown(shot);
                const bool is_only_one =
                    shot.followed() && !shot.cut && (shot.event_count == 0 || !has_glass_);
                hidden_[from + p] |= is_only_one && !shown[p];
            }
        });
        for (std::size_t p = 0; p < shown.size(); ++p)
            if (shown[p])
                seen_.push_back({cell_of(*shown[p]), static_cast<std::uint32_t>(from + p),
                                 static_cast<float>(shown[p]->x), static_cast<float>(shown[p]->y)});
    });
}

std::uint32_t FilmWitness::cell_of(const Vec2& place) const {
    const auto x =
        static_cast<std::uint32_t>(std::clamp(place.x - 0.5, 0.0, std::max(0.0, lattice_.width - 2.0)));
    const auto y =
        static_cast<std::uint32_t>(std::clamp(place.y - 0.5, 0.0, std::max(0.0, lattice_.height - 2.0)));
    return y * static_cast<std::uint32_t>(lattice_.width) + x;
}

bool FilmWitness::shows_all(const CellImages& cell, double limit) const {
    MapImages images;
    const int end_x = std::max(cell.x1, cell.x0 + 1), end_y = std::max(cell.y1, cell.y0 + 1);
    for (int y = cell.y0; y < end_y; ++y) {
        const auto row = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(lattice_.width);
        const auto first = row + static_cast<std::uint32_t>(cell.x0),
                   end = row + static_cast<std::uint32_t>(end_x);
        for (auto one = std::ranges::lower_bound(seen_, first, {}, &Seen::cell);
             one != seen_.end() && one->cell < end; ++one) {
            const auto wide = static_cast<std::uint32_t>(film_width_);
            const Vec2 film(one->pixel % wide + 0.5, one->pixel / wide + 0.5);
            cell.at({one->x, one->y}, images);
            if (std::ranges::none_of(
                    images, [&](const MapImage& image) { return length(image.position - film) <= limit; }))
                return false;
        }
    }
    return true;
}

bool FilmWitness::shows_nothing_else(const CellImages& cell) const {
    MapImages images;
    for (int y = cell.y0; y <= cell.y1; ++y)
        for (int x = cell.x0; x <= cell.x1; ++x) {
            cell.at({x + 0.5, y + 0.5}, images);
            for (const MapImage& image : images) {
                const double column = std::floor(image.position.x), line = std::floor(image.position.y);
                if (!(column >= 0 && line >= 0 && column < film_width_ && line < film_height_)) continue;
                if (hidden_[static_cast<std::size_t>(line) * static_cast<std::size_t>(film_width_) +
                            static_cast<std::size_t>(column)])
                    return false;
            }
        }
    return true;
}

JudgePatch FilmWitness::judge() const {
    return [this, limit = kLimit * lattice_.tolerance](const CellImages& cell) {
        return shows_all(cell, limit) && shows_nothing_else(cell);
    };
}

/// The place of a target that a ray shows; none where the target's place is not what the ray goes to, as
/// where another object lies between it and the centre of directions.
std::optional<Vec2> witnessed_place(const ShotRay& shot, const Target& target, const Proxy& proxy) {
    const std::optional<Vec2> place = target_of(shot, target, proxy);
    if (!place) return std::nullopt;
    const std::optional<WorldPlace> there = world_places(target, proxy, std::span(&*place, 1))[0];
    if (!there) return std::nullopt;
    const Vec3 way = there->point - shot.origin;
    const double far = length(way);
    if (!(dot(way, shot.direction) > 0) || length(cross(way, shot.direction)) > kSamePoint * far)
        return std::nullopt;
    const bool hides = shot.state == ShotState::kSeen && shot.t < far * (1 - kSamePoint);
    if (hides && proxy.is_hidden_by_objects()) return std::nullopt;
    return place;
}

}  // namespace

PlacesOnFilm places_on_film(const FilmImagesParams& images, const TargetRequest& request,
                            const Target& target, const Proxy& proxy) {
    return {
        images,
        {request.target.width, request.target.height, first_cell(proxy.may_be_hidden()), request.tolerance},
        [&](std::span<const Vec2> places) { return world_places(target, proxy, places); },
        [&](const ShotRay& shot) { return witnessed_place(shot, target, proxy); }};
}

SampledMap map_onto_film(const World& world, const PlacesOnFilm& places, const Progress& progress) {
    const FilmWitness witness(world, places, progress.part(0, kShareOfWitness));
    const EvaluateMap evaluate = [&](std::span<const Vec2> asked, std::span<MapImages> images) {
        find_film_images(world, places.images, places.in_world(asked), images);
    };
    return SampledMap(places.lattice, evaluate, progress.part(kShareOfWitness, 1 - kShareOfWitness),
                      {{}, witness.judge()});
}

}  // namespace trilens
