#include "render/project/film_moves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

#include "render/project/point_projector.h"
#include "render/world/world.h"

namespace trilens {
namespace {

/// An image moves by this many times what its derivative says, at most, within a query's reach.
constexpr double kMostGrowth = 2;

/// A world of optics alone: objects keep their places in the list.
std::shared_ptr<const World> world_of_optics(Scene scene) {
    for (Mesh& mesh : scene.meshes)
        if (mesh.role == Role::kObject) mesh.object = {};
    scene.volumes.clear();
    scene.points.clear();
    scene.labels.clear();
    scene.lights.clear();
    return make_world(std::move(scene), {});
}

double distance_to_film(const FilmSize& film, const Vec2& pixel) {
    const Vec2 size(film.width, film.height);
    return length(pixel - glm::clamp(pixel, Vec2(0), size));
}

/// The pixels that a unit step moves an image by, at most: the derivative's larger singular value.
double steepest(const std::array<Vec3, 2>& rows) {
    const double xx = dot(rows[0], rows[0]), yy = dot(rows[1], rows[1]), xy = dot(rows[0], rows[1]);
    return std::sqrt(0.5 * (xx + yy + std::hypot(xx - yy, 2 * xy)));
}

/// Whether the film may show places within a query's reach: they are on the inner side of the planes through
/// its edges. Screen coordinates are linear over w.
bool may_be_shown(const LinearCamera& camera, const FilmSize& film, const FilmMoveQuery& query) {
    const auto is_inside = [&](const Vec4& plane) {
        return dot(plane, Vec4(query.place, 1)) >= -query.reach * length(Vec3(plane));
    };
    const Vec4 &x = camera.screen_x, &y = camera.screen_y, &w = camera.screen_w;
    return is_inside(x) && is_inside(y) && is_inside(double(film.width) * w - x) &&
           is_inside(double(film.height) * w - y);
}

/// The same of one image and places around: by its derivative.
bool may_be_shown(const WorldImage& image, const CameraRays& camera, const FilmMoveQuery& query) {
    if (image.path == Path::kDirect && camera.linear) return may_be_shown(*camera.linear, camera.film, query);
    return !image.has_derivative || distance_to_film(camera.film, image.pixel) <=
                                        kMostGrowth * steepest(image.derivative) * query.reach;
}

void add_image(const WorldImage& image, const CameraRays& camera, const FilmMoveQuery& query,
               FilmMove& move) {
    if (!std::isfinite(image.pixel.x) || !std::isfinite(image.pixel.y)) return;
    if (image.inside && !image.visible) return;  // an optic hides it
    if (!may_be_shown(image, camera, query)) return;
    move.is_shown = true;
    move.is_whole = move.is_whole || distance_to_film(camera.film, image.pixel) == 0;
    const double pixels = image.has_derivative ? std::hypot(dot(image.derivative[0], query.along),
                                                            dot(image.derivative[1], query.along))
                                               : std::numeric_limits<double>::infinity();
    move.pixels = std::max(move.pixels, pixels);
}

}  // namespace

FilmMoves film_moves(const Scene& scene) {
    const std::shared_ptr<const World> world = world_of_optics(scene);
    std::vector<std::shared_ptr<const PointProjector>> cameras;
    for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
        ProjectRequest request;
        request.frame.camera = c;
        request.derivatives = true;
        cameras.push_back(std::make_shared<const PointProjector>(*world, request));
    }
    return [world, cameras](std::span<const FilmMoveQuery> queries) {
        std::vector<ProjectedPoint> points;
        for (const FilmMoveQuery& query : queries) points.push_back({query.place});
        std::vector<FilmMove> moves(queries.size());
        for (const auto& camera : cameras) {
            const std::vector<PointProjection> found = project_each(*camera, points);
            for (std::size_t q = 0; q < queries.size(); ++q)
                for (const WorldImage& image : found[q].images)
                    add_image(image, camera->camera(), queries[q], moves[q]);
        }
        return moves;
    };
}

}  // namespace trilens
