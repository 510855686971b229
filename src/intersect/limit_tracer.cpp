// Candidates from the tree in a fixed order, Newton on each, until no candidate can be nearer.
#include "intersect/limit_tracer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <vector>

#include "base/util/parallel.h"
#include "intersect/limit_tracer_data.h"
#include "intersect/tracer.h"

namespace trilens {
namespace {

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

Box box_of_all(const std::vector<Box>& parts) {
    Box box;
    for (const Box& part : parts) box.include(part);
    return box;
}

std::vector<RayPatch> make_patches(const Surface& surface, const SurfaceGrid& fine) {
    if (surface.has_closed_form()) return {};
    std::vector<RayPatch> patches(fine.facets.size());
    parallel_for(patches.size(), kFacetsPerTask, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) patches[f] = make_ray_patch(surface, fine, f);
    });
    return patches;
}

double largest_of(const std::vector<RayPatch>& patches) {
    double largest = 0;
    for (const RayPatch& patch : patches) largest = std::max(largest, patch.size + patch.stray);
    return kRayStraySafety * largest;
}

double half_diagonal(const Surface& surface) {
    Vec3 low(INFINITY), high(-INFINITY);
    for (Id face = 0; face < surface.face_count(); ++face) {
        for (const Vec2& uv : {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1), Vec2(1, 1), Vec2(0.5, 0.5)}) {
            const Vec3 p = surface.eval_first_order(face, uv).position;
            low = glm::min(low, p), high = glm::max(high, p);
        }
    }
    return surface.face_count() > 0 ? 0.5 * length(high - low) : 0;
}

std::vector<Box> boxes_of(const std::vector<RayPatch>& patches) {
    std::vector<Box> result;
    result.reserve(patches.size());
    for (const RayPatch& patch : patches) result.push_back(box_of(patch));
    return result;
}

/// `size`: the surface's.
Box box_around(const Surface& surface, const std::vector<RayPatch>& patches, double size) {
    const Box box = surface.has_closed_form() ? box_of(surface) : box_of_all(boxes_of(patches));
    const Vec3 room = kRoomAround * box.size() + Vec3(kSelfHit * size);
    return {box.low - room, box.high + room};
}

}  // namespace

double LimitTracer::Data::tie_behind(const RayFrame& frame, double t, double cosine) {
    const double distances = 2 * length(frame.origin) / frame.speed + std::fabs(t);
    return kSamePlace * distances / std::max(std::fabs(cosine), kLeastCosine);
}

bool LimitTracer::Data::is_met_before(const RayFrame& frame, const SurfaceHit& one, const SurfaceHit& other) {
    const double a = dot(one.point.normal, frame.z), b = dot(other.point.normal, frame.z);
    const double least = std::min(std::fabs(a), std::fabs(b));
    if (std::fabs(one.t - other.t) > tie_behind(frame, other.t, least)) return one.t < other.t;
    return std::make_tuple(a > 0, one.face, one.t) < std::make_tuple(b > 0, other.face, other.t);
}

LimitTracer::Data::Data(const Surface& exact, const SurfaceGrid& fine, const std::string& isa)
    : surface(exact),
      patches(make_patches(exact, fine)),
      largest_patch(largest_of(patches)),
      size(half_diagonal(exact)),
      around(box_around(exact, patches, size)),
      tree(boxes_of(patches), isa) {}

LimitTracer::Data::Data(const Surface& exact, const Parts& fine, const std::string& isa)
    : surface(exact),
      by_part(std::make_unique<PartPatches>(exact, fine.boxes.size(), fine.grid)),
      size(0.5 * length(box_of_all(fine.boxes).size())),
      around(box_of_all(fine.boxes)),
      tree(fine.boxes, isa),
      part_boxes(fine.boxes) {}

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

    double first_until = Data::kUnbounded;  // what is met no farther away may come before it
    double tried = -Data::kUnbounded;
    for (const Data::Reach reach : {Data::Reach::kToFirst, Data::Reach::kAll}) {
        const Data::Candidates candidates = data_->candidates({ray, *frame, t_min}, reach);
        for (const Data::Candidate& candidate : candidates.found) {
            if (candidate.t_near <= tried) continue;
            if (first && candidate.t_near > first_until) return first;
            const RayPatch& patch = data_->patch(candidate.patch);
            data_->for_each_hit(ray, *frame, candidate, [&](const SurfaceHit& found) {
                if (!(found.t > t_min)) return;
                SurfaceHit hit = found;
                if (hit.point.normal == Vec3(0)) hit.point.normal = normal_for(surface, patch);
                if (first && !Data::is_met_before(*frame, hit, *first)) return;
                first = hit;
                first_until = hit.t + Data::tie_behind(*frame, hit.t, dot(hit.point.normal, frame->z));
            });
        }
        tried = candidates.complete_to;
        if (tried == Data::kUnbounded || (first && first_until <= tried)) break;
    }
    return first;
}

bool LimitTracer::Data::meets_some(const Query& query, std::span<const Candidate> candidates) const {
    bool met = false;
    for (std::size_t k = 0; k < candidates.size() && !met; ++k)
        for_each_hit(query.ray, query.frame, candidates[k], [&](const SurfaceHit& hit) {
            met = met || (hit.t > query.t_min && hit.t < query.t_max);
        });
    return met;
}

double LimitTracer::self_hit_t_min(const Ray& ray) const {
    const double speed = length(ray.direction);
    return speed > 0 ? kSelfHit * data_->size / speed : 0;
}

double LimitTracer::size() const {
    return data_->size;
}

}  // namespace trilens
