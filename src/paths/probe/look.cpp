#include "paths/probe/look.h"

#include <algorithm>
#include <cmath>

#include "paths/probe/kappa.h"

namespace trilens {
namespace {

constexpr double kStep = 1e-4;      // of a face's parameters, for differences
constexpr double kFilmStep = 0.01;  // pixels, likewise
/// Of the way from the eye: how much deeper the surface may lie a step away.
constexpr double kFilmReach = 1e-3;
constexpr double kSoftened = 0.15;  // 0.1 to 0.3 differ by 10 % at the most
/// A bundle that opens less than this, as a share of its patch seen head-on, is parallel but for rounding.
constexpr double kNoSpread = 1e-9;

Meeting meeting_at(const Looking& looking, const Place& place, const Vec3& incident, bool front) {
    return {looking.optic, normalize_or_zero(incident), place.point, place.normal, front};
}

/// Follows the paths of a look that is otherwise set.
void follow(const Looking& looking, Look& look, double least_weight) {
    FollowedPaths followed = follow_paths(
        *looking.world,
        {meeting_at(looking, look.place, look.incident, look.front), length(look.incident), look.around},
        {.objects = nullptr, .least_weight = least_weight});
    look.segments = std::move(followed.segments);
    look.cut = followed.cut;
    look.principal_only = least_weight == kPrincipalOnly;
    if (look.principal_only) look.cut.faint = look.cut.faint_behind = Vec3(0);  // nobody asked for those
}

/// The paths from `place`, where this ray of the camera arrives.
Look arrive(const Looking& looking, const Place& place, const CornerView& view, const LookParams& params) {
    const Vec3& incident = view.incident;
    Look look;
    look.screen = view.screen;
    look.incident = incident;
    look.place = place;
    const double cosine = dot(incident, place.normal);
    look.front = params.side == LookSide::kNearest ? cosine <= 0 : params.side == LookSide::kFront;
    if (look.front ? cosine >= 0 : cosine <= 0) {
        look.state = LookState::kTurned;
        return look;
    }
    look.state = LookState::kSeen;
    look.around = looking.camera.media(view.screen);
    follow(looking, look, params.least_weight);
    return look;
}

/// Six times the volume between a unit direction and two others near it: twice the solid angle they enclose.
double spread(const Vec3& u, const Vec3& a, const Vec3& b) {
    return std::fabs(triple(u, a - u, b - u));
}

/// A place beside this one on the same face; `axis` 0: u, 1: v.
Place beside(const Surface& surface, const Place& place, int axis) {
    Vec2 uv = place.uv;
    const double room = surface.domain(place.face) == FaceDomain::kTriangle ? 1 - uv.x - uv.y : 1 - uv[axis];
    uv[axis] += room > kStep ? kStep : -kStep;
    const SurfacePoint at = surface.eval_first_order(place.face, uv);
    return {place.face, uv, at.position, at.normal};
}

/// Where the camera's ray through the film there meets the surface first within reach, on the side asked for.
struct PlaceSeen {
    Place place;
    Ray ray;  // of the camera, as PathCamera has it
};
std::optional<PlaceSeen> arrival(const Looking& looking, const Chord& chord, LookSide side) {
    const Ray to_chord = looking.camera.ray(chord.screen, chord.point);
    const Vec3 along = normalize_or_zero(to_chord.direction);
    const double back =
        looking.camera.parallel ? chord.reach : std::min(chord.reach, length(to_chord.direction));
    // Between corners on the film a camera that is not linear looks past the chord.
    const Vec3& from_eye = to_chord.origin;
    const Vec3 point =
        looking.camera.affine ? from_eye + dot(chord.point - from_eye, along) * along : chord.point;
    const Ray near{point - back * along, along};
    const LimitTracer& tracer = *looking.world->optics[looking.optic].tracer;
    const double far = back + chord.reach;
    for (double from = 0; from < far;) {
        const std::optional<SurfaceHit> hit = tracer.first_hit(near, from);
        if (!hit || hit->t > far) break;
        from = hit->t + 1e-9 * chord.reach;
        const bool front = dot(along, hit->point.normal) < 0;
        if (side != LookSide::kNearest && front != (side == LookSide::kFront)) continue;
        return PlaceSeen{{hit->face, hit->uv, hit->point.position, hit->point.normal}, to_chord};
    }
    return std::nullopt;
}

Vec2 film_place(const Looking& looking, const Vec3& point) {
    const Vec3 screen = looking.camera.screen(point);
    return Vec2(screen) / screen.z;
}

/// Along u or v.
Beside beside_on_surface(const Looking& looking, const Look& look, int axis) {
    const Place place = beside(*looking.surface, look.place, axis);
    const Vec3 incident = looking.camera.ray(looking.camera.screen(place.point), place.point).direction;
    return {place, incident, film_place(looking, place.point) - film_place(looking, look.place.point),
            repeat_paths(*looking.world,
                         {meeting_at(looking, place, incident, look.front), length(incident), look.around},
                         look.segments)};
}

/// Along the film's x or y; none where the surface is not met there.
std::optional<Beside> beside_on_film(const Looking& looking, const Look& look, int axis) {
    const LookSide side = look.front ? LookSide::kFront : LookSide::kBack;
    for (const double size : {kFilmStep, -kFilmStep}) {
        Vec2 step(0);
        step[axis] = size;
        const Chord chord{look.screen + Vec3(step, 0), look.place.point, kFilmReach * length(look.incident)};
        const std::optional<PlaceSeen> there = arrival(looking, chord, side);
        if (!there) continue;
        const Vec3 incident = there->place.point - there->ray.origin;
        return Beside{there->place, there->place.point - (look.place.point - look.incident), step,
                      repeat_paths(*looking.world,
                                   {meeting_at(looking, there->place, incident, look.front), length(incident),
                                    look.around},
                                   look.segments)};
    }
    return std::nullopt;
}

}  // namespace

Look look_at(const Looking& looking, const Place& place, const CornerView& view, const LookParams& params) {
    return arrive(looking, place, view, params);
}

Look look_at(const Looking& looking, const Place& place, const LookParams& params) {
    const Vec3 screen = looking.camera.screen(place.point);
    return look_at(looking, place, {screen, looking.camera.ray(screen, place.point).direction}, params);
}

Look look_through(const Looking& looking, const Chord& chord, const LookParams& params) {
    const std::optional<PlaceSeen> there = arrival(looking, chord, params.side);
    Look look;
    if (there) {
        // As long as the way to the surface itself.
        const Vec3 incident =
            looking.camera.parallel ? there->ray.direction : there->place.point - there->ray.origin;
        look = arrive(looking, there->place, {chord.screen, incident}, params);
    } else {
        look.incident = looking.camera.ray(chord.screen, chord.point).direction;
    }
    look.screen = chord.screen;
    return look;
}

void follow_all(const Looking& looking, Look& look, double least_weight) {
    if (look.principal_only) follow(looking, look, least_weight);
}

void set_beside(const Looking& looking, Look& look) {
    if (look.state != LookState::kSeen || !look.beside.empty()) return;
    for (int axis = 0; axis < 2; ++axis) {
        std::optional<Beside> one = looking.camera.affine ? beside_on_film(looking, look, axis)
                                                          : beside_on_surface(looking, look, axis);
        if (one) look.beside.push_back(std::move(*one));
    }
}

void set_kappa(const Looking& looking, Look& look) {
    if (look.state != LookState::kSeen || !look.kappa.empty()) return;
    look.kappa.assign(look.segments.size(), 0.0);
    const bool kept = !look.beside.empty();
    set_beside(looking, look);
    const std::vector<Beside>& side = look.beside;
    if (side.size() < 2) {
        if (!kept) look.beside.clear();
        return;
    }
    // Solid angles over that of the same patch seen head-on. Those before and after are differences of the
    // same rays, so that flat mirrors and plates have 1 to rounding.
    const double eye = length(look.incident);
    const double head_on =
        length(cross(side[0].place.point - look.place.point, side[1].place.point - look.place.point)) /
        (eye * eye);
    const Vec3 v = normalize_or_zero(look.incident);
    const double before =
        looking.camera.parallel
            ? std::fabs(dot(look.place.normal, v))
            : spread(v, normalize_or_zero(side[0].incident), normalize_or_zero(side[1].incident)) / head_on;
    for (std::size_t i = 0; i < look.segments.size(); ++i) {
        if (!side[0].segments[i] || !side[1].segments[i]) continue;
        const double after = spread(look.segments[i].ray.direction, side[0].segments[i]->ray.direction,
                                    side[1].segments[i]->ray.direction) /
                             head_on;
        if (!(after > kNoSpread)) continue;
        // Bundles that stay as they are need no softening; softened are those that graze, and those that
        // the optics make parallel, where kappa would be infinite: directions so different in length along
        // one facet would cost an order of its error.
        const double softened = kSoftened * (after - before) / (after + before);
        look.kappa[i] = kappa_of(std::hypot(before, softened), std::hypot(after, softened));
    }
    if (!kept) look.beside.clear();
}

void set_corner_kappa(const Looking& looking, Look& look) {
    if (look.segments.size() > 1 ||
        (look.segments.size() == 1 && look.segments[0].step.event != Event::kReflect))
        set_kappa(looking, look);
    else
        look.kappa.assign(look.segments.size(), 1.0);
}

}  // namespace trilens
