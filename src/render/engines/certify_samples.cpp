#include "render/engines/certify_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/math/box.h"
#include "base/util/parallel.h"
#include "camera/linear/linear_cameras.h"
#include "specular/cell_bvh.h"

namespace trilens {
namespace {

constexpr std::size_t kProofsPerTask = 256;
constexpr double kFar = 1e9;          // times the size of what is seen: as good as infinitely far
constexpr double kRoomPixels = 1e-6;  // for the rounding of film places
constexpr std::array kHalfSides{1e-7, 1e-5, 1e-3};  // of the boxes on which a proof is tried

/// The box of parameters around a place, within the face's square.
CellBox box_around(const SurfaceParameter& at, double half) {
    return {at.face, glm::clamp(at.uv - half, 0.0, 1.0), glm::clamp(at.uv + half, 0.0, 1.0)};
}

/// Whether all of the box is the face's; a triangle ends at u + v = 1.
bool is_inside(const Surface& surface, const CellBox& box) {
    return surface.domain(box.face) == FaceDomain::kSquare || box.high.x + box.high.y <= 1;
}

/// How far on the film points within `radius` of one that the camera sees at `pixel` may lie from there.
double film_radius(const LinearCamera& camera, const Vec3& point, const Vec2& pixel, double radius) {
    const double depth = screen_from_world(camera, point).z, change = length(Vec3(camera.screen_w));
    const double least = depth - change * radius;
    if (!(least > 0)) return std::numeric_limits<double>::infinity();
    const double x = length(Vec3(camera.screen_x)) + std::fabs(pixel.x) * change,
                 y = length(Vec3(camera.screen_y)) + std::fabs(pixel.y) * change;
    return std::hypot(x, y) * radius / least;
}

/// Whether Krawczyk's operator maps the box into itself: there is one zero of the law in it then.
bool has_one_zero(const NewtonBounds& newton, const Vec2& half) {
    const Vec2 reach = glm::abs(newton.step) + newton.spread + newton.rounding + newton.shift;
    return newton.known && reach.x < half.x && reach.y < half.y && newton.spread.x < 0.5 * half.x &&
           newton.spread.y < 0.5 * half.y;
}

/// The only end of a sample, one reflection long.
bool is_one_reflection(const PathEnds& ends, std::size_t end) {
    const PathEnd& one = ends.ends[end];
    return one.step_count == 1 && ends.steps[one.first_step].event == Event::kReflect;
}

}  // namespace

SampleCertifier::SampleCertifier(const World& world, const Frame& frame, std::size_t optic)
    : world_(world), frame_(frame), optic_(optic) {
    const Optic& one = world.optics[optic];
    if (!frame.camera.linear || !one.mirror || !has_own_normals(world.scene.meshes[one.mesh])) return;
    Box box;
    box.include(frame.camera.linear->eye);
    for (const Vec3& point : frame.optics[optic].facets->grid().points) box.include(point);
    size_ = length(box.size());
    bounder_ = one.surface->make_bounder();
}

/// From the facet's own parameters; across a face's border, from where the sample's exact ray meets the
/// surface.
std::optional<SpecularPoint> SampleCertifier::image_of(const ReflectedSight& sight,
                                                       const SpecularQuery& query) const {
    const Surface& surface = *world_.optics[optic_].surface;
    if (auto image = refine_specular_point(surface, sight.start, query)) return image;
    const auto hit = limit_tracer(world_, optic_).first_hit(film_ray(*frame_.camera.linear, sight.pixel));
    if (!hit) return std::nullopt;
    return refine_specular_point(surface, SurfaceParameter{hit->face, hit->uv}, query);
}

std::optional<double> SampleCertifier::displacement_bound(const ReflectedSight& sight) const {
    if (!bounder_) return std::nullopt;
    const bool is_far = std::isinf(sight.t);
    SpecularQuery query;
    query.camera = *frame_.camera.linear;
    query.viewed = sight.front ? ViewedSide::kFront : ViewedSide::kBack;
    query.point = sight.ray.origin +
                  (is_far ? kFar * size_ / length(sight.ray.direction) : sight.t) * sight.ray.direction;
    const auto image = image_of(sight, query);
    if (!image) return std::nullopt;

    for (const double half_side : kHalfSides) {
        const CellBox box = box_around(image->at, half_side);
        if (!is_inside(*world_.optics[optic_].surface, box)) continue;
        const SurfaceBounds bounds = bounder_->bounds(box.face, box.low, box.high);
        // A direction's place at that distance from anywhere in the box instead of from the ray's start.
        const double room =
            is_far ? length(sight.ray.origin - bounds.middle.position) + bounds.position_radius : 0;
        const CellTerms terms = cell_terms(query, bounds, eye_view(query, place_of(bounds)));
        if (!has_one_zero(newton_bounds(terms, query.point, box.half(), room), box.half())) continue;
        const Vec3 screen = screen_from_world(query.camera, bounds.middle.position);
        const Vec2 pixel = Vec2(screen) / screen.z;
        return length(pixel - sight.pixel) +
               film_radius(query.camera, bounds.middle.position, pixel, bounds.position_radius) + kRoomPixels;
    }
    return std::nullopt;
}

void certify_samples(const CertifyParams& params, SampleViews& views, PathEnds& ends,
                     std::vector<Id>& traced) {
    constexpr double kUnproven = std::numeric_limits<double>::infinity();
    std::vector<Id> count(views.samples.size(), 0);
    for (const Id s : ends.sample) ++count[s];
    std::vector<double> bound(ends.ends.size(), kUnproven);
    parallel_for(ends.ends.size(), kProofsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const SampleView& view = views.samples[ends.sample[i]];
            if (count[ends.sample[i]] != 1 || view.nested > 0 || !is_one_reflection(ends, i)) continue;
            const OpticView& on_optic = views.on_optic(view);
            const PathEnd& end = ends.ends[i];
            const auto proven = params.certifier.displacement_bound(
                {{params.facets.facet_face[view.facet], on_optic.uv},
                 params.grid.position(ends.sample[i]),
                 end.ray,
                 end.hit.seen() ? end.hit.t : std::numeric_limits<double>::infinity(),
                 on_optic.incidence.front});
            if (proven && *proven <= params.limit) bound[i] = *proven;
        }
    });

    // Those without a bound give their ends back.
    std::vector<char> is_traced(views.samples.size(), 0);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < ends.ends.size(); ++i) {
        const Id sample = ends.sample[i];
        if (bound[i] < kUnproven) {
            views.of_optics[sample].bound = bound[i];
            ends.ends[kept] = ends.ends[i];
            ends.sample[kept++] = sample;
        } else if (!is_traced[sample]) {
            is_traced[sample] = 1;
            traced.push_back(sample);
        }
    }
    ends.ends.resize(kept);
    ends.sample.resize(kept);
}

}  // namespace trilens
