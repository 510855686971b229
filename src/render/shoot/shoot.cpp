#include "render/shoot/shoot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/parallel.h"
#include "render/engines/path_ends.h"
#include "render/frame/camera_rays.h"
#include "render/world/world.h"

namespace trilens {

EventWord::EventWord(std::string_view letters) : letters_(letters) {
    if (letters.empty() || letters.size() > kMost)
        throw UsageError(fmt::format("a path has 1..{} events, not {}", kMost, letters.size()));
    if (!is_direct() && letters.find_first_not_of("RT?") != std::string_view::npos)
        throw UsageError(fmt::format(
            "the path \"{}\" holds a letter other than R (reflected), T (transmitted) and "
            "? (either), and is not D (seen directly); P, where glass has no interface, is left out",
            letters));
}

bool EventWord::allows(std::size_t place, Event event) const {
    if (letters_.empty() || event == Event::kPass) return true;
    if (place >= size()) return false;
    return letters_[place] == '?' || (letters_[place] == 'R') == (event == Event::kReflect);
}

/// How many letters a beginning of a history takes; none where it is not the word's.
std::optional<std::size_t> EventWord::place_after(std::span<const Step> steps) const {
    std::size_t place = 0;
    for (const Step& step : steps) {
        if (!allows(place, step.event)) return std::nullopt;
        place += step.event != Event::kPass;
    }
    return place;
}

bool EventWord::is(std::span<const Step> steps) const {
    const std::optional<std::size_t> place = place_after(steps);
    return place && (letters_.empty() || *place == size());
}

bool EventWord::may_begin(std::span<const Step> steps) const {
    return place_after(steps).has_value();
}

namespace {

constexpr std::size_t kRaysPerTask = 256;
/// Meetings of one path at the most, those without an interface among them.
constexpr std::size_t kMostMeetings = 256;

struct StartingRay {
    Ray ray;                                                 // any length; zero: there is none
    double reach = std::numeric_limits<double>::infinity();  // t beyond which it sees nothing
};

double light_of(const Branch& way) {
    return way.weight.x + way.weight.y + way.weight.z;
}

/// Follows rays one after the other along one path each.
class Shooter {
  public:
    Shooter(const World& world, const CameraMedia& media, const EventWord& word)
        : world_(world),
          paths_(path_world(world)),
          objects_(object_tracer(world)),
          media_(media),
          word_(word) {}

    void shoot(const StartingRay& start, ShotRay& shot, std::vector<PathEvent>& events) const;

  private:
    /// The path so far.
    struct Way {
        Media media;
        Colours colours = kAllColours;
        std::size_t letters = 0;  // of the word that are done
    };

    const Branch* choose(const Branches& ways, const Way& way, bool is_first) const;
    bool ends_at(const Way& way, std::size_t meetings) const;
    void end_at(const Hit& hit, double distance, ShotRay& shot) const;
    void follow(const Ray& view, const FirstSurface& first, ShotRay& shot,
                std::vector<PathEvent>& events) const;

    const World& world_;
    const PathWorld& paths_;
    const Tracer& objects_;
    const CameraMedia& media_;
    const EventWord& word_;
};

/// The strongest way that is wanted; null: none is.
const Branch* Shooter::choose(const Branches& ways, const Way& way, bool is_first) const {
    const Branch* best = nullptr;
    double most = 0;
    for (const Branch& one : ways) {
        const Event event = one.step.event;
        if (is_first && !(event == Event::kReflect ? paths_.reflect : paths_.refract)) continue;
        if (!word_.allows(way.letters, event)) continue;
        // The colours of glass that disperses count together, and the first of them stands for all.
        double light = 0;
        for (const Branch& other : ways)
            if (other.step.event == event) light += light_of(other);
        if (best && !(light > most)) continue;
        best = &one;
        most = light;
    }
    return best;
}

/// Whether nothing that follows counts: what is asked for ends here.
bool Shooter::ends_at(const Way& way, std::size_t meetings) const {
    if (meetings >= kMostMeetings) return true;
    const auto depth = static_cast<std::size_t>(paths_.max_depth) + 1;
    return word_.asks() ? way.letters == word_.size() && way.letters >= depth : way.letters >= depth;
}

void Shooter::end_at(const Hit& hit, double distance, ShotRay& shot) const {
    if (!hit.seen()) {
        shot.state = ShotState::kEscapes;
        return;
    }
    shot.state = ShotState::kSeen;
    shot.object = world_.objects.object[hit.triangle];
    shot.primitive = world_.objects.primitive[hit.triangle];
    shot.position = position(world_.objects, hit);
    shot.t = distance;
}

void Shooter::follow(const Ray& view, const FirstSurface& first, ShotRay& shot,
                     std::vector<PathEvent>& events) const {
    Way way{media_.of(view)};
    Meeting at{first.optic, normalize(view.direction), first.at.point.position, first.at.point.normal, true};
    at.front = dot(at.incoming, at.normal) <= 0;
    SurfaceHit hit = first.at;
    shot.weight =
        body_transmittance(paths_, active_medium(paths_, way.media), hit.t * length(view.direction));
    while (true) {
        const Branches ways = branches(paths_, at, way.media, way.colours);
        const Branch* chosen = choose(ways, way, shot.event_count == 0);
        if (!chosen) {
            shot.state = ways.empty() ? ShotState::kLost : ShotState::kOtherPath;
            return;
        }
        events.push_back({at.optic, chosen->step.event, at.front, hit.face, hit.uv, at.point, at.normal});
        ++shot.event_count;
        way.letters += chosen->step.event != Event::kPass;
        way.media = chosen->media;
        way.colours = chosen->colours;
        shot.weight *= chosen->weight;
        shot.origin = at.point;
        shot.direction = chosen->direction;

        const Ray out{shot.origin, shot.direction};
        std::optional<NextOptic> next = next_optic(paths_, {out, at.optic, way.media});
        const Hit object = objects_.first_hit(out);
        if (next && object.seen() && object.t <= next->distance + next->touch) next.reset();
        shot.cut = next && ends_at(way, shot.event_count);
        const Id medium = active_medium(paths_, way.media);
        if (!next || shot.cut) {
            if (word_.asks() && way.letters != word_.size()) {
                shot.state = ShotState::kOtherPath;
                return;
            }
            if (object.seen()) shot.weight *= body_transmittance(paths_, medium, object.t);
            end_at(object, object.t, shot);
            return;
        }
        shot.weight *= body_transmittance(paths_, medium, next->distance);
        at = next->meeting;
        hit = next->hit;
    }
}

void Shooter::shoot(const StartingRay& start, ShotRay& shot, std::vector<PathEvent>& events) const {
    const Ray& ray = start.ray;
    const double size = length(ray.direction);
    if (!(size > 0) || !std::isfinite(size) || !std::isfinite(length(ray.origin))) return;
    shot.first_event = events.size();
    shot.origin = ray.origin;
    shot.direction = ray.direction / size;
    const FirstSurface first = first_surface(paths_, objects_, ray, start.reach);
    if (first.optic != kNone) {
        follow(ray, first, shot, events);
    } else if (word_.asks() && !word_.is_direct()) {
        shot.state = ShotState::kOtherPath;
    } else {
        if (first.object.seen())
            shot.weight =
                body_transmittance(paths_, active_medium(paths_, media_.of(ray)), first.object.t * size);
        end_at(first.object, first.object.t * size, shot);
    }
    if (shot.followed()) return;
    events.resize(shot.first_event);
    const ShotState state = shot.state;
    shot = {};
    shot.state = state;
}

/// `starting(i)`: the ray of place i.
template <typename Starting>
ShotRays shoot_each(const Shooter& shooter, std::size_t count, const Starting& starting) {
    ShotRays shots;
    shots.rays.resize(count);
    const std::size_t tasks = (count + kRaysPerTask - 1) / kRaysPerTask;
    std::vector<std::vector<PathEvent>> events(tasks);
    parallel_for(tasks, 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t task = from; task < to; ++task)
            for (std::size_t i = task * kRaysPerTask; i < std::min(count, (task + 1) * kRaysPerTask); ++i)
                shooter.shoot(starting(i), shots.rays[i], events[task]);
    });
    for (std::size_t task = 0; task < tasks; ++task) {
        for (std::size_t i = task * kRaysPerTask; i < std::min(count, (task + 1) * kRaysPerTask); ++i)
            shots.rays[i].first_event += shots.events.size();
        shots.events.insert(shots.events.end(), events[task].begin(), events[task].end());
    }
    return shots;
}

}  // namespace

ShotRays shoot_places(const World& world, const ShootRequest& request, std::span<const Vec2> places) {
    const CameraRays camera = make_camera_rays(world.scene, request.camera);
    const CameraMedia media = camera_media_of(world, camera);
    const double reach = camera.far_depth - camera.near_depth;
    return shoot_each(Shooter(world, media, request.path), places.size(), [&](std::size_t i) {
        return StartingRay{exact_ray(camera, places[i]).value_or(Ray{}), reach};
    });
}

namespace {

/// As it is, but for its length: by a power of two near 1, so that its square neither overflows nor vanishes.
Ray of_usual_length(Ray ray) {
    const Vec3 size = abs(ray.direction);
    const double most = std::max({size.x, size.y, size.z});
    if (!(most > 0) || !std::isfinite(most)) return ray;
    for (int k = 0; k < 3; ++k) ray.direction[k] = std::scalbn(ray.direction[k], -std::ilogb(most));
    return ray;
}

}  // namespace

ShotRays shoot_rays(const World& world, const ShootRequest& request, std::span<const Ray> rays) {
    const CameraMedia media = media_by_ray(world);
    return shoot_each(Shooter(world, media, request.path), rays.size(),
                      [&](std::size_t i) { return StartingRay{of_usual_length(rays[i])}; });
}

}  // namespace trilens
