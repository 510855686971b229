#include "render/project/film_parts.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "base/util/parallel.h"
#include "paths/facets/divide_facet.h"

namespace trilens {
namespace {

/// Rays of a part that turn from corner to corner by no more than this, as a chord, are interpolated.
constexpr double kMostTurn = 0.5;
/// Halvings of a triangle's sides at most, and those at least.
constexpr int kMostHalvings = 5, kLeastHalvings = 1;
/// Halvings where rays at a part's corners have different histories.
constexpr int kBorderHalvings = 3;
/// Rays that are followed for one call, before a further halving begins.
constexpr std::size_t kMostFollowed = 60'000;
constexpr std::size_t kTrianglesPerTask = 4;

/// One triangle while it is divided.
class Division {
  public:
    Division(const FilmPartsQuestion& question, const FilmTriangle& triangle) : question_(question) {
        parts_.facet = triangle.facet;
        FilmPart whole;
        for (std::size_t k = 0; k < 3; ++k) whole.corner[k] = place(triangle.screen[k]);
        open_ = {whole};
    }

    bool is_open() const { return !open_.empty(); }
    std::size_t places() const { return parts_.places.size(); }
    /// Settles the parts that need no halving, and leaves the others open.
    void judge(int level);
    /// Halves what is open.
    void halve();
    FilmParts take();

  private:
    Id place(const Vec3& screen);
    Id middle(Id a, Id b);
    bool needs_halving(const FilmPart& part, int level) const;

    const FilmPartsQuestion& question_;
    FilmParts parts_;
    std::vector<FilmPart> open_;
    std::map<std::pair<Id, Id>, Id> middles_;
};

Id Division::place(const Vec3& screen) {
    FollowedPlace made;
    made.screen = screen;
    if (screen.z > 0) made.segments = question_.follow(parts_.facet, Vec2(screen) / screen.z);
    for (std::size_t i = 0; i < made.segments.size(); ++i) {
        const PathSegment& last = made.segments[i];
        // Where light parts into colours the middle one stands for all.
        if (last.colours != kAllColours && last.colours != 1) continue;
        HistoryThere history{static_cast<Id>(i), last.colours, {}};
        for (Id s = history.last; s != kNone; s = made.segments[s].parent)
            history.steps.push_back(made.segments[s].step);
        std::reverse(history.steps.begin(), history.steps.end());
        if (history.steps.size() < question_.least_steps) continue;
        if (question_.asks(history.steps) && !made.segment_of(history))
            made.histories.push_back(std::move(history));
    }
    parts_.places.push_back(std::move(made));
    return static_cast<Id>(parts_.places.size() - 1);
}

Id Division::middle(Id a, Id b) {
    const auto [known, is_new] = middles_.try_emplace(std::minmax(a, b), kNone);
    if (is_new) known->second = place(0.5 * (parts_.places[a].screen + parts_.places[b].screen));
    return known->second;
}

bool Division::needs_halving(const FilmPart& part, int level) const {
    std::array<Vec3, 3> screen;
    for (std::size_t k = 0; k < 3; ++k) screen[k] = parts_.places[part.corner[k]].screen;
    if (!may_reach_film(screen, question_.film)) return false;
    if (level < kLeastHalvings) return true;
    for (const Id at : part.corner) {
        const FollowedPlace& place = parts_.places[at];
        for (const HistoryThere& history : place.histories) {
            if (history.steps.size() > question_.most_steps) continue;
            const Vec3& direction = place.segments[history.last].ray.direction;
            for (const Id beside : part.corner) {
                const PathSegment* other = parts_.places[beside].segment_of(history);
                if (!other && level < kBorderHalvings) return true;
                if (other && length(other->ray.direction - direction) > kMostTurn) return true;
            }
        }
    }
    return false;
}

void Division::judge(int level) {
    std::vector<FilmPart> open;
    for (const FilmPart& part : open_) (needs_halving(part, level) ? open : parts_.parts).push_back(part);
    open_ = std::move(open);
}

void Division::halve() {
    std::vector<FilmPart> halves;
    for (const FilmPart& part : open_) {
        const auto [a, b, c] = part.corner;
        const Id ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        for (const auto& corner :
             {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{bc, ca, ab}})
            halves.push_back({corner, false});
    }
    open_ = std::move(halves);
}

FilmParts Division::take() {
    for (FilmPart& part : open_) {
        part.is_open = true;
        parts_.parts.push_back(part);
    }
    return std::move(parts_);
}

}  // namespace

const PathSegment* FollowedPlace::segment_of(const HistoryThere& history) const {
    const auto found = std::find_if(histories.begin(), histories.end(),
                                    [&](const HistoryThere& one) { return one.is_like(history); });
    return found == histories.end() ? nullptr : &segments[found->last];
}

double longest_side(const std::array<Vec3, 3>& screen) {
    std::array<Vec2, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
        if (!(screen[k].z > 0)) return std::numeric_limits<double>::infinity();
        corner[k] = Vec2(screen[k]) / screen[k].z;
    }
    return std::max(
        {length(corner[1] - corner[0]), length(corner[2] - corner[1]), length(corner[0] - corner[2])});
}

std::vector<FilmParts> divide_film(const FilmPartsQuestion& question,
                                   std::span<const FilmTriangle> triangles) {
    std::vector<std::unique_ptr<Division>> divisions(triangles.size());
    const auto each = [&](const auto& work) {
        parallel_for(divisions.size(), kTrianglesPerTask, [&](std::size_t from, std::size_t to) {
            for (std::size_t i = from; i < to; ++i) work(i);
        });
    };
    each([&](std::size_t i) { divisions[i] = std::make_unique<Division>(question, triangles[i]); });
    for (int level = 0; level < kMostHalvings; ++level) {
        each([&](std::size_t i) { divisions[i]->judge(level); });
        std::size_t followed = 0;
        bool is_open = false;
        for (const auto& division : divisions) {
            followed += division->places();
            is_open = is_open || division->is_open();
        }
        if (!is_open || (level >= kLeastHalvings && followed > kMostFollowed)) break;
        each([&](std::size_t i) { divisions[i]->halve(); });
    }
    std::vector<FilmParts> parts;
    for (const auto& division : divisions) parts.push_back(division->take());
    return parts;
}

}  // namespace trilens
