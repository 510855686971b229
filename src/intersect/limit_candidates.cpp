// Which patches a ray may meet; whether segments meet an exact surface, without where: by its parts as a
// whole where these say it.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <memory>
#include <tuple>
#include <vector>

#include "intersect/limit_tracer_data.h"
#include "intersect/tracer.h"

namespace trilens {

// Keeps the patch if the ray passes within its stray, and some of it lies after t_min.
std::optional<LimitTracer::Data::Candidate> LimitTracer::Data::candidate(const RayFrame& frame,
                                                                         const RayPatch& patch,
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

LimitTracer::Data::Candidates LimitTracer::Data::candidates(const Query& query, Reach reach) const {
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

// `blocker`: a patch that the ray before this one met, which is asked first, or kNone.
bool LimitTracer::Data::meets(const Ray& ray, double t_min, double t_max, Id& blocker) const {
    if (surface.has_closed_form()) return surface.meets(ray, t_min, t_max);
    if (const auto known = polyhedron ? polyhedron->meets(ray, t_min, t_max) : std::nullopt) return *known;
    const std::optional<RayFrame> frame = make_ray_frame(ray);
    if (!frame) return false;
    const Query query{ray, *frame, t_min, t_max};
    if (blocker != kNone) {
        const auto one = candidate(*frame, patch(blocker), t_min);
        if (one && query.surely_meets(*one)) return true;
    }
    const Candidates candidates = this->candidates(query, Reach::kAnyBefore);
    if (candidates.complete_to == -kUnbounded) {
        blocker = candidates.found[0].patch;
        return true;
    }
    return meets_some(query, candidates.found);
}

// Whether it meets the surface where these parts are.
bool LimitTracer::Data::meets_parts(const Query& query, std::span<const PartTree::Open> parts) const {
    const RayStretch way = query.stretch();
    for (const PartTree::Open& open : parts)
        if (trilens::surely_meets(by_part->of(open.part).quad, query.frame, way.from, way.to)) return true;
    std::vector<Candidate> found;
    for (const PartTree::Open& open : parts) {
        const PartPatches::Part& part = by_part->of(open.part);
        for (std::uint64_t left = balls_met(part.balls, way); left != 0; left &= left - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(left));
            const auto one = candidate(query.frame, part.patches[i], query.t_min);
            if (!one || one->t_near > query.t_max) continue;
            if (query.surely_meets(*one)) return true;
            found.push_back(*one);
            found.back().patch = PartPatches::number(open.part, i);
        }
    }
    return meets_some(query, found);
}

// By parts, where the surface has them.
Segments::Bits LimitTracer::Data::find_occluded(const Segments& segments, Segments::Bits asked) const {
    const PartTree& parts = part_tree.get([&] { return std::make_unique<PartTree>(part_boxes); });
    PartTree::Found found =
        parts.find(segments, asked, [&](Id part) -> const PartQuad& { return by_part->of(part).quad; });
    Segments::Bits met = found.met;
    std::sort(found.open.begin(), found.open.end(), [](const PartTree::Open& a, const PartTree::Open& b) {
        return std::tie(a.segment, a.part) < std::tie(b.segment, b.part);
    });
    for (auto first = found.open.begin(), last = first; first != found.open.end(); first = last) {
        const std::size_t i = first->segment;
        last = std::find_if(first, found.open.end(), [i](const auto& one) { return one.segment != i; });
        if (met & Segments::bit(i)) continue;
        const Ray ray = segments.ray(i);
        const std::optional<RayFrame> frame = make_ray_frame(ray);
        if (frame && meets_parts({ray, *frame, 0, 1}, {first, last})) met |= Segments::bit(i);
    }
    for_each_of(found.unusual, [&](std::size_t i) {
        Id blocker = kNone;
        if (meets(segments.ray(i), 0, 1, blocker)) met |= Segments::bit(i);
    });
    return met;
}

bool LimitTracer::meets(const Ray& ray, double t_min, double t_max) const {
    Id blocker = kNone;
    return data_->meets(ray, t_min, t_max, blocker);
}

Segments::Bits LimitTracer::occluded(const Segments& segments, Segments::Bits asked) const {
    const Segments::Bits near = may_meet(segments, data_->around) & asked;
    if (near == 0) return 0;
    if (data_->by_part && !data_->polyhedron) return data_->find_occluded(segments, near);
    Segments::Bits found = 0;
    Id blocker = kNone;
    for_each_of(near, [&](std::size_t i) {
        if (data_->meets(segments.ray(i), 0, 1, blocker)) found |= Segments::bit(i);
    });
    return found;
}

}  // namespace trilens
