#include "view/birds_eye.h"

#include <trilens/camera.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace trilens {
namespace {

/// Straight lines are drawn in pieces: what lies behind the camera, or on a curved camera's film, is then
/// right.
constexpr int kPieces = 24;

Json unit_vec(const Vec3& v) {
    return Json::array({v.x, v.y, v.z});
}

class LineDrawer {
  public:
    LineDrawer(const Renderer& renderer, ShownBirdsEye& shown)
        : camera_(make_camera(renderer.scene().cameras.back(),
                              {static_cast<double>(renderer.scene().film.width),
                               static_cast<double>(renderer.scene().film.height)})),
          shown_(shown) {}

    std::optional<Vec2> place(const Vec3& point) const {
        const std::vector<FilmImage> images = film_positions(camera_, point);
        if (images.empty()) return std::nullopt;
        return images.front().pixel;
    }

    void add(const Vec3& from, const Vec3& to, DrawnLine line) {
        for (int i = 0; i <= kPieces; ++i) {
            const auto at = place(from + (static_cast<double>(i) / kPieces) * (to - from));
            if (at) line.points.push_back(*at);
            if (!at || i == kPieces) {
                if (line.points.size() > 1) shown_.lines.push_back(line);
                line.points.clear();
            }
        }
    }

    void add(const PathLine& path, DrawnLine::Kind kind) {
        for (std::size_t i = 0; i + 1 < path.corners.size(); ++i)
            add(path.corners[i].point, path.corners[i + 1].point,
                {{}, path.corners[i].medium != kNone, dot(path.weight, Vec3(1)) / 3, kind});
    }

  private:
    Camera camera_;
    ShownBirdsEye& shown_;
};

/// Dots over a sheet: at its points and inside its triangles, orange where light meets, violet where only the
/// lines of its rays do.
void draw_caustic(const LineDrawer& drawer, const CausticSheet& sheet, Pixels& picture) {
    const std::array<std::uint8_t, 3> colour = sheet.is_virtual ? std::array<std::uint8_t, 3>{170, 110, 255}
                                                                : std::array<std::uint8_t, 3>{255, 150, 30};
    const auto dot_at = [&](const Vec3& point) {
        const auto at = drawer.place(point);
        if (!at || !(at->x >= 0 && at->y >= 0 && at->x < picture.width && at->y < picture.height)) return;
        const auto pixel = static_cast<std::size_t>(at->y) * static_cast<std::size_t>(picture.width) +
                           static_cast<std::size_t>(at->x);
        std::copy(colour.begin(), colour.end(),
                  picture.rgba.begin() + static_cast<std::ptrdiff_t>(4 * pixel));
    };
    for (const Vec3& point : sheet.points) dot_at(point);
    for (const IdTriple& corners : sheet.triangles) {
        const Vec3 &a = sheet.points[corners[0]], &b = sheet.points[corners[1]],
                   &c = sheet.points[corners[2]];
        dot_at((a + b + c) / 3.0);
        for (const auto& [from, to] : {std::pair{a, b}, {b, c}, {c, a}}) dot_at(0.5 * (from + to));
    }
}

}  // namespace

Json birds_eye_camera(const Scene& scene, const BirdsEye& from) {
    Vec3 middle(0);
    if (!scene.meshes.empty()) {
        const Box box = make_scene_info(scene).bounds;
        middle = 0.5 * (box.low + box.high);
    }
    const double azimuth = from.azimuth * std::numbers::pi / 180,
                 elevation = std::clamp(from.elevation, -89.0, 89.0) * std::numbers::pi / 180;
    const Vec3 away(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                    std::cos(azimuth) * std::cos(elevation));
    const Vec3 eye = middle + std::max(from.distance, 0.01) * scene_reach(scene) * away;
    Json camera;
    camera["name"] = "bird's eye of the viewer";
    camera["type"] = "perspective";
    camera["lookAt"] = {{"eye", unit_vec(eye)}, {"at", unit_vec(middle)}, {"up", unit_vec({0, 1, 0})}};
    camera["yfov"] = 45;
    return camera;
}

std::vector<Vec3> camera_corners(const Renderer& renderer, std::size_t index, double distance) {
    const Scene& scene = renderer.scene();
    const double width = scene.film.width, height = scene.film.height;
    const Camera camera = make_camera(scene.cameras.at(index), {width, height});
    std::vector<Vec3> corners;
    for (const Vec2& at :
         {Vec2(0, 0), Vec2(width, 0), Vec2(width, height), Vec2(0, height), Vec2(width / 2, height / 2)})
        if (const auto ray = exact_ray(camera, at)) {
            const double length = std::sqrt(dot(ray->direction, ray->direction));
            corners.push_back(ray->origin);
            corners.push_back(ray->origin + (distance / length) * ray->direction);
        }
    return corners;
}

std::vector<Id> objects_before(const Renderer& renderer, const Vec3& from, std::span<const Vec3> targets) {
    std::vector<Id> before;
    for (const Vec3& target : targets) {
        const Vec3 way = target - from;
        const double length = std::sqrt(dot(way, way));
        // From hit to hit, each time a little beyond the last.
        for (double at = 0; at < length;) {
            const Ray ray{from + (at / length) * way, way};
            const ShotRays shots = renderer.shoot(std::span(&ray, 1));
            const ShotRay& shot = shots.rays.at(0);
            if (shot.state != ShotState::kSeen || shot.event_count > 0) break;
            at += shot.t + 1e-6 * length;
            if (at < 0.999 * length && std::find(before.begin(), before.end(), shot.object) == before.end())
                before.push_back(shot.object);
        }
    }
    return before;
}

Scene birds_eye_scene(const Renderer& renderer, std::size_t camera, const std::vector<PathLine>* pixel_paths,
                      const PlaceImages* place_images) {
    Scene scene = renderer.scene();
    std::vector<Vec3> targets;
    const std::vector<Vec3> corners = camera_corners(renderer, camera, 1);
    if (!corners.empty()) targets.push_back(corners.front());
    for (const MeshInfo& mesh : make_scene_info(scene).meshes)
        if (mesh.role == Role::kOptic) targets.push_back(0.5 * (mesh.bounds.low + mesh.bounds.high));
    const auto add = [&](const PathLine& line) {
        for (const PathCorner& corner : line.corners)
            if (corner.event != "escapes") targets.push_back(corner.point);
    };
    if (pixel_paths) std::for_each(pixel_paths->begin(), pixel_paths->end(), add);
    if (place_images)
        for (const PlaceImage& image : place_images->images) add(image.line);
    const Camera eye = make_camera(scene.cameras.back(), {1, 1});
    const auto middle = exact_ray(eye, {0.5, 0.5});
    if (!middle) return scene;
    std::vector<Id> before = objects_before(renderer, middle->origin, targets);
    std::sort(before.rbegin(), before.rend());
    for (const Id object : before)
        scene.meshes.erase(scene.meshes.begin() + static_cast<std::ptrdiff_t>(object));
    return scene;
}

ShownBirdsEye draw_birds_eye(const Renderer& renderer, const BirdsEyeRequest& request,
                             const std::vector<Vec3>& corners, const Progress& progress) {
    PictureRequest picture;
    picture.frame.camera = renderer.scene().cameras.size() - 1;
    picture.layers.layers = {"Z"};
    ShownBirdsEye shown;
    shown.picture = tone_pixels(renderer.draw(picture, progress).image, "", request.tone);
    LineDrawer drawer(renderer, shown);
    const DrawnLine of_camera{{}, false, 1, DrawnLine::Kind::kCamera};
    for (std::size_t i = 0; i + 1 < corners.size(); i += 2) drawer.add(corners[i], corners[i + 1], of_camera);
    if (corners.size() == 10)
        for (std::size_t i = 0; i < 4; ++i)
            drawer.add(corners[2 * i + 1], corners[(2 * i + 3) % 8], of_camera);
    if (request.caustics)
        for (const LineDrawing::Caustic& caustic : *request.caustics)
            draw_caustic(drawer, caustic.sheet, shown.picture);
    if (request.place_images) {
        for (const PlaceImage& image : request.place_images->images)
            if (image.visible) drawer.add(image.line, DrawnLine::Kind::kPlacePath);
        shown.place = drawer.place(request.place_images->place);
    }
    if (request.pixel_paths)
        for (const PathLine& path : *request.pixel_paths) drawer.add(path, DrawnLine::Kind::kPixelPath);
    return shown;
}

}  // namespace trilens
