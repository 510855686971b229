#include "paths/trace/follow.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/raymesh/triangle_scene.h"
#include "base/util/few.h"

namespace trilens {
namespace {

/// Steps on one path at the most, whatever the depth: passing through surfaces without an interface counts
/// for nothing else.
constexpr std::size_t kMostSteps = 256;

/// So often looks go on where an optic lies on an object.
constexpr int kMostRests = 2;

/// Whether the next optic lies on an object where the ray meets it.
bool lies_on_object(const PathWorld& world, const Ray& ray, const NextOptic& next) {
    return world.objects &&
           world.objects->occluded(ray, next.distance - next.touch, next.distance + next.touch);
}

/// Of what leaves the first optic in these colours.
Vec3 first_weight(Colours colours) {
    if (colours == kAllColours) return Vec3(1);
    Vec3 weight(0);
    weight[colours] = 1;
    return weight;
}

LegBefore before_paths(const PathWorld& world, const PathStart& start) {
    return {active_medium(world, start.around), start.way, start.first.point};
}

LegBefore leg_of(const PathSegment& segment) {
    return {segment.medium, segment.next, segment.ray.origin + segment.next * segment.ray.direction,
            segment.has_start};
}

/// A branch that waits to be followed.
struct Pending {
    Branch branch;
    Id parent = kNone;
    Path path = Path::kReflect;
    bool principal = true;
    int rested = 0;  // it came so often to where an optic lies on an object
    std::uint16_t depth = 0;
    std::size_t steps = 1;
    Vec3 point{0};
    double way = 0;
    double turned = 1;
    bool front = true;
    Vec3 first_weight{1}, weight{1};
    double lobe = 0;
    std::uint64_t only = ~std::uint64_t{0};  // of FollowParams::only, whose way it goes; a bit each
};

class Follower {
  public:
    Follower(const PathWorld& world, const FollowParams& params, FollowedPaths& followed)
        : world_(world), params_(params), followed_(followed) {}
    void follow(const PathStart& begin);

  private:
    void start(const PathStart& from);
    void run(const Pending& from);
    void go_on(const Pending& from, Id segment, const NextOptic& next);
    /// The meeting after `before` others.
    Meeting turned(const Meeting& at, std::size_t before) const {
        return params_.rough ? with_microfacet(world_, at, params_.rough->place(before)) : at;
    }

    /// Of those of `among` the ones that have the step after `before` others.
    std::uint64_t that_go(const Step& step, std::size_t before, std::uint64_t among) const;

    const PathWorld& world_;
    const FollowParams& params_;
    FollowedPaths& followed_;
    Few<Pending, 16> waiting_;
    LegBefore camera_leg_;
    std::array<Vec3, 2> faint_behind_{Vec3(0), Vec3(0)};  // of paths that reflect first, and refract
};

std::uint64_t Follower::that_go(const Step& step, std::size_t before, std::uint64_t among) const {
    if (params_.only.empty()) return among;
    std::uint64_t go = 0;
    for (std::size_t i = 0; i < params_.only.size(); ++i) {
        const std::vector<Step>& steps = *params_.only[i];
        const std::uint64_t bit = std::uint64_t{1} << i;
        if ((among & bit) && before < steps.size() && steps[before] == step) go |= bit;
    }
    return go;
}

void Follower::start(const PathStart& from) {
    const Meeting first = turned(from.first, 0);
    const Branches ways = branches(world_, first, from.around, kAllColours);
    if (ways.empty() && first.microfacet == Vec3(0)) followed_.cut.lost += Vec3(1);
    for (auto way_on = ways.rbegin(); way_on != ways.rend(); ++way_on) {
        const bool reflects = way_on->step.event == Event::kReflect;
        if (!(reflects ? world_.reflect : world_.refract)) continue;
        Pending pending;
        pending.branch = *way_on;
        pending.only = that_go(way_on->step, 0, pending.only);
        if (pending.only == 0) continue;
        pending.path = reflects ? Path::kReflect : Path::kRefract;
        pending.principal = reflects || way_on->principal;
        pending.point = first.point;
        pending.way = from.way;
        pending.turned = std::fabs(dot(first.incoming, first.normal));
        pending.front = first.front;
        pending.first_weight = way_on->weight;
        pending.weight = first_weight(way_on->colours);
        pending.lobe = way_on->lobe;
        waiting_.push_back(pending);
    }
}

void Follower::go_on(const Pending& from, Id segment, const NextOptic& next) {
    const Meeting meeting = turned(next.meeting, from.steps);
    const Branches ways = branches(world_, meeting, from.branch.media, from.branch.colours);
    if (ways.empty() && meeting.microfacet == Vec3(0)) followed_.cut.lost += from.first_weight * from.weight;
    const PathSegment& parent = followed_.segments[segment];
    const Vec3 arrived = from.weight * body_transmittance(world_, parent.medium, next.distance);
    for (auto way_on = ways.rbegin(); way_on != ways.rend(); ++way_on) {
        const std::uint64_t only = that_go(way_on->step, from.steps, from.only);
        if (only == 0) continue;
        Pending pending = from;
        pending.only = only;
        pending.branch = *way_on;
        pending.parent = segment;
        pending.principal = from.principal && way_on->principal;
        pending.depth = static_cast<std::uint16_t>(from.depth + (way_on->step.event != Event::kPass));
        pending.steps = from.steps + 1;
        pending.point = next.meeting.point;
        pending.way = from.way + next.distance;
        pending.turned = std::fabs(dot(next.meeting.incoming, next.meeting.normal));
        pending.front = next.meeting.front;
        pending.weight = arrived * way_on->weight;
        pending.lobe = from.lobe + way_on->lobe;
        waiting_.push_back(pending);
    }
}

void Follower::run(const Pending& from) {
    const Vec3 light = from.first_weight * from.weight;
    if (!from.principal && of_worst_colour(light) < params_.least_weight) {
        followed_.cut.faint += light;
        faint_behind_[from.path == Path::kRefract] += from.weight;
        return;
    }
    PathSegment segment;
    segment.parent = from.parent;
    segment.step = from.branch.step;
    segment.path = from.path;
    segment.principal = from.principal;
    segment.colours = from.branch.colours;
    segment.depth = from.depth;
    segment.medium = active_medium(world_, from.branch.media);
    segment.has_start =
        has_start(world_, segment.step, segment.medium,
                  from.parent == kNone ? camera_leg_ : leg_of(followed_.segments[from.parent]));
    segment.ray = {from.point, from.branch.direction};
    segment.way = from.way;
    segment.first_weight = from.first_weight;
    segment.weight = from.weight;
    segment.turned = from.turned;
    segment.front = from.front;
    segment.refraction = from.branch.refraction;
    segment.lobe = from.lobe;

    std::optional<NextOptic> next;
    if (world_.max_depth > 0)
        next = next_optic(world_, {segment.ray, from.branch.step.optic, from.branch.media});
    if (params_.objects) {
        // An object that an optic lies on is seen in it.
        segment.hit = next ? params_.objects->first_hit(segment.ray, 0, next->distance + next->touch)
                           : params_.objects->first_hit(segment.ray);
        if (segment.hit.seen()) next.reset();
    }
    // Where rays are looked at for others beside them, what would follow tells them apart: so it is
    // followed, but not for ever.
    const bool rests = next && !params_.objects && lies_on_object(world_, segment.ray, *next);
    if (rests) segment.rest = next->distance;
    if (rests && from.rested >= kMostRests) next.reset();
    if (next && (from.depth >= world_.max_depth || from.steps >= kMostSteps)) {
        followed_.cut.too_deep += light;
        segment.cut = next->distance;
        if (params_.objects) segment.hit = params_.objects->first_hit(segment.ray);
        next.reset();
    }
    if (next) {
        segment.next = next->distance;
        segment.to_mirror = world_.optics[next->meeting.optic].mirror;
    }
    segment.ends = !next;
    followed_.segments.push_back(segment);
    if (!next) return;
    Pending on = from;
    on.rested = from.rested + rests;
    go_on(on, static_cast<Id>(followed_.segments.size() - 1), *next);
}

void Follower::follow(const PathStart& begin) {
    camera_leg_ = before_paths(world_, begin);
    start(begin);
    while (!waiting_.empty()) {
        const Pending from = waiting_.back();
        waiting_.pop_back();
        run(from);
    }
    followed_.cut.faint_behind = glm::max(faint_behind_[0], faint_behind_[1]);
}

NextOptic next_at(Id optic, const Ray& ray, const SurfaceHit& hit, double touch) {
    NextOptic next;
    next.distance = std::max(hit.t, 0.0);
    next.touch = touch;
    next.hit = hit;
    Meeting& at = next.meeting;
    at.optic = optic;
    at.incoming = ray.direction;
    at.point = hit.point.position;
    at.normal = hit.point.normal;
    at.front = dot(ray.direction, at.normal) <= 0;
    return next;
}

/// The ray's first meeting with one optic. Where it starts on another one that touches this, it meets this
/// one's glass there if it comes into a body in which it is not yet, or leaves one in which it is.
std::optional<NextOptic> meet(const PathWorld& world, Id optic, const LeavingRay& leaving) {
    const PathOptic& asked = world.optics[optic];
    const Ray& ray = leaving.ray;
    const double touch = asked.tracer->self_hit_t_min(ray);
    if (leaving.from != kNone && leaving.from != optic) {
        const auto hit = asked.tracer->first_hit({ray.origin - touch * ray.direction, ray.direction});
        if (!hit) return std::nullopt;
        SurfaceHit here = *hit;
        here.t -= touch;
        const NextOptic next = next_at(optic, ray, here, touch);
        if (here.t > touch || (!asked.mirror && next.meeting.front != leaving.media.holds(optic)))
            return next;
    }
    const auto hit = asked.tracer->first_hit(ray, leaving.from == kNone ? 0 : touch);
    if (!hit) return std::nullopt;
    return next_at(optic, ray, *hit, touch);
}

std::pair<int, int> turn_of(const PathWorld& world, const NextOptic& next) {
    return coincident_order(world.optics[next.meeting.optic], next.meeting.front);
}

}  // namespace

const Branch* same_branch(const Branches& ways, const PathSegment& like) {
    for (const Branch& one : ways)
        if (one.step == like.step && one.colours == like.colours) return &one;
    return nullptr;
}

std::optional<NextOptic> next_optic(const PathWorld& world, const LeavingRay& leaving) {
    if (world.optics.size() == 1) return meet(world, 0, leaving);
    std::vector<NextOptic> met;
    for (std::size_t i = 0; i < world.optics.size(); ++i)
        if (const auto one = meet(world, static_cast<Id>(i), leaving)) met.push_back(*one);
    if (met.empty()) return std::nullopt;
    const NextOptic& nearest = *std::min_element(
        met.begin(), met.end(), [](const auto& a, const auto& b) { return a.distance < b.distance; });
    const NextOptic* first = nullptr;
    for (const NextOptic& one : met) {
        if (one.distance > nearest.distance + std::max(one.touch, nearest.touch)) continue;
        if (!first || turn_of(world, one) < turn_of(world, *first)) first = &one;
    }
    return *first;
}

bool has_start(const PathWorld& world, const Step& step, Id medium, const LegBefore& before) {
    if (medium == kNone) return true;
    if (step.event == Event::kReflect) return world.optics[step.optic].mirror;
    if (before.medium == kNone) return false;
    return before.length > 2 * same_place(before.end) || before.has_start;
}

FollowedPaths follow_paths(const PathWorld& world, const PathStart& start, const FollowParams& params) {
    FollowedPaths followed;
    follow_paths(world, start, params, followed);
    return followed;
}

void follow_paths(const PathWorld& world, const PathStart& start, const FollowParams& params,
                  FollowedPaths& followed) {
    followed.segments.clear();
    followed.cut = {};
    Follower(world, params, followed).follow(start);
}

std::vector<std::optional<PathSegment>> repeat_paths(const PathWorld& world, const PathStart& start,
                                                     const std::vector<PathSegment>& like) {
    struct Arrived {
        Branches ways;  // from the optic at the segment's far end
        Meeting meeting;
        double way = 0;
        Vec3 weight{1};
    };
    const Arrived begin{branches(world, start.first, start.around, kAllColours), start.first, start.way};
    std::vector<Arrived> after(like.size());
    std::vector<std::optional<PathSegment>> again(like.size());
    for (std::size_t i = 0; i < like.size(); ++i) {
        PathSegment segment = like[i];
        const Arrived& from = segment.parent == kNone ? begin : after[segment.parent];
        const Branch* branch = same_branch(from.ways, segment);
        if (!branch) continue;
        segment.ray = {from.meeting.point, branch->direction};
        segment.way = from.way;
        segment.weight =
            segment.parent == kNone ? first_weight(segment.colours) : from.weight * branch->weight;
        segment.medium = active_medium(world, branch->media);
        segment.turned = std::fabs(dot(from.meeting.incoming, from.meeting.normal));
        segment.refraction = branch->refraction;
        if (!segment.ends) {
            const std::optional<NextOptic> next =
                next_optic(world, {segment.ray, segment.step.optic, branch->media});
            if (!next) continue;
            segment.next = next->distance;
            after[i] = {branches(world, next->meeting, branch->media, branch->colours), next->meeting,
                        from.way + next->distance,
                        segment.weight * body_transmittance(world, segment.medium, next->distance)};
        }
        again[i] = segment;
    }
    return again;
}

}  // namespace trilens
