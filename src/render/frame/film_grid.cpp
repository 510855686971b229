#include "render/frame/frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/util/parallel.h"

namespace trilens {

namespace {

/// A position this far outside of a facet, as a share of its height, is still in it.
constexpr double kOutside = 1e-9;
/// Facets reach further than that into the bins around them.
constexpr double kLookupReach = 1e-7;

bool holds(const std::array<Vec2, 3>& facet, const Vec2& uv) {
    const auto& [a, b, c] = facet;
    const auto side = [](const Vec2& p, const Vec2& q, const Vec2& r) {
        return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    };
    const double area = side(a, b, c);
    return area != 0 && side(a, b, uv) / area >= -kOutside && side(b, c, uv) / area >= -kOutside &&
           side(c, a, uv) / area >= -kOutside;
}

}  // namespace

std::size_t FacetLookup::cell_of(double x, const FaceBins& bins) const {
    const double last = static_cast<double>(bins.side - 1);
    return static_cast<std::size_t>(std::clamp(std::floor(x * static_cast<double>(bins.side)), 0.0, last));
}

template <typename Body>
void FacetLookup::for_each_bin(std::size_t facet, const Body& body) const {
    const FaceBins& bins = faces_[grid_.facet_face[facet]];
    const auto& [a, b, c] = grid_.facet_uv[facet];
    const Vec2 low = glm::min(a, glm::min(b, c)) - kLookupReach,
               high = glm::max(a, glm::max(b, c)) + kLookupReach;
    for (std::size_t y = cell_of(low.y, bins); y <= cell_of(high.y, bins); ++y)
        for (std::size_t x = cell_of(low.x, bins); x <= cell_of(high.x, bins); ++x)
            body(bins.first + y * bins.side + x);
}

FacetLookup::FacetLookup(const SurfaceGrid& grid, std::size_t faces) : grid_(grid), faces_(faces) {
    std::vector<std::size_t> count(faces, 0);
    for (const Id face : grid.facet_face) ++count[face];
    std::size_t bins = 0;
    for (std::size_t f = 0; f < faces; ++f) {
        const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(count[f]) / 2));
        faces_[f] = {bins, std::max<std::size_t>(side, 1)};
        bins += faces_[f].side * faces_[f].side;
    }
    begin_.assign(bins + 1, 0);
    for (std::size_t f = 0; f < grid.facets.size(); ++f)
        for_each_bin(f, [&](std::size_t bin) { ++begin_[bin + 1]; });
    for (std::size_t bin = 0; bin < bins; ++bin) begin_[bin + 1] += begin_[bin];
    facets_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t f = 0; f < grid.facets.size(); ++f)
        for_each_bin(f, [&](std::size_t bin) { facets_[next[bin]++] = static_cast<Id>(f); });
}

Id FacetLookup::at(Id face, const Vec2& uv) const {
    const FaceBins& bins = faces_[face];
    const std::size_t bin = bins.first + cell_of(uv.y, bins) * bins.side + cell_of(uv.x, bins);
    for (std::size_t k = begin_[bin]; k < begin_[bin + 1]; ++k)
        if (holds(grid_.facet_uv[facets_[k]], uv)) return facets_[k];
    return kNone;
}

namespace {

/// What a film shows of a facet may lie this far from its straight triangle there, in its sizes, and pixels.
constexpr double kGridReach = 0.5, kGridReachPixels = 2;

/// One branch's places of all corners.
using Places = std::vector<std::optional<FilmImage>>;

Places places_of(const SurfaceGrid& grid, const CameraModel& model, std::size_t branch) {
    Places points(grid.points.size());
    parallel_for(points.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t p = from; p < to; ++p) points[p] = model.place(grid.points[p], branch);
    });
    Places places(grid.corner_point.size());
    for (std::size_t c = 0; c < places.size(); ++c) places[c] = points[grid.corner_point[c]];
    return places;
}

struct Builder {
    const SurfaceGrid& from;
    const CameraModel& model;
    const FilmSize& film;
    FilmGrid result;
    std::map<std::pair<std::size_t, int>, std::vector<Id>> corner_of;  // by branch and turns of the period

    void add_branch(std::size_t branch);
    bool add_facet(std::size_t facet, std::size_t branch, const Places& places);
    void append(std::size_t facet, std::size_t branch, const Places& places, const std::array<int, 3>& turns);
    bool on_film(const Vec2& at) const {
        return at.x >= 0 && at.y >= 0 && at.x <= film.width && at.y <= film.height;
    }
    /// Whether this film shows a corner of the facet by this branch.
    bool is_shown(std::size_t facet, std::size_t branch, const Places& places) const;
};

bool Builder::is_shown(std::size_t facet, std::size_t branch, const Places& places) const {
    for (const Id corner : from.facets[facet]) {
        const std::optional<FilmImage>& place = places[corner];
        if (!place || !(place->t >= 0)) continue;
        Vec2 at = place->pixel;
        const double period = model.period();
        if (period > 0) at.x -= period * std::floor(at.x / period);
        if (on_film(at) && model.shows(branch, at)) return true;
    }
    return false;
}

/// The facet with its corners turned by whole periods.
void Builder::append(std::size_t facet, std::size_t branch, const Places& places,
                     const std::array<int, 3>& turns) {
    IdTriple corners{};
    Vec2 middle(0);
    for (std::size_t k = 0; k < 3; ++k) {
        const Id old = from.facets[facet][k];
        std::vector<Id>& known = corner_of[{branch, turns[k]}];
        if (known.empty()) known.assign(from.corner_point.size(), kNone);
        const Vec2 at = places[old]->pixel + Vec2(turns[k] * model.period(), 0);
        if (known[old] == kNone) {
            known[old] = static_cast<Id>(result.views.size());
            const Vec3& point = from.points[from.corner_point[old]];
            result.views.push_back({Vec3(at, 1), point - places[old]->origin});
            result.grid.corner_point.push_back(from.corner_point[old]);
            result.grid.corner_normal.push_back(from.corner_normal[old]);
        }
        corners[k] = known[old];
        middle += at / 3.0;
    }
    result.grid.facets.push_back(corners);
    result.grid.facet_face.push_back(from.facet_face[facet]);
    result.grid.facet_uv.push_back(from.facet_uv[facet]);
    result.original.push_back(static_cast<Id>(facet));
    result.branch.push_back(branch);
    result.middle.push_back(middle);
    double reach = 0;
    for (const Id corner : corners) {
        const Vec3& screen = result.views[corner].screen;
        reach = std::max(reach, length(Vec2(screen.x, screen.y) - middle));
    }
    result.reach.push_back((1 + kGridReach) * reach + kGridReachPixels);
}

/// False where the branch has no place for the facet as a whole.
bool Builder::add_facet(std::size_t facet, std::size_t branch, const Places& places) {
    std::array<Vec2, 3> at;
    std::array<int, 3> turns{};
    bool ahead = false;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::optional<FilmImage>& place = places[from.facets[facet][k]];
        if (!place) return false;
        at[k] = place->pixel;
        ahead = ahead || place->t >= 0;
    }
    if (!ahead) return true;
    const double period = model.period();
    if (period > 0) {
        // Corners as near to the first as turns bring them; around a pole no turns bring them together.
        for (std::size_t k = 1; k < 3; ++k) {
            turns[k] = -static_cast<int>(std::lround((at[k].x - at[0].x) / period));
            at[k].x += turns[k] * period;
        }
        if (std::fabs(at[2].x - at[1].x) > 0.5 * period) return false;
    }
    const Vec2 low = glm::min(glm::min(at[0], at[1]), at[2]), high = glm::max(glm::max(at[0], at[1]), at[2]);
    const Vec2 reach = kGridReach * (high - low) + Vec2(kGridReachPixels);
    if (high.y + reach.y < 0 || low.y - reach.y > film.height) return true;
    const int first = period > 0 ? static_cast<int>(std::ceil((-high.x - reach.x) / period)) : 0;
    for (int turn = first; low.x - reach.x + turn * period <= film.width; ++turn) {
        if (high.x + reach.x + turn * period >= 0)
            append(facet, branch, places, {turns[0] + turn, turns[1] + turn, turns[2] + turn});
        if (period <= 0) break;
    }
    return true;
}

void Builder::add_branch(std::size_t branch) {
    const Places places = places_of(from, model, branch);
    for (std::size_t f = 0; f < from.facets.size(); ++f)
        if (!add_facet(f, branch, places) && is_shown(f, branch, places)) ++result.lost;
}

}  // namespace

Id FilmGrid::facet_at(Id f, const Vec2& at, const CameraModel& model) const {
    Id best = kNone;
    bool best_is_own = false;
    double nearest = 0;
    for (std::size_t i = first[f]; i < first[f + 1]; ++i) {
        const std::size_t facet = placed[i];
        const bool own = model.shows(branch[facet], at);
        const double distance = length(middle[facet] - at);
        if (own ? best_is_own && distance >= nearest
                : best_is_own || distance > reach[facet] || (best != kNone && distance >= nearest))
            continue;
        best = static_cast<Id>(facet);
        best_is_own = own;
        nearest = distance;
    }
    return best;
}

FilmGrid make_film_grid(const SurfaceGrid& grid, const CameraModel& model, const FilmSize& film) {
    Builder builder{grid, model, film, {}, {}};
    for (std::size_t branch = 0; branch < model.branch_count(); ++branch) builder.add_branch(branch);
    FilmGrid result = std::move(builder.result);
    result.grid.points = grid.points;
    result.first.assign(grid.facets.size() + 1, 0);
    for (const Id f : result.original) ++result.first[f + 1];
    for (std::size_t f = 0; f < grid.facets.size(); ++f) result.first[f + 1] += result.first[f];
    result.placed.resize(result.original.size());
    std::vector<std::size_t> next(result.first.begin(), result.first.end() - 1);
    for (std::size_t i = 0; i < result.original.size(); ++i) result.placed[next[result.original[i]]++] = i;
    return result;
}

}  // namespace trilens
