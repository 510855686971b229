#include "paths/facets/facet_paths.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

#include "base/util/parallel.h"
#include "paths/facets/divide_facet.h"
#include "paths/facets/film_reach.h"
#include "paths/facets/fit_nodes.h"

namespace trilens {
namespace {

constexpr std::size_t kCornersPerTask = 64, kFacetsPerTask = 16;
constexpr double kFittedArea = 1;  // square pixels: a fit of facets below this costs more than drawing them
constexpr double kInTheWay = 1 - 1e-4;  // of the way to a corner: what is met before hides it

}  // namespace

bool OpticPaths::shows_front(Id facet) const {
    return !grid_ || faces_front(*grid_, grid_->facets[facet], incident_[grid_->facets[facet][0]]);
}

void OpticPaths::probe_corners(std::span<const Id> facets) {
    std::vector<Id> wanted;  // corner and side
    for (const Id f : facets)
        for (const Id corner : outline_.facets[f]) {
            const Id key = 2 * corner + (shows_front(f) ? 1 : 0);
            if (!corner_probes_[key]) wanted.push_back(key);
        }
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    parallel_for(wanted.size(), kCornersPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const bool front = wanted[i] % 2 == 1;
            const Id corner = wanted[i] / 2;
            auto probe = std::make_unique<PathProbe>(
                probe_point(context_, places_[corner], {outline_.screen[corner], incident_[corner]},
                            {.side = front ? ProbeSide::kFront : ProbeSide::kBack,
                             .least_weight = kFainter * kLeastWeight}));
            if (!params_.estimates) probe_offsets(context_, *probe);
            corner_probes_[wanted[i]] = std::move(probe);
        }
    });
}

/// At the corners of those parts alone that need it: see append_part.
void OpticPaths::set_ray_scales(std::span<const DividedFacet> divided) const {
    const auto is_later = [](const PathSegment& history) {
        return history.parent != kNone || history.step.event != Event::kReflect;
    };
    std::vector<PathProbe*> wanted;
    for (const DividedFacet& facet : divided)
        for (const FacetPart& part : facet.parts) {
            if (std::none_of(part.histories.begin(), part.histories.end(), is_later)) continue;
            for (const PartCorner& corner : part.corners)
                if (corner.probe->ray_scale.empty()) wanted.push_back(corner.probe);
        }
    std::sort(wanted.begin(), wanted.end(), std::less<>());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    parallel_for(wanted.size(), kCornersPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) set_corner_ray_scale(context_, *wanted[i]);
    });
}

std::array<Vec3, 3> OpticPaths::screen_corners(Id facet) const {
    const IdTriple& corner = outline_.facets[facet];
    return {outline_.screen[corner[0]], outline_.screen[corner[1]], outline_.screen[corner[2]]};
}

bool OpticPaths::on_film(Id facet) const {
    const std::array<Vec3, 3> screen = screen_corners(facet);
    const bool has_image = std::all_of(screen.begin(), screen.end(), [](const Vec3& s) { return s.z != 0; });
    return has_image && may_reach_film(screen, context_.camera.film);
}

/// Whether the camera's ray through a corner of the grid comes to it: neither an optic nor an object is in
/// its way.
bool OpticPaths::is_in_sight(Id corner) const {
    const Vec3& screen = outline_.screen[corner];
    const Ray ray = context_.camera.ray(screen, places_[corner].point);
    const double size = length(ray.direction);
    if (!(size > 0)) return false;
    const Vec3 direction = ray.direction / size;
    const double nearer = kInTheWay * dot(places_[corner].point - ray.origin, direction);
    const Hit object = params_.objects ? params_.objects->first_hit({ray.origin, direction}) : Hit();
    if (object.seen() && object.t < nearer) return false;
    const std::optional<NextOptic> optic =
        next_optic(*context_.world, {{ray.origin, direction}, kNone, context_.camera.media(screen)});
    return !optic || optic->distance >= nearer;
}

/// The facets of a side that are on the film and not too small to be worth it, ascending; where it can be
/// told those alone of which a corner is in sight.
std::vector<Id> OpticPaths::fitted_together(bool front) const {
    const bool all = params_.fit_all || !grid_;
    std::vector<Id> shown;
    for (Id f = 0; f < outline_.facets.size(); ++f)
        if (shows_front(f) == front && on_film(f) && (all || screen_area(screen_corners(f)) >= kFittedArea))
            shown.push_back(f);
    if (all) return shown;
    std::vector<char> wanted(outline_.screen.size(), 0), sighted(outline_.screen.size(), 0);
    for (const Id f : shown)
        for (const Id corner : outline_.facets[f]) wanted[corner] = 1;
    parallel_for(wanted.size(), kCornersPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t c = from; c < to; ++c) sighted[c] = wanted[c] && is_in_sight(static_cast<Id>(c));
    });
    std::erase_if(shown, [&](Id f) {
        const IdTriple& corner = outline_.facets[f];
        return !sighted[corner[0]] && !sighted[corner[1]] && !sighted[corner[2]];
    });
    return shown;
}

/// Those of `facets` that are not known, and those that are fitted with them: these first, for a fit's sums
/// must not depend on what else is asked for; each ascending.
std::vector<Id> OpticPaths::wanted_facets(std::span<const Id> facets) {
    std::vector<Id> fresh;
    std::array<bool, 2> begins{};
    for (const Id f : facets) {
        if (prepared_[f]) continue;
        fresh.push_back(f);
        begins[shows_front(f) ? 1 : 0] = true;
    }
    if (params_.fit)
        for (std::size_t side = 0; side < 2; ++side) {
            if (!begins[side] || side_fitted_[side]) continue;
            side_fitted_[side] = true;
            const std::vector<Id> together = fitted_together(side == 1);
            fresh.insert(fresh.end(), together.begin(), together.end());
            for (const Id f : together) fitted_[f] = 1;
        }
    std::sort(fresh.begin(), fresh.end(),
              [&](Id a, Id b) { return std::pair(!fitted_[a], a) < std::pair(!fitted_[b], b); });
    fresh.erase(std::unique(fresh.begin(), fresh.end()), fresh.end());
    return fresh;
}

/// Which facets' paths there is room for, by what the probes at some corners take: the same whatever is asked
/// for first. A facet has four probes of its own and half a corner.
void OpticPaths::keep_room() {
    constexpr std::size_t kFew = 2048, kSample = 64;
    if (!has_room_.empty()) return;
    has_room_.assign(outline_.facets.size(), 1);
    std::vector<Id> shown, sample;
    for (Id f = 0; f < outline_.facets.size(); ++f)
        if (on_film(f)) shown.push_back(f);
    if (shown.size() <= kFew && params_.most_bytes >= DivideParams().most_bytes) return;
    for (std::size_t i = 0; i < shown.size(); i += std::max<std::size_t>(1, shown.size() / kSample))
        sample.push_back(shown[i]);
    probe_corners(sample);
    double bytes = 0, probes = 0;
    for (const Id f : sample)
        for (const Id corner : outline_.facets[f]) {
            const PathProbe& probe = *corner_probes_[2 * corner + (shows_front(f) ? 1 : 0)];
            bytes += static_cast<double>(sizeof(PathProbe) + probe.segments.size() * sizeof(PathSegment));
            probes += 1;
        }
    const double room = static_cast<double>(params_.most_bytes) * probes / std::max(1.0, 4.5 * bytes);
    for (std::size_t i = 0; i < shown.size(); ++i) has_room_[shown[i]] = static_cast<double>(i) < room;
    crowded_out_ = static_cast<std::size_t>(std::count(has_room_.begin(), has_room_.end(), 0));
}

FacetToDivide OpticPaths::facet_to_divide(Id f) const {
    FacetToDivide facet;
    const IdTriple& corners = outline_.facets[f];
    const bool front = shows_front(f);
    facet.side = !grid_ ? ProbeSide::kNearest : front ? ProbeSide::kFront : ProbeSide::kBack;
    facet.reach = grid_ ? 0 : 2 * window_.reach;
    for (std::size_t k = 0; k < 3; ++k) {
        const Id key = 2 * corners[k] + (front ? 1 : 0);
        facet.corners[k] = {key, corner_probes_[key].get(), places_[corners[k]].point};
    }
    return facet;
}

void OpticPaths::prepare(std::span<const Id> facets) {
    if (ends_first_) {
        for (const Id f : facets) {
            projected_count_ += !prepared_[f];
            prepared_[f] = 1;
        }
        return;
    }
    keep_room();
    survey();
    const std::vector<Id> fresh = wanted_facets(facets);
    std::vector<Id> probed;
    for (const Id f : fresh) {
        if (!has_room_[f]) continue;
        if (is_worth_probing(f))
            probed.push_back(f);
        else
            ++probe_report_.not_worth;
    }
    probe_corners(probed);

    std::vector<DividedFacet> divided(fresh.size());
    parallel_for(fresh.size(), kFacetsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const auto surveyed = surveyed_.find(fresh[i]);
            if (surveyed != surveyed_.end())
                divided[i] = std::move(*surveyed->second);
            else if (!has_room_[fresh[i]] || !is_worth_probing(fresh[i]))
                divided[i] = traced_facet(screen_corners(fresh[i]));
            else
                divided[i] = divide_facet(context_, facet_to_divide(fresh[i]), params_, probe_report_.plan);
        }
    });
    for (const Id f : fresh) surveyed_.erase(f);
    set_ray_scales(divided);
    std::vector<FittedLeaf> whole, open;
    for (std::size_t i = 0; i < fresh.size(); ++i) {
        prepared_[fresh[i]] = 1;
        const Id first_leaf = static_cast<Id>(leaves_.size());
        append(fresh[i], fresh[i], divided[i]);
        for (std::size_t p = 0; p < divided[i].parts.size(); ++p) {
            const FittedLeaf leaf{static_cast<Id>(first_leaf + p), &divided[i].parts[p]};
            if (leaf.part->method != LeafMethod::kProjected) continue;
            open.push_back(leaf);
            if (fits_alone(leaf.leaf))
                fit_alone(leaf, nodes_);
            else
                whole.push_back(leaf);
        }
    }
    if (params_.fit) fit_nodes(whole, nodes_);
    divide_by_error(open);
}

}  // namespace trilens
