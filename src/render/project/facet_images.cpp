#include "render/project/facet_images.h"

#include <algorithm>
#include <limits>

#include "base/raymesh/check_data.h"
#include "render/frame/camera_media.h"

namespace trilens {
namespace {

/// What a ray meets within this share of its ends is where it begins or ends.
constexpr double kFreeShare = 1e-6;

/// A refined image further than this from its facet's image belongs to another one, in multiples of the
/// facet's size on the screen.
constexpr double kRefineReach = 2;

/// A camera for the law of reflection alone: all rays leave the eye, and every point is in front of it.
LinearCamera law_of_eye(const Vec3& eye) {
    LinearCamera camera;
    camera.eye = eye;
    camera.screen_x = {1, 0, 0, 0};
    camera.screen_y = {0, 1, 0, 0};
    camera.screen_w = {0, 0, 0, 1};
    return camera;
}

}  // namespace

SpecularQuery specular_query(const World& world, const Frame& frame, std::size_t index, Path path) {
    const Optic& optic = world.optics[index];
    SpecularQuery query;
    query.camera = frame.camera.linear ? *frame.camera.linear : law_of_eye(*frame.camera.model->eye());
    query.event = path == Path::kReflect ? SpecularEvent::kReflect : SpecularEvent::kRefract;
    query.own_normals = has_own_normals(world.scene.meshes[optic.mesh]);
    if (path == Path::kRefract) query.point_index = relative_ior(world, index, frame.camera_media.fixed);
    return query;
}

OpticImage optic_image(const SpecularPoint& exact, Id facet, const Vec2& pixel) {
    OpticImage image;
    image.facet = facet;
    image.pixel = pixel;
    image.t = exact.t;
    image.length = exact.distance;
    image.from = exact.position;
    image.at = exact.at;
    image.normal = exact.normal;
    image.refined = true;
    image.front = exact.front;
    return image;
}

FacetImages::FacetImages(const World& world, const Frame& frame, std::size_t optic, const PathMesh& path)
    : world_(world), frame_(frame), optic_(optic), path_(path), facets_(*frame.optics[optic].facets) {
    check_ray_mesh(path.mesh);
}

const FacetImages::Search& FacetImages::search() const {
    return search_.get([this] {
        const SurfaceGrid& grid = facets_.grid();
        return std::make_unique<Search>(Search{MeshPointImages(path_.mesh),
                                               facets_around(grid.facets, grid.points.size(), [&](Id corner) {
                                                   return grid.corner_point[corner];
                                               })});
    });
}

/// Whether the film shows this facet there, not another place of the same one.
bool FacetImages::is_shown(const MeshPointImage& image) const {
    const FramedOptic& optic = frame_.optics[optic_];
    return optic.mesh_facet(optic.grid_facet(image.facet), image.screen) == image.facet;
}

bool FacetImages::hidden(const MeshPointImage& image) const {
    const SurfaceGrid& grid = facets_.grid();
    const IdTriple& corner = grid.facets[frame_.optics[optic_].grid_facet(image.facet)];
    Vec3 on_facet(0);
    for (int k = 0; k < 3; ++k)
        on_facet += image.weights[k] * grid.points[grid.corner_point[corner[static_cast<std::size_t>(k)]]];
    const std::optional<Ray> view = exact_ray(frame_.camera, image.screen);
    if (!view) return true;
    const Vec3& eye = view->origin;
    return facets_.tracer().occluded({eye, on_facet - eye}, kFreeShare, 1 - kFreeShare);
}

bool FacetImages::shows_front(const MeshPointImage& image) const {
    const SurfaceGrid& grid = facets_.grid();
    const std::optional<Ray> view = exact_ray(frame_.camera, image.screen);
    return !view ||
           faces_front(grid, grid.facets[frame_.optics[optic_].grid_facet(image.facet)], view->direction);
}

std::optional<SpecularPoint> FacetImages::refined(const MeshPointImage& image, const Vec3& point) const {
    const Surface& surface = *world_.optics[optic_].surface;
    const SurfaceGrid& grid = facets_.grid();
    const IdTriple& corner = grid.facets[image.facet];
    Vec2 uv(0), low(std::numeric_limits<double>::max()), high(-low);
    for (int k = 0; k < 3; ++k) {
        const std::size_t c = static_cast<std::size_t>(k);
        uv += image.weights[k] * grid.facet_uv[image.facet][c];
        const Vec3 s = path_.mesh.screen[path_.mesh.facets[image.facet][c]];
        low = glm::min(low, Vec2(s.x, s.y) / s.z);
        high = glm::max(high, Vec2(s.x, s.y) / s.z);
    }

    SpecularQuery query = specular_query(world_, frame_, optic_, path_.path);
    query.point = point;
    const Vec3& at = grid.points[grid.corner_point[corner[0]]];
    if (!faces_front(grid, corner, incident_direction(query.camera, at)))
        std::swap(query.eye_index, query.point_index);

    // From the facet's own image; else from the facets around it, since the exact image may lie on a
    // neighbouring face.
    const double reach = kRefineReach * std::max(length(high - low), 1.0);
    const auto near = [&](const std::optional<SpecularPoint>& found) {
        return found && length(found->pixel - image.screen) <= reach;
    };
    std::optional<SpecularPoint> best =
        refine_specular_point(surface, {grid.facet_face[image.facet], uv}, query);
    if (near(best)) return best;
    best.reset();
    for (const Id c : corner) {
        for (const Id f : search().around.of(grid.corner_point[c])) {
            const auto& uvs = grid.facet_uv[f];
            const auto found =
                refine_specular_point(surface, {grid.facet_face[f], (uvs[0] + uvs[1] + uvs[2]) / 3.0}, query);
            if (near(found) &&
                (!best || length(found->pixel - image.screen) < length(best->pixel - image.screen)))
                best = found;
        }
    }
    return best;
}

std::vector<OpticImage> FacetImages::images(const Vec3& point, bool refine,
                                            std::vector<SpecularPoint> known) const {
    std::vector<OpticImage> images;
    for (const MeshPointImage& found : search().images.images(point)) {
        if (!is_shown(found) || hidden(found)) continue;
        const Ray ray = interpolated_ray(path_.mesh, found.facet, found.weights);
        const Id facet = frame_.optics[optic_].grid_facet(found.facet);
        OpticImage image;
        image.facet = facet;
        image.pixel = found.screen;
        image.t = found.t;
        image.length = found.t * length(ray.direction);
        image.from = ray.origin;
        image.front = shows_front(found);
        if (const auto exact = refine ? refined(found, point) : std::nullopt) {
            known.push_back(*exact);
            if (distinct_images(known).size() < known.size()) {
                known.pop_back();
                continue;
            }
            image = optic_image(*exact, facet, exact->pixel);
        }
        images.push_back(image);
    }
    return images;
}

}  // namespace trilens
