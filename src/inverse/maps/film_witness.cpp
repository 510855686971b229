#include "inverse/maps/film_witness.h"

#include <algorithm>
#include <cmath>

#include "base/util/parallel.h"
#include "inverse/maps/film_targets.h"
#include "render/world/world.h"

namespace trilens {
namespace {

constexpr std::size_t kFewestWitnesses = 1024,
                      kMostWitnesses = 1 << 18;  // shot between two looks at whether to stop
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

}  // namespace

FilmWitness::FilmWitness(const World& world, const WitnessRequest& request, const Progress& progress)
    : width_(request.width),
      height_(request.height),
      film_width_(world.scene.film.width),
      film_height_(world.scene.film.height),
      visibility_(request.images.visibility) {
    const FilmImagesParams& params = request.images;
    const bool has_glass = std::ranges::any_of(world.optics, [](const auto& optic) { return !optic.mirror; });
    const auto width = static_cast<std::size_t>(film_width_);
    const std::size_t pixels = width * static_cast<std::size_t>(film_height_);
    hidden_.assign(pixels, 0);
    std::vector<EventWord> words{EventWord()};
    if (has_glass && params.path == Path::kReflect) words.emplace_back("R");
    if (params.path == Path::kDirect) words = {EventWord("D")};

    Portions portions(kFewestWitnesses, kMostWitnesses);
    std::vector<Vec2> middles;
    for (std::size_t from = 0; from < pixels; from += middles.size()) {
        progress.stop_if_cancelled();
        middles.resize(portions.next(pixels - from));
        for (std::size_t p = 0; p < middles.size(); ++p)
            middles[p] = {double((from + p) % width) + 0.5, double((from + p) / width) + 0.5};
        for (const EventWord& word : words) {
            const ShotRays shots = shoot_places(world, {params.frame.camera, word}, middles);
            std::vector<std::optional<Vec2>> places(middles.size());
            parallel_for(middles.size(), 256, [&](std::size_t first, std::size_t last) {
                for (std::size_t p = first; p < last; ++p) {
                    const ShotRay& shot = shots.rays[p];
                    const bool on_way = is_on_way(world, params, shots, shot);
                    if (on_way) places[p] = request.place(shot);
                    const bool is_only_one =
                        shot.followed() && !shot.cut && (shot.event_count == 0 || !has_glass);
                    hidden_[from + p] |= is_only_one && !(on_way && places[p]);
                }
            });
            for (std::size_t p = 0; p < places.size(); ++p)
                if (places[p])
                    seen_.push_back({cell_of(*places[p]), static_cast<std::uint32_t>(from + p),
                                     static_cast<float>(places[p]->x), static_cast<float>(places[p]->y)});
        }
        progress(double(from + middles.size()) / double(pixels));
    }
    std::ranges::sort(seen_, {}, [](const Seen& one) { return std::pair(one.cell, one.pixel); });
}

std::uint32_t FilmWitness::cell_of(const Vec2& place) const {
    const auto x = static_cast<std::uint32_t>(std::clamp(place.x - 0.5, 0.0, std::max(0.0, width_ - 2.0)));
    const auto y = static_cast<std::uint32_t>(std::clamp(place.y - 0.5, 0.0, std::max(0.0, height_ - 2.0)));
    return y * static_cast<std::uint32_t>(width_) + x;
}

bool FilmWitness::shows_all(const CellImages& cell, double limit) const {
    MapImages images;
    const int end_x = std::max(cell.x1, cell.x0 + 1), end_y = std::max(cell.y1, cell.y0 + 1);
    for (int y = cell.y0; y < end_y; ++y) {
        const auto row = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(width_);
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

JudgePatch FilmWitness::judge(double tolerance) const {
    return [this, limit = kLimit * tolerance](const CellImages& cell) {
        return shows_all(cell, limit) && (!visibility_ || shows_nothing_else(cell));
    };
}

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
    if (hides && proxy.asks_visibility()) return std::nullopt;
    return place;
}

}  // namespace trilens
