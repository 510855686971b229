// Candidates from the tree in a fixed order, Newton on each, until no candidate can be nearer.
#include "intersect/limit_tracer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "base/util/check.h"
#include "base/util/parallel.h"
#include "intersect/box_tree.h"
#include "intersect/convex_polyhedron.h"
#include "intersect/patch_tree.h"
#include "intersect/ray_patches.h"
#include "intersect/tracer.h"

namespace trilens {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr double kSelfHit = 1e-9;
constexpr std::size_t kFacetsPerTask = 256;

// A patch that bends by s off the plane of a facet of size h turns by about 4 s / h from its middle to its
// ends; the bend kept is twice what was seen, and rays within twice that angle of the surface may meet the
// patch twice; so may those within twice the angle by which it has turned from the facet where it is met.
constexpr double kGrazing = 4, kTurns = 2;

// Hits less far apart along the ray, as a share of the distances to the world's and the ray's origin over the
// cosine to the surface, are met at one place, at an edge or a corner that faces share: ten times what a hit
// is off. Below that cosine the two hits near a silhouette are one but for rounding.
constexpr double kSamePlace = 10 * kSurfaceResidual, kLeastCosine = 1e-6;

// How much wider than its patches the box around a surface is, as a share of itself: patches stray by what a
// few samples say.
constexpr double kRoomAround = 0.01;

/// A patch that the ray may meet.
struct Candidate {
    double t_near = 0, t_far = 0;  // it meets none before and none after these
    bool is_crossed = false;       // it goes through the facet itself
    bool is_met = false;           // it surely meets the patch, after t_near and before t_far
    Id patch = kNone;
    Vec3 weights{0};                              // of the facet's point nearest to the ray
    int nearest_corner = 0, farthest_corner = 0;  // along the ray
};

/// Candidates from near to far, and up to which t_near all of them are there.
struct Candidates {
    std::vector<Candidate> found;
    double complete_to = kUnbounded;
};

/// Which candidates are looked for: all, or those that may come before the first facet that the ray goes
/// straight through, behind which it seldom goes on without a hit; or all before some t, or only one that is
/// surely met before it.
enum class Reach { kToFirst, kAll, kAnyBefore };

/// What is met so far behind t, at most, is met at the same place.
double tie_behind(const RayFrame& frame, double t, double cosine) {
    const double distances = 2 * length(frame.origin) / frame.speed + std::fabs(t);
    return kSamePlace * distances / std::max(std::fabs(cosine), kLeastCosine);
}

/// Whether the one is met before the other: of two at the same place the one whose turn it is (see
/// first_hit), whichever is nearer by rounding.
bool is_met_before(const RayFrame& frame, const SurfaceHit& one, const SurfaceHit& other) {
    const double a = dot(one.point.normal, frame.z), b = dot(other.point.normal, frame.z);
    const double least = std::min(std::fabs(a), std::fabs(b));
    if (std::fabs(one.t - other.t) > tie_behind(frame, other.t, least)) return one.t < other.t;
    return std::make_tuple(a > 0, one.face, one.t) < std::make_tuple(b > 0, other.face, other.t);
}

/// Where the surface has no normal.
Vec3 normal_for(const Surface& surface, const RayPatch& patch) {
    const Vec3 chord = chord_normal(patch);
    if (chord != Vec3(0)) return chord;
    return surface.eval_first_order(patch.face, (patch.uv[0] + patch.uv[1] + patch.uv[2]) / 3.0).normal;
}

/// The least sine of an angle to a patch, at a hit with that normal, at which a ray meets it only once.
double steep_from(const RayPatch& patch, const Vec3& normal) {
    const Vec3 chord = chord_normal(patch);
    const double turned = length(normal - (dot(chord, normal) < 0 ? -chord : chord));
    return std::max(kGrazing * double{patch.bend}, kTurns * turned);
}

}  // namespace

struct LimitTracer::Data {
    const Surface& surface;
    std::vector<RayPatch> patches;
    std::unique_ptr<PartPatches> by_part;  // else these, where the tree is one of parts
    double largest_patch = 0;              // of `patches`: none is longer along any ray, its stray included
    double size = 0;                       // half diagonal of a box about every face's corners and middle
    Box around;                            // holds every hit
    BoxTree tree;
    std::optional<ConvexPolyhedron> polyhedron = ConvexPolyhedron::of(surface);

    Data(const Surface& exact, const SurfaceGrid& fine, const std::string& isa)
        : surface(exact),
          patches(make_patches(exact, fine)),
          largest_patch(largest_of(patches)),
          size(half_diagonal(exact)),
          around(box_around()),
          tree(boxes(), isa) {}
    Data(const Surface& exact, const Parts& fine, const std::string& isa)
        : surface(exact),
          by_part(std::make_unique<PartPatches>(exact, fine.boxes.size(), fine.grid)),
          size(0.5 * length(box_of_all(fine.boxes).size())),
          around(box_of_all(fine.boxes)),
          tree(fine.boxes, isa) {}

    const RayPatch& patch(Id number) const { return by_part ? by_part->patch(number) : patches[number]; }

    static Box box_of_all(const std::vector<Box>& parts) {
        Box box;
        for (const Box& part : parts) box.include(part);
        return box;
    }
    static std::vector<RayPatch> make_patches(const Surface& surface, const SurfaceGrid& fine) {
        if (surface.has_closed_form()) return {};
        std::vector<RayPatch> patches(fine.facets.size());
        parallel_for(patches.size(), kFacetsPerTask, [&](std::size_t first, std::size_t last) {
            for (std::size_t f = first; f < last; ++f) patches[f] = make_ray_patch(surface, fine, f);
        });
        return patches;
    }
    static double largest_of(const std::vector<RayPatch>& patches) {
        double largest = 0;
        for (const RayPatch& patch : patches) largest = std::max(largest, patch.size + patch.stray);
        return kRayStraySafety * largest;
    }
    static double half_diagonal(const Surface& surface) {
        Vec3 low(kUnbounded), high(-kUnbounded);
        for (Id face = 0; face < surface.face_count(); ++face) {
            for (const Vec2& uv : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1), Vec2(1, 1), Vec2(0.5, 0.5)}) {
                const Vec3 p = surface.eval_first_order(face, uv).position;
                low = glm::min(low, p), high = glm::max(high, p);
            }
        }
        return surface.face_count() > 0 ? 0.5 * length(high - low) : 0;
    }
    Box box_around() const {
        Box box;
        for (const RayPatch& patch : patches) box.include(box_of(patch));
        if (surface.has_closed_form()) box = box_of(surface);
        const Vec3 room = kRoomAround * box.size() + Vec3(kSelfHit * size);
        return {box.low - room, box.high + room};
    }
    std::vector<Box> boxes() const {
        std::vector<Box> result;
        result.reserve(patches.size());
        for (const RayPatch& patch : patches) result.push_back(box_of(patch));
        return result;
    }

    static std::optional<Candidate> candidate(const RayFrame& frame, const RayPatch& patch, double t_min);
    struct Query {
        const Ray& ray;
        const RayFrame& frame;
        double t_min = 0, t_max = kUnbounded;

        RayStretch stretch() const {
            return {frame.origin, frame.z, t_min * frame.speed, t_max * frame.speed};
        }
        /// Whether the candidate's patch is surely met on the way.
        bool surely_meets(const Candidate& one) const {
            return one.is_met && one.t_near > t_min && one.t_far < t_max;
        }
    };
    Candidates candidates(const Query& query, Reach reach) const;
    bool surely_meets_near(const Query& query, Id& patch) const;
    bool meets(const Ray& ray, double t_min, double t_max, Id& blocker) const;
    template <typename Use>
    void for_each_hit(const Ray& ray, const RayFrame& frame, const Candidate& candidate, Use&& use) const;
};

// Keeps the patch if the ray passes within its stray, and some of it lies after t_min.
std::optional<Candidate> LimitTracer::Data::candidate(const RayFrame& frame, const RayPatch& patch,
                                                      double t_min) {
    PlaneTriangle seen;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 local = patch.corner[k] - frame.origin;
        seen[k] = {dot(frame.x, local), dot(frame.y, local)};
    }
    if (is_surely_beyond(seen, patch.stray)) return std::nullopt;
    Vec3 z;
    for (int k = 0; k < 3; ++k) z[k] = dot(frame.z, patch.corner[k] - frame.origin);
    const int low = z.x <= z.y && z.x <= z.z ? 0 : z.y <= z.z ? 1 : 2;
    const int high = z.x >= z.y && z.x >= z.z ? 0 : z.y >= z.z ? 1 : 2;
    const double t_far = (z[high] + patch.stray) / frame.speed;
    if (!(t_far > t_min)) return std::nullopt;
    const NearestToOrigin nearest = nearest_to_origin(seen);
    if (!(nearest.distance <= patch.stray)) return std::nullopt;
    return Candidate{(z[low] - patch.stray) / frame.speed,
                     t_far,
                     nearest.distance == 0,
                     nearest.distance == 0 && surely_covers_origin(seen, patch.stray),
                     kNone,
                     nearest.weights,
                     low,
                     high};
}

Candidates LimitTracer::Data::candidates(const Query& query, Reach reach) const {
    Candidates candidates;
    std::vector<Candidate>& found = candidates.found;
    double& complete_to = candidates.complete_to;
    complete_to = query.t_max;
    // A ray comes into the box of a patch no later than so much after its t_near. The box of a part holds the
    // surface itself: where the ray has not come into it the part has no hit.
    const double beyond = by_part ? 0 : largest_patch / query.frame.speed;
    const auto look_at = [&](const RayPatch& patch, Id number) {
        const auto one = candidate(query.frame, patch, query.t_min);
        if (!one || one->t_near > complete_to) return;
        found.push_back(*one);
        found.back().patch = number;
        if (reach == Reach::kAnyBefore && query.surely_meets(*one)) {
            found.assign(1, found.back());
            complete_to = -kUnbounded;
            return;
        }
        if (reach == Reach::kToFirst && one->is_crossed && one->t_near > query.t_min)
            complete_to = std::min(complete_to, one->t_far + tie_behind(query.frame, one->t_far, 1));
    };
    tree.visit(query.ray, query.t_min, query.t_max + beyond, [&](Id box) {
        if (!by_part) {
            look_at(patches[box], box);
        } else {
            const PartPatches::Part& part = by_part->of(box);
            for (std::uint64_t left = balls_met(part.balls, query.stretch());
                 left != 0 && complete_to != -kUnbounded; left &= left - 1) {
                const auto i = static_cast<std::size_t>(std::countr_zero(left));
                look_at(part.patches[i], PartPatches::number(box, i));
            }
        }
        return complete_to + beyond;
    });
    if (complete_to == -kUnbounded) return candidates;
    std::erase_if(found, [&](const Candidate& one) { return !(one.t_near <= complete_to); });
    // The order of Embree's visits depends on the machine; this order does not.
    std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
        return a.t_near != b.t_near ? a.t_near < b.t_near : a.patch < b.patch;
    });
    return candidates;
}

// Whether the ray surely meets `patch`, or one of the same part, which it then becomes.
bool LimitTracer::Data::surely_meets_near(const Query& query, Id& patch) const {
    const auto surely_meets = [&](const RayPatch& one) {
        const auto met = candidate(query.frame, one, query.t_min);
        return met && query.surely_meets(*met);
    };
    if (surely_meets(this->patch(patch))) return true;
    if (!by_part) return false;
    const Id number = PartPatches::part_of(patch);
    const PartPatches::Part& part = by_part->of(number);
    for (std::uint64_t left = balls_met(part.balls, query.stretch()); left != 0; left &= left - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(left));
        if (!surely_meets(part.patches[i])) continue;
        patch = PartPatches::number(number, i);
        return true;
    }
    return false;
}

// Calls use(hit) for the hits that Newton's method reaches in the candidate's patch, with any t, some perhaps
// twice.
template <typename Use>
void LimitTracer::Data::for_each_hit(const Ray& ray, const RayFrame& frame, const Candidate& candidate,
                                     Use&& use) const {
    const RayPatch& patch = this->patch(candidate.patch);
    const auto solve = [&](const Vec2& uv) {
        const auto hit = solve_surface_hit(surface, frame, {patch.face, uv, patch.reach});
        if (hit) use(*hit);
        return hit;
    };
    const Vec3& w = candidate.weights;
    const auto hit = solve(w.x * patch.uv[0] + w.y * patch.uv[1] + w.z * patch.uv[2]);
    const bool steep =
        hit && std::fabs(dot(hit->point.normal, frame.z)) > steep_from(patch, hit->point.normal);
    if (steep) return;

    // Near a silhouette a patch is met twice, and the hit found may be the farther one.
    const auto predicted = [&](SurfaceHit full) {
        full.point = surface.eval(full.face, full.uv);
        return predict_second_hit(full, ray.direction);
    };
    const auto second = hit ? predicted(*hit) : std::nullopt;
    if (second && std::fabs(second->t_step) * frame.speed <= 2 * patch.size) solve(second->uv);
    solve(patch.uv[candidate.nearest_corner]);
    solve(patch.uv[candidate.farthest_corner]);
}

LimitTracer::LimitTracer(const Surface& surface, const SurfaceGrid& fine, const std::string& isa)
    : data_(std::make_unique<Data>(surface, fine, isa)) {}
LimitTracer::LimitTracer(const Surface& surface, const Parts& fine, const std::string& isa)
    : data_(std::make_unique<Data>(surface, fine, isa)) {}
LimitTracer::~LimitTracer() = default;
LimitTracer::LimitTracer(LimitTracer&&) noexcept = default;
LimitTracer& LimitTracer::operator=(LimitTracer&&) noexcept = default;

bool LimitTracer::is_polyhedron() const {
    return data_->polyhedron.has_value();
}

std::optional<SurfaceHit> LimitTracer::first_hit(const Ray& ray, double t_min) const {
    const Surface& surface = data_->surface;
    if (surface.has_closed_form()) return surface.intersect(ray, t_min);
    std::optional<SurfaceHit> first;
    if (data_->polyhedron && data_->polyhedron->find_first_hit(ray, t_min, first)) return first;
    const std::optional<RayFrame> frame = make_ray_frame(ray);
    if (!frame) return std::nullopt;

    double first_until = kUnbounded;  // what is met no farther away may come before it
    double tried = -kUnbounded;
    for (const Reach reach : {Reach::kToFirst, Reach::kAll}) {
        const Candidates candidates = data_->candidates({ray, *frame, t_min}, reach);
        for (const Candidate& candidate : candidates.found) {
            if (candidate.t_near <= tried) continue;
            if (first && candidate.t_near > first_until) return first;
            const RayPatch& patch = data_->patch(candidate.patch);
            data_->for_each_hit(ray, *frame, candidate, [&](const SurfaceHit& found) {
                if (!(found.t > t_min)) return;
                SurfaceHit hit = found;
                if (hit.point.normal == Vec3(0)) hit.point.normal = normal_for(surface, patch);
                if (first && !is_met_before(*frame, hit, *first)) return;
                first = hit;
                first_until = hit.t + tie_behind(*frame, hit.t, dot(hit.point.normal, frame->z));
            });
        }
        tried = candidates.complete_to;
        if (tried == kUnbounded || (first && first_until <= tried)) break;
    }
    return first;
}

// `blocker`: a patch that the ray before this one met, which is asked first, or kNone.
bool LimitTracer::Data::meets(const Ray& ray, double t_min, double t_max, Id& blocker) const {
    if (surface.has_closed_form()) return surface.meets(ray, t_min, t_max);
    if (const auto known = polyhedron ? polyhedron->meets(ray, t_min, t_max) : std::nullopt) return *known;
    const std::optional<RayFrame> frame = make_ray_frame(ray);
    if (!frame) return false;
    const Query query{ray, *frame, t_min, t_max};
    if (blocker != kNone && surely_meets_near(query, blocker)) return true;
    const Candidates candidates = this->candidates(query, Reach::kAnyBefore);
    if (candidates.complete_to == -kUnbounded) {
        blocker = candidates.found[0].patch;
        return true;
    }
    bool met = false;
    for (const Candidate& candidate : candidates.found) {
        for_each_hit(ray, *frame, candidate,
                     [&](const SurfaceHit& hit) { met = met || (hit.t > t_min && hit.t < t_max); });
        if (met) break;
    }
    return met;
}

bool LimitTracer::meets(const Ray& ray, double t_min, double t_max) const {
    Id blocker = kNone;
    return data_->meets(ray, t_min, t_max, blocker);
}

Segments::Bits LimitTracer::occluded(const Segments& segments, Segments::Bits asked) const {
    Segments::Bits found = 0;
    Id blocker = kNone;
    for_each_of(may_meet(segments, data_->around) & asked, [&](std::size_t i) {
        if (data_->meets(segments.ray(i), 0, 1, blocker)) found |= Segments::bit(i);
    });
    return found;
}

double LimitTracer::self_hit_t_min(const Ray& ray) const {
    const double speed = length(ray.direction);
    return speed > 0 ? kSelfHit * data_->size / speed : 0;
}

double LimitTracer::size() const {
    return data_->size;
}

}  // namespace trilens
