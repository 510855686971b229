#include "paths/facets/path_build.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr std::size_t kCornersPerTask = 64;
constexpr double kFittedArea = 1;  // square pixels: a fit of facets below this costs more than drawing them
constexpr double kInTheWay = 1 - 1e-4;  // of the way to a corner: what is met before hides it
/// One facet in so many is surveyed, some at least, and some at the most.
constexpr std::size_t kOneIn = 16, kFewest = 4, kMost = 48;
/// So many are tried for one that is in sight.
constexpr std::size_t kTries = 4;

/// The k-th of a sequence of numbers that fills [0, 1) evenly (van der Corput, base 2).
double evenly(std::size_t k) {
    double place = 0;
    for (double digit = 0.5; k > 0; k /= 2, digit /= 2) place += digit * static_cast<double>(k % 2);
    return place;
}

}  // namespace

bool shows_front(const PathBuild& build, Id facet) {
    return !build.in.grid || faces_front(*build.in.grid, build.in.grid->facets[facet],
                                         build.in.incident[build.in.grid->facets[facet][0]]);
}

void probe_corners(PathBuild& build, std::span<const Id> facets) {
    std::vector<Id> wanted;  // corner and side
    for (const Id f : facets)
        for (const Id corner : build.out.outline.facets[f]) {
            const Id key = 2 * corner + (shows_front(build, f) ? 1 : 0);
            if (!build.caches.corner_probes[key]) wanted.push_back(key);
        }
    std::sort(wanted.begin(), wanted.end());
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    parallel_for(wanted.size(), kCornersPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const bool front = wanted[i] % 2 == 1;
            const Id corner = wanted[i] / 2;
            auto probe = std::make_unique<PathProbe>(
                probe_point(build.in.context, build.in.places[corner],
                            {build.out.outline.screen[corner], build.in.incident[corner]},
                            {.side = front ? ProbeSide::kFront : ProbeSide::kBack,
                             .least_weight = kFainter * kLeastWeight}));
            if (!build.in.params.estimates) probe_offsets(build.in.context, *probe);
            build.caches.corner_probes[wanted[i]] = std::move(probe);
        }
    });
}

void set_ray_scales(const PathInputs& in, std::span<const DividedFacet> divided) {
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
        for (std::size_t i = from; i < to; ++i) set_corner_ray_scale(in.context, *wanted[i]);
    });
}

std::array<Vec3, 3> screen_corners(const OpticPaths& paths, Id facet) {
    const IdTriple& corner = paths.outline.facets[facet];
    return {paths.outline.screen[corner[0]], paths.outline.screen[corner[1]],
            paths.outline.screen[corner[2]]};
}

bool is_on_film(const PathBuild& build, Id facet) {
    const std::array<Vec3, 3> screen = screen_corners(build.out, facet);
    const bool has_image = std::all_of(screen.begin(), screen.end(), [](const Vec3& s) { return s.z != 0; });
    return has_image && may_reach_film(screen, build.in.context.camera.film);
}

bool is_in_sight(const PathBuild& build, Id corner) {
    const Vec3& screen = build.out.outline.screen[corner];
    const Ray ray = build.in.context.camera.ray(screen, build.in.places[corner].point);
    const double size = length(ray.direction);
    if (!(size > 0)) return false;
    const Vec3 direction = ray.direction / size;
    const double nearer = kInTheWay * dot(build.in.places[corner].point - ray.origin, direction);
    const Hit object =
        build.in.params.objects ? build.in.params.objects->first_hit({ray.origin, direction}) : Hit();
    if (object.seen() && object.t < nearer) return false;
    const std::optional<NextOptic> optic = next_optic(
        *build.in.context.world, {{ray.origin, direction}, kNone, build.in.context.camera.media(screen)});
    return !optic || optic->distance >= nearer;
}

namespace {

/// The facets of a side that are on the film and not too small to be worth it, ascending; where it can be
/// told those alone of which a corner is in sight.
std::vector<Id> fitted_together(const PathBuild& build, bool front) {
    const bool all = build.in.params.fit_all || !build.in.grid;
    std::vector<Id> shown;
    for (Id f = 0; f < build.out.outline.facets.size(); ++f)
        if (shows_front(build, f) == front && is_on_film(build, f) &&
            (all || screen_area(screen_corners(build.out, f)) >= kFittedArea))
            shown.push_back(f);
    if (all) return shown;
    std::vector<char> wanted(build.out.outline.screen.size(), 0), sighted(build.out.outline.screen.size(), 0);
    for (const Id f : shown)
        for (const Id corner : build.out.outline.facets[f]) wanted[corner] = 1;
    parallel_for(wanted.size(), kCornersPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t c = from; c < to; ++c)
            sighted[c] = wanted[c] && is_in_sight(build, static_cast<Id>(c));
    });
    std::erase_if(shown, [&](Id f) {
        const IdTriple& corner = build.out.outline.facets[f];
        return !sighted[corner[0]] && !sighted[corner[1]] && !sighted[corner[2]];
    });
    return shown;
}

}  // namespace

std::vector<Id> wanted_facets(PathBuild& build, std::span<const Id> facets) {
    std::vector<Id> fresh;
    std::array<bool, 2> begins{};
    for (const Id f : facets) {
        if (build.progress.prepared[f]) continue;
        fresh.push_back(f);
        begins[shows_front(build, f) ? 1 : 0] = true;
    }
    if (build.in.params.fit)
        for (std::size_t side = 0; side < 2; ++side) {
            if (!begins[side] || build.progress.side_fitted[side]) continue;
            build.progress.side_fitted[side] = true;
            const std::vector<Id> together = fitted_together(build, side == 1);
            fresh.insert(fresh.end(), together.begin(), together.end());
            for (const Id f : together) build.progress.fitted[f] = 1;
        }
    std::sort(fresh.begin(), fresh.end(), [&](Id a, Id b) {
        return std::pair(!build.progress.fitted[a], a) < std::pair(!build.progress.fitted[b], b);
    });
    fresh.erase(std::unique(fresh.begin(), fresh.end()), fresh.end());
    return fresh;
}

void keep_room(PathBuild& build) {
    constexpr std::size_t kFew = 2048, kSample = 64;
    if (!build.progress.has_room.empty()) return;
    build.progress.has_room.assign(build.out.outline.facets.size(), 1);
    std::vector<Id> shown, sample;
    for (Id f = 0; f < build.out.outline.facets.size(); ++f)
        if (is_on_film(build, f)) shown.push_back(f);
    if (shown.size() <= kFew && build.in.params.most_bytes >= DivideParams().most_bytes) return;
    for (std::size_t i = 0; i < shown.size(); i += std::max<std::size_t>(1, shown.size() / kSample))
        sample.push_back(shown[i]);
    probe_corners(build, sample);
    double bytes = 0, probes = 0;
    for (const Id f : sample)
        for (const Id corner : build.out.outline.facets[f]) {
            const PathProbe& probe =
                *build.caches.corner_probes[2 * corner + (shows_front(build, f) ? 1 : 0)];
            bytes += static_cast<double>(sizeof(PathProbe) + probe.segments.size() * sizeof(PathSegment));
            probes += 1;
        }
    const double room = static_cast<double>(build.in.params.most_bytes) * probes / std::max(1.0, 4.5 * bytes);
    for (std::size_t i = 0; i < shown.size(); ++i)
        build.progress.has_room[shown[i]] = static_cast<double>(i) < room;
    build.out.crowded_out = static_cast<std::size_t>(
        std::count(build.progress.has_room.begin(), build.progress.has_room.end(), 0));
}

FacetToDivide facet_to_divide(const PathBuild& build, Id f) {
    FacetToDivide facet;
    const IdTriple& corners = build.out.outline.facets[f];
    const bool front = shows_front(build, f);
    facet.side = !build.in.grid ? ProbeSide::kNearest : front ? ProbeSide::kFront : ProbeSide::kBack;
    facet.reach = build.in.grid ? 0 : 2 * build.out.window.reach;
    for (std::size_t k = 0; k < 3; ++k) {
        const Id key = 2 * corners[k] + (front ? 1 : 0);
        facet.corners[k] = {key, build.caches.corner_probes[key].get(), build.in.places[corners[k]].point};
    }
    return facet;
}

bool is_worth_probing(const PathBuild& build, Id facet) {
    return !build.out.probe_report.plan.decides() || build.caches.surveyed.contains(facet) ||
           build.out.probe_report.plan.is_worth_corners(
               build.out.probe_report.plan.samples_in(screen_area(screen_corners(build.out, facet))));
}

void survey_facets(PathBuild& build) {
    if (build.progress.is_surveyed || build.in.params.per_pixel == 0) return;
    const ProbeContext& context = build.in.context;
    // Of several samples in a pixel enough is saved beside their paths that polyhedra are probed as others are.
    const bool is_clipped =
        build.in.params.per_pixel <= 1 && context.world->optics[context.optic].tracer->is_polyhedron();
    const ProbeCosts costs =
        ProbeCosts::of(build.in.params.per_pixel, context.surface->has_closed_form() || is_clipped);
    build.out.probe_report.plan = ProbePlan(build.in.params.per_pixel, costs, {});
    std::vector<Id> shown;
    for (Id f = 0; f < build.out.outline.facets.size(); ++f)
        if (is_on_film(build, f) && build.progress.has_room[f] && is_worth_probing(build, f))
            shown.push_back(f);
    const std::size_t wanted = std::min(shown.size(), std::clamp(shown.size() / kOneIn, kFewest, kMost));
    std::vector<Id> chosen;
    for (std::size_t k = 0; k < kTries * wanted && chosen.size() < wanted; ++k) {
        const Id f = shown[static_cast<std::size_t>(evenly(k) * static_cast<double>(shown.size()))];
        const IdTriple& corner = build.out.outline.facets[f];
        const auto in_sight = [&](Id c) { return is_in_sight(build, c); };
        if (std::find(chosen.begin(), chosen.end(), f) == chosen.end() &&
            (!build.in.grid || std::any_of(corner.begin(), corner.end(), in_sight)))
            chosen.push_back(f);
    }
    probe_corners(build, chosen);
    std::vector<std::unique_ptr<DividedFacet>> found(chosen.size());
    parallel_for(found.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i)
            found[i] = std::make_unique<DividedFacet>(
                divide_facet(build.in.context, facet_to_divide(build, chosen[i]), build.in.params,
                             build.out.probe_report.plan));
    });
    ProbeTally tally;
    for (std::size_t i = 0; i < found.size(); ++i) {
        tally.add(found[i]->tally);
        build.caches.surveyed[chosen[i]] = std::move(found[i]);
    }
    build.out.probe_report.surveyed = chosen.size();
    build.out.probe_report.plan = ProbePlan(build.in.params.per_pixel, costs, tally);
    build.progress.is_surveyed = true;
}

}  // namespace trilens
