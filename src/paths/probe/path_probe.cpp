#include "paths/probe/path_probe.h"

#include <algorithm>
#include <cmath>

#include "reflect/reflection.h"

namespace trilens {

namespace {

constexpr double kStep = 1e-4;      // of a face's parameters, for differences
constexpr double kFilmStep = 0.01;  // pixels, likewise
/// Of the way from the eye: how much deeper the surface may lie a step away.
constexpr double kFilmReach = 1e-3;
constexpr double kSoftened = 0.15;  // 0.1 to 0.3 differ by 10 % at the most
/// A bundle that opens less than this, as a share of its patch seen head-on, is parallel but for rounding.
constexpr double kNoSpread = 1e-9;

Meeting meeting_at(const ProbeContext& context, const Place& place, const Vec3& incident, bool front) {
    return {context.optic, normalize_or_zero(incident), place.point, place.normal, front};
}

/// Follows the paths of a probe that is otherwise set.
void follow(const ProbeContext& context, PathProbe& probe, double least_weight) {
    FollowedPaths followed = follow_paths(
        *context.world,
        {meeting_at(context, probe.place, probe.incident, probe.front), length(probe.incident), probe.around},
        {.objects = nullptr, .least_weight = least_weight});
    probe.segments = std::move(followed.segments);
    probe.cut = followed.cut;
    probe.principal_only = least_weight == kPrincipalOnly;
    if (probe.principal_only) probe.cut.faint = probe.cut.faint_behind = Vec3(0);  // nobody asked for those
}

/// The paths from `place`, where this ray of the camera arrives.
PathProbe arrive(const ProbeContext& context, const Place& place, const CornerView& view,
                 const ProbeParams& params) {
    const Vec3& incident = view.incident;
    PathProbe probe;
    probe.screen = view.screen;
    probe.incident = incident;
    probe.place = place;
    const double cosine = dot(incident, place.normal);
    probe.front = params.side == ProbeSide::kNearest ? cosine <= 0 : params.side == ProbeSide::kFront;
    if (probe.front ? cosine >= 0 : cosine <= 0) {
        probe.state = ProbeState::kTurned;
        return probe;
    }
    probe.state = ProbeState::kSeen;
    probe.around = context.camera.media(view.screen);
    follow(context, probe, params.least_weight);
    return probe;
}

/// Six times the volume between a unit direction and two others near it: twice the solid angle they enclose.
double spread(const Vec3& u, const Vec3& a, const Vec3& b) {
    return std::fabs(triple(u, a - u, b - u));
}

/// A place beside this one on the same face; `axis` 0: u, 1: v. In the corner of a triangle that lies farthest
/// along the other axis there is room along its longest side alone.
Place beside(const Surface& surface, const Place& place, int axis) {
    Vec2 uv = place.uv;
    const bool is_triangle = surface.domain(place.face) == FaceDomain::kTriangle;
    const double room = is_triangle ? 1 - uv.x - uv.y : 1 - uv[axis];
    const bool goes_on = room > kStep, is_cornered = is_triangle && !goes_on && uv[axis] < kStep;
    uv[axis] += goes_on || is_cornered ? kStep : -kStep;
    if (is_cornered) uv[1 - axis] -= kStep;
    const SurfacePoint at = surface.eval_first_order(place.face, uv);
    return {place.face, uv, at.position, at.normal};
}

/// Where the camera's ray through the film there meets the surface first within reach, on the side asked for.
struct PlaceSeen {
    Place place;
    Ray ray;  // of the camera, as PathCamera has it
};
std::optional<PlaceSeen> arrival(const ProbeContext& context, const Chord& chord, ProbeSide side) {
    const Ray to_chord = context.camera.ray(chord.screen, chord.point);
    const Vec3 along = normalize_or_zero(to_chord.direction);
    const double back =
        context.camera.parallel ? chord.reach : std::min(chord.reach, length(to_chord.direction));
    // Between corners on the film a camera that is not linear looks past the chord.
    const Vec3& from_eye = to_chord.origin;
    const Vec3 point =
        context.camera.affine ? from_eye + dot(chord.point - from_eye, along) * along : chord.point;
    const Ray near{point - back * along, along};
    const LimitTracer& tracer = *context.world->optics[context.optic].tracer;
    const double far = back + chord.reach;
    for (double from = 0; from < far;) {
        const std::optional<SurfaceHit> hit = tracer.first_hit(near, from);
        if (!hit || hit->t > far) break;
        from = hit->t + 1e-9 * chord.reach;
        const bool front = dot(along, hit->point.normal) < 0;
        if (side != ProbeSide::kNearest && front != (side == ProbeSide::kFront)) continue;
        return PlaceSeen{{hit->face, hit->uv, hit->point.position, hit->point.normal}, to_chord};
    }
    return std::nullopt;
}

Vec2 film_place(const ProbeContext& context, const Vec3& point) {
    const Vec3 screen = context.camera.screen(point);
    return Vec2(screen) / screen.z;
}

/// Along u or v.
OffsetProbe beside_on_surface(const ProbeContext& context, const PathProbe& probe, int axis) {
    const Place place = beside(*context.surface, probe.place, axis);
    const Vec3 incident = context.camera.ray(context.camera.screen(place.point), place.point).direction;
    return {place, incident, film_place(context, place.point) - film_place(context, probe.place.point),
            repeat_paths(*context.world,
                         {meeting_at(context, place, incident, probe.front), length(incident), probe.around},
                         probe.segments)};
}

/// Along the film's x or y; none where the surface is not met there.
std::optional<OffsetProbe> beside_on_film(const ProbeContext& context, const PathProbe& probe, int axis) {
    const ProbeSide side = probe.front ? ProbeSide::kFront : ProbeSide::kBack;
    for (const double size : {kFilmStep, -kFilmStep}) {
        Vec2 step(0);
        step[axis] = size;
        const Chord chord{probe.screen + Vec3(step, 0), probe.place.point,
                          kFilmReach * length(probe.incident)};
        const std::optional<PlaceSeen> there = arrival(context, chord, side);
        if (!there) continue;
        const Vec3 incident = there->place.point - there->ray.origin;
        return OffsetProbe{there->place, there->place.point - (probe.place.point - probe.incident), step,
                           repeat_paths(*context.world,
                                        {meeting_at(context, there->place, incident, probe.front),
                                         length(incident), probe.around},
                                        probe.segments)};
    }
    return std::nullopt;
}

}  // namespace

PathProbe probe_point(const ProbeContext& context, const Place& place, const CornerView& view,
                      const ProbeParams& params) {
    return arrive(context, place, view, params);
}

PathProbe probe_point(const ProbeContext& context, const Place& place, const ProbeParams& params) {
    const Vec3 screen = context.camera.screen(place.point);
    return probe_point(context, place, {screen, context.camera.ray(screen, place.point).direction}, params);
}

PathProbe probe_chord(const ProbeContext& context, const Chord& chord, const ProbeParams& params) {
    const std::optional<PlaceSeen> there = arrival(context, chord, params.side);
    PathProbe probe;
    if (there) {
        // As long as the way to the surface itself.
        const Vec3 incident =
            context.camera.parallel ? there->ray.direction : there->place.point - there->ray.origin;
        probe = arrive(context, there->place, {chord.screen, incident}, params);
    } else {
        probe.incident = context.camera.ray(chord.screen, chord.point).direction;
    }
    probe.screen = chord.screen;
    return probe;
}

std::optional<double> parallel_length(const ProbeContext& context) {
    if (!context.camera.parallel) return std::nullopt;
    return context.world->optics[context.optic].tracer->size();
}

void follow_all(const ProbeContext& context, PathProbe& probe, double least_weight) {
    if (probe.principal_only) follow(context, probe, least_weight);
}

void probe_offsets(const ProbeContext& context, PathProbe& probe) {
    if (probe.state != ProbeState::kSeen || !probe.beside.empty()) return;
    for (int axis = 0; axis < 2; ++axis) {
        std::optional<OffsetProbe> one = context.camera.affine ? beside_on_film(context, probe, axis)
                                                               : beside_on_surface(context, probe, axis);
        if (one) probe.beside.push_back(std::move(*one));
    }
}

void set_ray_scale(const ProbeContext& context, PathProbe& probe) {
    if (probe.state != ProbeState::kSeen || !probe.ray_scale.empty()) return;
    probe.ray_scale.assign(probe.segments.size(), 0.0);
    const bool kept = !probe.beside.empty();
    probe_offsets(context, probe);
    const std::vector<OffsetProbe>& side = probe.beside;
    if (side.size() < 2) {
        if (!kept) probe.beside.clear();
        return;
    }
    // Solid angles over that of the same patch seen head-on. Those before and after are differences of the
    // same rays, so that flat mirrors and plates have 1 to rounding.
    const double eye = parallel_length(context).value_or(length(probe.incident));
    const double head_on =
        length(cross(side[0].place.point - probe.place.point, side[1].place.point - probe.place.point)) /
        (eye * eye);
    // Where a face is drawn together to a point, steps on it lead nowhere.
    if (!(head_on > 0)) {
        if (!kept) probe.beside.clear();
        return;
    }
    const Vec3 v = normalize_or_zero(probe.incident);
    const double before =
        context.camera.parallel
            ? std::fabs(dot(probe.place.normal, v))
            : spread(v, normalize_or_zero(side[0].incident), normalize_or_zero(side[1].incident)) / head_on;
    for (std::size_t i = 0; i < probe.segments.size(); ++i) {
        if (!side[0].segments[i] || !side[1].segments[i]) continue;
        const double after = spread(probe.segments[i].ray.direction, side[0].segments[i]->ray.direction,
                                    side[1].segments[i]->ray.direction) /
                             head_on;
        if (!(after > kNoSpread)) continue;
        // Bundles that stay as they are need no softening; softened are those that graze, and those that
        // the optics make parallel, where the ray scale would be infinite: directions so different in length
        // along one facet would cost an order of its error.
        const double softened = kSoftened * (after - before) / (after + before);
        probe.ray_scale[i] = ray_scale_of(std::hypot(before, softened), std::hypot(after, softened));
    }
    if (!kept) probe.beside.clear();
}

void set_corner_ray_scale(const ProbeContext& context, PathProbe& probe) {
    if (probe.segments.size() > 1 ||
        (probe.segments.size() == 1 && probe.segments[0].step.event != Event::kReflect))
        set_ray_scale(context, probe);
    else
        probe.ray_scale.assign(probe.segments.size(), 1.0);
}

NodeCorner first_reflection(const PathProbe& probe, const PathSegment* segment) {
    NodeCorner corner;
    corner.ray = {probe.place.point, mirrored(probe.incident, probe.place.normal)};
    corner.screen = probe.screen;
    if (segment) corner.next = segment->next / length(probe.incident);
    return corner;
}

double farther(const PathProbe& probe, const PathSegment& segment, bool unfolds) {
    return unfolds ? segment.way / length(probe.incident) : 1;
}

NodeCorner later_corner(const PathProbe& probe, const PathSegment& segment, double ray_scale, bool unfolds) {
    const double factor = farther(probe, segment, unfolds);
    const double size = length(probe.incident) * factor * ray_scale;
    return {{segment.ray.origin, size * segment.ray.direction},
            factor * probe.screen,
            segment.next / size,
            segment.weight};
}

namespace {

double largest_channel(const Vec3& v) {
    return std::max({v.x, v.y, v.z});
}

/// The segment of the same kind as `wanted` behind `parent`; kNone where there is none.
Id same_behind(Id parent, const PathSegment& wanted, const std::vector<PathSegment>& segments) {
    const auto same = std::find_if(segments.begin(), segments.end(), [&](const PathSegment& one) {
        return one.parent == parent && one.step == wanted.step && one.colours == wanted.colours &&
               one.medium == wanted.medium && one.ends == wanted.ends && one.principal == wanted.principal;
    });
    return same == segments.end() ? kNone : static_cast<Id>(same - segments.begin());
}

std::ptrdiff_t count_principal(const std::vector<PathSegment>& segments) {
    return std::count_if(segments.begin(), segments.end(),
                         [](const PathSegment& segment) { return segment.principal; });
}

}  // namespace

std::vector<std::size_t> matched(const std::vector<PathSegment>& histories,
                                 const std::vector<PathSegment>& segments) {
    std::vector<std::size_t> found;
    for (const PathSegment& wanted : histories) {
        const Id parent = wanted.parent == kNone ? kNone : static_cast<Id>(found[wanted.parent]);
        const Id same = same_behind(parent, wanted, segments);
        if (same == kNone) return {};
        found.push_back(same);
    }
    return found;
}

bool covers(const std::vector<std::size_t>& match, const std::vector<PathSegment>& segments) {
    for (std::size_t i = 0; i < segments.size(); ++i) {
        if (std::find(match.begin(), match.end(), i) != match.end()) continue;
        if (segments[i].principal || largest_channel(segments[i].weight) > kMuchLight * kLeastWeight)
            return false;
    }
    return true;
}

bool same_principal(const std::vector<PathSegment>& a, const std::vector<PathSegment>& b) {
    if (count_principal(a) != count_principal(b)) return false;
    std::vector<Id> found(a.size(), kNone);
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!a[i].principal) continue;
        found[i] = same_behind(a[i].parent == kNone ? kNone : found[a[i].parent], a[i], b);
        if (found[i] == kNone) return false;
    }
    return true;
}

// Principal paths first: where they differ no others matter.

FacetPoint ProbeCache::between(std::initializer_list<const FacetPoint*> points) {
    FacetPoint middle;
    const double share = 1.0 / static_cast<double>(points.size());
    for (const FacetPoint* one : points) {
        middle.screen += share * one->screen;
        middle.chord += share * one->chord;
    }
    probes_.push_back(probe_chord(context_, {middle.screen, middle.chord, params_.reach},
                                  {.side = params_.side, .least_weight = kPrincipalOnly}));
    middle.probe = &probes_.back();
    note(middle.probe->cut);
    return middle;
}

FacetPoint ProbeCache::middle_of(const FacetPoint& a, const FacetPoint& b) {
    Ends ends{a.probe, b.probe};
    if (std::less<>()(ends.second, ends.first)) std::swap(ends.first, ends.second);
    const auto [known, is_new] = middles_.try_emplace(ends);
    if (is_new) known->second = between({&a, &b});
    return known->second;
}

void ProbeCache::follow_all_at(const FacetPoint& point, double least_weight) {
    if (!point.probe->principal_only) return;
    follow_all(context_, *point.probe, least_weight);
    if (params_.beside) probe_offsets(context_, *point.probe);
    note(point.probe->cut);
}

bool may_agree(std::span<const FacetPoint> points) {
    const PathProbe& first = *points[0].probe;
    return std::all_of(points.begin(), points.end(), [&](const FacetPoint& point) {
        const PathProbe& probe = *point.probe;
        return probe.state == ProbeState::kSeen && probe.front == first.front &&
               (&probe == &first || same_principal(first.segments, probe.segments));
    });
}

}  // namespace trilens
