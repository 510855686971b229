#include "render/engines/certify_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/util/parallel.h"
#include "camera/linear/linear_cameras.h"

namespace trilens {
namespace {

constexpr std::size_t kProofsPerTask = 256;
constexpr double kRoomPixels = 1e-6;                // for the rounding of film places
constexpr std::array kHalfSides{1e-7, 1e-5, 1e-3};  // of the boxes on which a proof is tried
constexpr double kUnproven = std::numeric_limits<double>::infinity();

/// How far on the film points within `radius` of one that the camera sees at `pixel` may lie from there.
double film_radius(const LinearCamera& camera, const Vec3& point, const Vec2& pixel, double radius) {
    const double depth = screen_from_world(camera, point).z, change = length(Vec3(camera.screen_w));
    const double least = depth - change * radius;
    if (!(least > 0)) return std::numeric_limits<double>::infinity();
    const double x = length(Vec3(camera.screen_x)) + std::fabs(pixel.x) * change,
                 y = length(Vec3(camera.screen_y)) + std::fabs(pixel.y) * change;
    return std::hypot(x, y) * radius / least;
}

/// The colours of each stretch: light parts where it first goes through glass that disperses.
void set_colours(const World& world, Colours colours, std::vector<PathSegment>& history) {
    bool has_parted = false;
    for (PathSegment& segment : history) {
        const Material& material = world.scene.materials[world.optics[segment.step.optic].material];
        has_parted = has_parted || (segment.step.event == Event::kTransmit && material.dispersion > 0);
        segment.colours = has_parted ? colours : kAllColours;
    }
}

}  // namespace

SampleCertifier::SampleCertifier(const World& world, const Frame& frame) : world_(world), frame_(frame) {
    for (const Optic& optic : world.optics) {
        const bool is_own = frame.camera.linear && has_own_normals(world.scene.meshes[optic.mesh]);
        bounders_.push_back(is_own ? optic.surface->make_bounder() : nullptr);
    }
}

bool SampleCertifier::knows(std::span<const Step> steps) const {
    return std::ranges::all_of(steps, [&](const Step& step) { return bounders_[step.optic] != nullptr; });
}

/// Over one optic from the facet's own parameters. Else, and where these lead nowhere (across a face's
/// border), from the sample's exact path over the same steps.
std::optional<SolvedChain> SampleCertifier::path_of(const ProjectedSight& sight) const {
    const bool is_far = std::isinf(sight.t);
    const ProjectedPoint shown{
        is_far ? normalize(sight.ray.direction) : sight.ray.origin + sight.t * sight.ray.direction, is_far};
    // One colour of light where glass parts it; where it does not, all have the index of `ior`.
    const Colours colours = sight.colours;
    if (sight.steps.size() == 1) {
        const PathEvent event{sight.steps[0].optic, sight.steps[0].event, sight.front, sight.start.face,
                              sight.start.uv};
        if (auto path = solve_path(world_, frame_, {{&event, 1}, sight.pixel, colours}, shown)) return path;
    }
    HistoryQuery query = history_query(world_, frame_, sight.steps, shown.place);
    set_colours(world_, colours, query.history);
    const std::optional<HistoryPath> own = history_path(query, sight.pixel);
    if (!own) return std::nullopt;
    return solve_path(world_, frame_, {own->events, sight.pixel, colours}, shown);
}

/// Boxes of parameters around where a path meets its surfaces, cut at the borders of faces; none where one
/// reaches over the side of a triangle.
std::optional<ChainBox> SampleCertifier::box_around(const SolvedChain& path, std::span<const Step> steps,
                                                    double half) const {
    ChainBox box;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const SurfaceParameter& at = path.shape.at[i];
        const Vec2 low = glm::clamp(at.uv - half, 0.0, 1.0), high = glm::clamp(at.uv + half, 0.0, 1.0);
        const FaceDomain domain = world_.optics[steps[i].optic].surface->domain(at.face);
        if (domain == FaceDomain::kTriangle && !(high.x + high.y <= 1)) return std::nullopt;
        box.bounds.push_back(bounders_[steps[i].optic]->bounds(at.face, low, high));
        box.half.push_back(0.5 * (high - low));
    }
    return box;
}

std::optional<double> SampleCertifier::displacement_bound(const ProjectedSight& sight) const {
    if (!knows(sight.steps)) return std::nullopt;
    const std::optional<SolvedChain> path = path_of(sight);
    if (!path) return std::nullopt;
    const LinearCamera& camera = *frame_.camera.linear;
    for (const double half_side : kHalfSides) {
        const std::optional<ChainBox> box = box_around(*path, sight.steps, half_side);
        if (!box || !holds_one_path(path->chain, *box)) continue;
        const SurfaceBounds& first = box->bounds.front();
        const Vec3 screen = screen_from_world(camera, first.middle.position);
        if (!(screen.z > 0)) return std::nullopt;
        const Vec2 pixel = Vec2(screen) / screen.z;
        return length(pixel - sight.pixel) +
               film_radius(camera, first.middle.position, pixel, first.position_radius) + kRoomPixels;
    }
    return std::nullopt;
}

void certify_samples(const CertifyParams& params, SampleViews& views, PathEnds& ends,
                     std::vector<Id>& traced) {
    std::vector<double> bound(ends.ends.size(), kUnproven);
    parallel_for(ends.ends.size(), kProofsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const SampleView& view = views.samples[ends.sample[i]];
            const OpticView& on_optic = views.on_optic(view);
            const PathEnd& end = ends.ends[i];
            const auto proven = params.certifier.displacement_bound(
                {std::span(ends.steps).subspan(end.first_step, end.step_count),
                 end.colours,
                 {params.facets.facet_face[view.facet], on_optic.uv},
                 on_optic.incidence.front,
                 params.grid.position(ends.sample[i]),
                 end.ray,
                 end.hit.seen() ? end.hit.t : std::numeric_limits<double>::infinity()});
            if (proven && *proven <= params.limit) bound[i] = *proven;
        }
    });

    // A sample has the largest bound of its ends; those without one give all of them back.
    std::vector<double> largest(views.samples.size(), 0);
    for (std::size_t i = 0; i < ends.ends.size(); ++i)
        largest[ends.sample[i]] = std::max(largest[ends.sample[i]], bound[i]);
    std::vector<char> is_given_back(views.samples.size(), 0);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < ends.ends.size(); ++i) {
        const Id sample = ends.sample[i];
        if (largest[sample] < kUnproven) {
            views.of_optics[sample].bound = largest[sample];
            ends.ends[kept] = ends.ends[i];
            ends.sample[kept++] = sample;
        } else if (!is_given_back[sample]) {
            is_given_back[sample] = 1;
            traced.push_back(sample);
        }
    }
    ends.ends.resize(kept);
    ends.sample.resize(kept);
}

}  // namespace trilens
