#include "render/project.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "base/facets_around.h"
#include "base/parallel.h"
#include "camera/specular_point.h"
#include "render/frame.h"
#include "trilinear/mesh_point_images.h"

namespace trilens {
namespace {

/// A segment is free if what it meets lies within this share of its ends.
constexpr double kFreeShare = 1e-6;

/// A point nearer to the eye's plane than this share of the coordinates has no direct image: rounding put it
/// there.
constexpr double kLeastDepth = 1e-12;

/// A refined image further than this from its facet's image belongs to another one, in multiples of the
/// facet's size on the screen.
constexpr double kRefineReach = 2;

/// One RayMesh that may image points.
struct ImagingMesh {
    Path path = Path::kDirect;
    Id optic = kNone;
    const RayMesh* mesh = nullptr;
    std::unique_ptr<MeshPointImages> images;
};

class PointProjector {
  public:
    PointProjector(const World& world, const ProjectRequest& request);
    std::vector<WorldImage> images(const Vec3& point) const;

  private:
    void add_optic(Id index);
    void add_direct(const Vec3& point, std::vector<WorldImage>& images) const;
    void add_through(const ImagingMesh& path, const Vec3& point, std::vector<WorldImage>& images) const;
    bool own_optic_hides(const ImagingMesh& path, const MeshPointImage& image) const;
    std::optional<SpecularPoint> refined(const ImagingMesh& path, const MeshPointImage& image,
                                         const Vec3& point) const;
    bool on_film(const Vec2& pixel) const;
    bool is_free(const Vec3& from, const Vec3& to) const;

    const SurfaceGrid& grid(Id optic) const { return frame_.optics[optic].facets->grid(); }

    const World& world_;
    ProjectRequest request_;
    Frame frame_;
    const CameraRays& camera_ = frame_.camera;
    std::vector<FacetsAround> around_;  // per optic: facets at each point of its grid
    std::vector<ImagingMesh> paths_;
};

PointProjector::PointProjector(const World& world, const ProjectRequest& request)
    : world_(world), request_(request), frame_(make_frame(world, request.frame, {})) {
    if (!camera_.linear) {
        paths_.push_back(
            {Path::kDirect, kNone, &camera_.mesh, std::make_unique<MeshPointImages>(camera_.mesh)});
        return;
    }
    for (Id i = 0; i < frame_.optics.size(); ++i) add_optic(i);
}

void PointProjector::add_optic(Id index) {
    const SurfaceGrid& surface = grid(index);
    around_.push_back(facets_around(surface.facets, surface.points.size(),
                                    [&](Id corner) { return surface.corner_point[corner]; }));
    for (const PathMesh& path : frame_.optics[index].paths)
        if (!path.mesh.facets.empty())
            paths_.push_back({path.path, index, &path.mesh, std::make_unique<MeshPointImages>(path.mesh)});
}

bool PointProjector::on_film(const Vec2& pixel) const {
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x <= world_.scene.film.width &&
           pixel.y <= world_.scene.film.height;
}

bool PointProjector::is_free(const Vec3& from, const Vec3& to) const {
    return !object_tracer(world_).occluded({from, to - from}, kFreeShare, 1 - kFreeShare);
}

void PointProjector::add_direct(const Vec3& point, std::vector<WorldImage>& images) const {
    const Vec3 screen = screen_from_world(*camera_.linear, point);
    // Nor has the eye itself an image, which rounding may put in front of it.
    const double depth = kLeastDepth * (length(camera_.linear->eye) + length(point));
    if (!(screen.z > (camera_.linear->parallel ? 0 : depth))) return;
    WorldImage image;
    image.pixel = Vec2(screen.x, screen.y) / screen.z;
    image.t = screen.z;
    image.length = length(point - camera_.linear->eye);
    image.inside = on_film(image.pixel);
    image.refined = true;
    if (request_.visibility) {
        image.visible = image.inside && is_free(camera_.linear->eye, point);
        for (const FramedOptic& optic : frame_.optics)
            if (optic.facets->tracer().occluded({camera_.linear->eye, point - camera_.linear->eye},
                                                kFreeShare, 1 - kFreeShare))
                image.visible = false;
    }
    images.push_back(image);
}

bool PointProjector::own_optic_hides(const ImagingMesh& path, const MeshPointImage& image) const {
    const SurfaceGrid& surface = grid(path.optic);
    const IdTriple& corner = surface.facets[image.facet];
    Vec3 on_facet(0);
    for (int k = 0; k < 3; ++k)
        on_facet +=
            image.weights[k] * surface.points[surface.corner_point[corner[static_cast<std::size_t>(k)]]];
    const Ray sight{camera_.linear->eye, on_facet - camera_.linear->eye};
    return frame_.optics[path.optic].facets->tracer().occluded(sight, kFreeShare, 1 - kFreeShare);
}

std::optional<SpecularPoint> PointProjector::refined(const ImagingMesh& path, const MeshPointImage& image,
                                                     const Vec3& point) const {
    const Optic& optic = world_.optics[path.optic];
    const SurfaceGrid& surface = grid(path.optic);
    const IdTriple& corner = surface.facets[image.facet];
    Vec2 uv(0), low(std::numeric_limits<double>::max()), high(-low);
    for (int k = 0; k < 3; ++k) {
        const std::size_t c = static_cast<std::size_t>(k);
        uv += image.weights[k] * surface.facet_uv[image.facet][c];
        const Vec3 s = path.mesh->screen[path.mesh->facets[image.facet][c]];
        low = glm::min(low, Vec2(s.x, s.y) / s.z);
        high = glm::max(high, Vec2(s.x, s.y) / s.z);
    }

    SpecularQuery query;
    query.camera = *camera_.linear;
    query.point = point;
    query.event = path.path == Path::kReflect ? SpecularEvent::kReflect : SpecularEvent::kRefract;
    query.own_normals = world_.scene.meshes[optic.mesh].normals.type == NormalOverride::Type::kSmooth;
    if (query.event == SpecularEvent::kRefract) {
        const Vec3& at = surface.points[surface.corner_point[corner[0]]];
        const bool front = faces_front(surface, corner, incident_direction(query.camera, at));
        const double ior = world_.scene.materials[optic.material].ior;
        query.eye_index = front ? 1 : ior;
        query.point_index = front ? ior : 1;
    }

    // From the facet's own image; else from the facets around it, since the exact image may lie on a
    // neighbouring face.
    const double reach = kRefineReach * std::max(length(high - low), 1.0);
    const auto near = [&](const std::optional<SpecularPoint>& found) {
        return found && length(found->pixel - image.screen) <= reach;
    };
    std::optional<SpecularPoint> best =
        refine_specular_point(*optic.surface, {surface.facet_face[image.facet], uv}, query);
    if (near(best)) return best;
    best.reset();
    for (const Id c : corner) {
        for (const Id f : around_[path.optic].of(surface.corner_point[c])) {
            const auto& uvs = surface.facet_uv[f];
            const auto found = refine_specular_point(
                *optic.surface, {surface.facet_face[f], (uvs[0] + uvs[1] + uvs[2]) / 3.0}, query);
            if (near(found) &&
                (!best || length(found->pixel - image.screen) < length(best->pixel - image.screen)))
                best = found;
        }
    }
    return best;
}

void PointProjector::add_through(const ImagingMesh& path, const Vec3& point,
                                 std::vector<WorldImage>& images) const {
    std::vector<SpecularPoint> taken;
    for (const MeshPointImage& found : path.images->images(point)) {
        WorldImage image;
        image.path = path.path;
        image.optic = path.optic;
        if (path.optic != kNone) image.object = world_.optics[path.optic].mesh;
        image.facet = found.facet;
        image.pixel = found.screen;
        image.t = found.t;
        const Ray ray = interpolated_ray(*path.mesh, found.facet, found.weights);
        image.length = found.t * length(ray.direction);
        Vec3 from = ray.origin;
        if (path.optic != kNone) {
            if (own_optic_hides(path, found)) continue;
            if (const auto exact = request_.refine ? refined(path, found, point) : std::nullopt) {
                // Two facets may lead to one exact image.
                taken.push_back(*exact);
                if (distinct_images(taken).size() < taken.size()) {
                    taken.pop_back();
                    continue;
                }
                image.pixel = exact->pixel;
                image.t = exact->t;
                image.length = exact->distance;
                image.refined = true;
                from = exact->position;
            }
        }
        image.inside = on_film(image.pixel);
        if (request_.visibility)
            image.visible = image.inside && is_free(from, point) &&
                            (path.optic == kNone || is_free(camera_.linear->eye, from));
        images.push_back(image);
    }
}

std::vector<WorldImage> PointProjector::images(const Vec3& point) const {
    std::vector<WorldImage> images;
    if (camera_.linear && world_.scene.render.direct) add_direct(point, images);
    for (const ImagingMesh& path : paths_) add_through(path, point, images);
    return images;
}

}  // namespace

std::vector<std::vector<WorldImage>> project_points(const World& world, const ProjectRequest& request,
                                                    std::span<const Vec3> points) {
    const PointProjector projector(world, request);
    std::vector<std::vector<WorldImage>> result(points.size());
    parallel_for(points.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) result[i] = projector.images(points[i]);
    });
    return result;
}

}  // namespace trilens
