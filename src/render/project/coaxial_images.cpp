#include "render/project/coaxial_images.h"

#include <algorithm>

#include "render/frame/camera_rays.h"
#include "render/project/path_starts.h"
#include "render/world/world.h"

namespace trilens {
namespace {

/// Exact rays that look for the runs of one history, at most.
constexpr std::size_t kMostRunRays = 16;
/// Rays are one that differ by no more, in directions and as a share of the way from the eye.
constexpr double kSameRay = 1e-9;

/// The facet's corners on the film; none where one lies behind the eye.
std::optional<std::array<Vec2, 3>> film_corners(const RayMesh& mesh, std::size_t facet) {
    if (!mesh.has_rays(facet)) return std::nullopt;
    std::array<Vec2, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& screen = mesh.screen[mesh.facets[facet][k]];
        if (!(screen.z > 0)) return std::nullopt;
        corner[k] = Vec2(screen) / screen.z;
    }
    return corner;
}

}  // namespace

bool CoaxialImages::Triangle::holds(const Vec2& pixel) const {
    const auto side = [&](std::size_t a, std::size_t b) {
        return cross(corner[b] - corner[a], pixel - corner[a]);
    };
    const double ab = side(0, 1), bc = side(1, 2), ca = side(2, 0);
    return (ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0);
}

CoaxialImages::CoaxialImages(const World& world, const Frame& frame, const HistoryFacets& facets)
    : world_(world), frame_(frame) {
    const bool has_eye = frame.camera.linear && !frame.camera.linear->parallel;
    if (!has_eye || frame.camera_media.by_ray || !may_have_runs(facets.chain)) return;
    find_runs(facets);
    if (!runs_.empty()) hold_facets(facets);
}

/// Whether the steps are few, and their surfaces spheres, or with flat faces, and normals of their own.
bool CoaxialImages::may_have_runs(std::span<const PathSegment> chain) const {
    if (chain.size() > kFewEvents) return false;
    bool are_spheres = true, have_planes = true;
    for (const PathSegment& segment : chain) {
        const Optic& optic = world_.optics[segment.step.optic];
        if (!has_own_normals(world_.scene.meshes[optic.mesh])) return false;
        are_spheres = are_spheres && optic.surface->sphere_curvature() > 0;
        bool is_flat = false;
        for (Id face = 0; face < optic.surface->face_count() && !is_flat; ++face)
            is_flat = optic.surface->is_flat(face);
        have_planes = have_planes && is_flat;
    }
    return are_spheres || have_planes;
}

void CoaxialImages::add_run(const std::vector<PathEvent>& events, const Vec2& pixel) {
    const std::optional<PathChain> chain = chain_from(world_, frame_, {events, pixel});
    if (!chain) return;
    PerEvent<ChainFace> faces;
    for (const PathEvent& event : events) faces.push_back({event.face, event.front});
    if (auto coaxial = CoaxialChain::of(*chain, faces)) runs_.push_back({std::move(*coaxial), events});
}

void CoaxialImages::find_runs(const HistoryFacets& facets) {
    HistoryQuery query = history_query(world_, frame_, {}, {});
    query.history.assign(facets.chain.begin(), facets.chain.end());
    std::vector<std::array<Vec2, 3>> proven;
    for (std::size_t f = 0; f < facets.mesh.facets.size(); ++f)
        if (const auto corner = film_corners(facets.mesh, f); corner && facets.proven[f])
            proven.push_back(*corner);
    const std::size_t stride = proven.size() / kMostRunRays + 1;
    for (std::size_t i = stride / 2; i < proven.size() && !hold_all(); i += stride) {
        if (is_held(proven[i])) continue;
        const Vec2 middle = (proven[i][0] + proven[i][1] + proven[i][2]) / 3.0;
        const std::optional<HistoryPath> path = history_path(query, middle);
        if (path && !hold(path->events)) add_run(path->events, middle);
    }
}

/// Whether all rays of a triangle of the film go over the faces of one run.
bool CoaxialImages::is_held(const std::array<Vec2, 3>& corner) const {
    std::array<Vec3, 3> directions;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::optional<Ray> ray = exact_ray(frame_.camera, corner[k]);
        if (!ray) return false;
        directions[k] = ray->direction;
    }
    return std::any_of(runs_.begin(), runs_.end(),
                       [&](const Run& run) { return run.chain.holds_rays_between(directions); });
}

void CoaxialImages::hold_facets(const HistoryFacets& facets) {
    const Id optic = facets.chain[0].step.optic;
    const SurfaceGrid& grid = frame_.optics[optic].facets->grid();
    facet_at_.emplace(grid, world_.optics[optic].surface->face_count());
    held_.assign(facets.mesh.facets.size(), 0);
    std::vector<std::vector<Triangle>> by_facet(grid.facets.size());
    for (std::size_t f = 0; f < facets.mesh.facets.size(); ++f) {
        const auto corner = film_corners(facets.mesh, f);
        if (!corner || !facets.proven[f] || !is_held(*corner)) continue;
        held_[f] = 1;
        by_facet[facets.grid_facet[f]].push_back({*corner});
    }
    first_.push_back(0);
    for (const std::vector<Triangle>& some : by_facet) {
        triangles_.insert(triangles_.end(), some.begin(), some.end());
        first_.push_back(triangles_.size());
    }
}

bool CoaxialImages::hold(const Vec2& pixel, const Ray& exit) const {
    const std::optional<Ray> ray = exact_ray(frame_.camera, pixel);
    return ray && std::any_of(runs_.begin(), runs_.end(), [&](const Run& run) {
               const std::optional<Ray> last = run.chain.last_ray(ray->direction);
               return last && length(last->direction - exit.direction) < kSameRay &&
                      length(last->origin - exit.origin) < kSameRay * length(exit.origin - ray->origin);
           });
}

/// Whether a path is one of a run.
bool CoaxialImages::hold(std::span<const PathEvent> events) const {
    return std::any_of(runs_.begin(), runs_.end(), [&](const Run& run) {
        return run.chain.are_planes() ? same_faces(events, run.events) : events.size() == run.events.size();
    });
}

std::optional<CoaxialImage> CoaxialImages::image(std::size_t run, const Vec3& point) const {
    const auto path = runs_[run].chain.path_to(point);
    if (!path) return std::nullopt;
    const auto film = film_place(frame_.camera, path->places[0], Vec2(0));
    if (!film) return std::nullopt;
    CoaxialImage found;
    ChainImage& image = found.image;
    image.film = *film;
    image.events = runs_[run].events;
    for (std::size_t i = 0; i < image.events.size(); ++i) {
        PathEvent& event = image.events[i];
        event.face = path->at[i].face;
        event.uv = path->at[i].uv;
        event.point = path->places[i];
        event.normal = path->normals[i];
    }
    for (std::size_t axis = 0; axis < 2; ++axis)
        image.derivative[axis] = film->slope[axis] * path->first_by_point;

    found.facet = facet_at_->at(image.events[0].face, image.events[0].uv);
    if (found.facet != kNone)
        found.is_proven =
            std::any_of(triangles_.begin() + static_cast<std::ptrdiff_t>(first_[found.facet]),
                        triangles_.begin() + static_cast<std::ptrdiff_t>(first_[found.facet + 1]),
                        [&](const Triangle& triangle) { return triangle.holds(film->pixel); });
    return found;
}

}  // namespace trilens
