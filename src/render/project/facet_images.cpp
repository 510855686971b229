#include "render/project/path_images.h"

#include <algorithm>
#include <limits>

#include "base/raymesh/sample_grid.h"
#include "render/frame/camera_rays.h"
#include "render/project/image_light.h"
#include "render/project/point_projector.h"

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

// Where the film shows what searches on an optic's exact surface found.

namespace {

/// An image through the facets this near to an exact one, in pixels, is taken for the same.
constexpr double kSameImage = 3;

/// An exact image farther from the facets' than this, in pixels, is another one.
constexpr double kFilmReach = 16;

}  // namespace

/// Of a camera with an eye whose film is not linear, the images as points of the surface; their pixels mean
/// nothing but tell them apart.
std::vector<SpecularSearch> PointProjector::search(const OpticPath& path, std::span<const Vec3> points,
                                                   const SearchLimits& limits) const {
    if (!searches_surfaces()) return std::vector<SpecularSearch>(points.size());
    const SpecularQuery query = specular_query(world_, frame_, path.optic, path.path);
    const SpecularSearcher& searcher = *searcher_[path.optic];
    return path.path == Path::kRefract ? searcher.find_each_in_body(query, points, limits)
                                       : searcher.find_each(query, points, limits);
}

/// Where the film shows what a search found on the surface.
std::vector<OpticImage> PointProjector::images_on_film(const OpticPath& path,
                                                       const SpecularSearch& searched) const {
    std::vector<OpticImage> images;
    for (const SpecularPoint& exact : searched.images) {
        const Id facet = facets_at_[path.optic].at(exact.at.face, exact.at.uv);
        const auto add = [&](const Vec2& pixel) { images.push_back(optic_image(exact, facet, pixel)); };
        if (camera_.linear) add(exact.pixel);
        if (camera_.model)
            for (const FilmImage& image : film_positions(camera_, exact.position)) add(image.pixel);
    }
    return images;
}

namespace {

/// A facets' image, moved to an exact one.
OpticImage on_film_image(const HistoryImage& exact, OpticImage image) {
    const PathEvent& last = exact.events.back();
    image.pixel = exact.pixel;
    image.t = exact.distance / exact.first_way;
    image.length = exact.distance;
    image.from = last.point;
    image.at = {last.face, last.uv};
    image.normal = last.normal;
    image.refined = true;
    return image;
}

}  // namespace

/// Through a camera without one eye: each image of the facets is moved to where the exact ray passes through
/// the point; two that come to one place count once, and where the film is searched as well one that comes to
/// none does not count.
void PointProjector::refine_on_film(const OpticPath& path, const Vec3& point,
                                    std::vector<OpticImage>& images) const {
    const Event event = path.path == Path::kReflect ? Event::kReflect : Event::kTransmit;
    const Step step{path.optic, event};
    const HistoryQuery query = history_query(world_, frame_, {&step, 1}, point);
    std::vector<OpticImage> kept;
    for (OpticImage image : images) {
        const auto exact = refine_history_image(query, image.pixel);
        if (exact && length(exact->pixel - image.pixel) < kFilmReach) image = on_film_image(*exact, image);
        const bool known = std::any_of(kept.begin(), kept.end(), [&](const OpticImage& one) {
            return one.refined && image.refined && length(one.pixel - image.pixel) < kSamePixels;
        });
        if (!known && (image.refined || !searches_film())) kept.push_back(image);
    }
    images = std::move(kept);
}

std::vector<OpticImage> PointProjector::optic_images(const OpticPath& path, const Vec3& point,
                                                     const SpecularSearch& searched,
                                                     PointProjection& result) const {
    if (!searches_surfaces()) {
        result.complete = false;
        std::vector<OpticImage> images =
            path.facets->images(point, request_.refine && camera_.linear.has_value());
        if (request_.refine && !camera_.linear) refine_on_film(path, point, images);
        return images;
    }
    std::vector<OpticImage> found = images_on_film(path, searched);
    if (searched.complete) return found;
    result.complete = false;
    const bool refine = camera_.linear.has_value();
    const std::size_t exact = found.size();
    for (const OpticImage& more :
         path.facets->images(point, refine, refine ? searched.images : std::vector<SpecularPoint>())) {
        const auto is_known = [&](const OpticImage& known) {
            return !refine && length(known.pixel - more.pixel) < kSameImage;
        };
        const auto end = found.begin() + static_cast<std::ptrdiff_t>(exact);
        if (std::none_of(found.begin(), end, is_known)) found.push_back(more);
    }
    return found;
}

}  // namespace trilens
