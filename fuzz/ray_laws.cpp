#include "fuzz/ray_laws.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "fuzz/target.h"

using namespace trilens;

namespace trilens_fuzz {
namespace {

/// The word of a path's events.
template <class Events>
std::string letters_of(const Events& events) {
    std::string letters;
    for (const auto& one : events)
        if (one.event != Event::kPass) letters += one.event == Event::kReflect ? 'R' : 'T';
    return letters;
}

std::string told(const std::string& letters, const Vec2& pixel) {
    return (letters.empty() ? "direct" : letters) + " at " + std::to_string(pixel.x) + "," +
           std::to_string(pixel.y);
}

/// How far a point lies from a ray's line.
double miss(const ShotRay& ray, const Vec3& point) {
    const Vec3 off = point - ray.origin;
    return length(off - dot(off, ray.direction) * ray.direction);
}

}  // namespace

void require_images(const Renderer& renderer, const Scene& scene) {
    std::vector<Vec3> points;
    for (const Mesh& mesh : scene.meshes)
        if (mesh.object.points.size() > 2)
            points.push_back(0.25 * mesh.object.points[0] + 0.35 * mesh.object.points[1] +
                             0.4 * mesh.object.points[2]);
    if (points.empty()) return;
    ProjectRequest request;
    request.max_images = 6;
    const std::vector<PointProjection> found = renderer.project(points, request);
    require(found.size() == points.size(), "points without an answer");
    for (std::size_t p = 0; p < found.size(); ++p)
        for (const WorldImage& image : found[p].images) {
            require(image.steps.size() == image.events.size() || image.events.empty(),
                    "an image whose events are not its steps");
            for (int c = 0; c < 3; ++c)
                require(image.weight[c] >= 0 && image.weight[c] <= 1 + 1e-9, "a weight that is no share");
            if (!image.inside || !image.refined || !image.visible) continue;
            ShootRequest shoot;
            const std::string letters = letters_of(image.steps);
            if (!letters.empty()) shoot.path = EventWord(letters);
            const ShotRays shot = renderer.shoot(std::vector<Vec2>{image.pixel}, shoot);
            const ShotRay& ray = shot.rays.front();
            if (ray.state != ShotState::kSeen && ray.state != ShotState::kEscapes)
                continue;  // on an edge of an optic the ray may pass it
            if (shot.events_of(ray).size() != image.events.size()) continue;
            const double scale = length(points[p] - ray.origin) + length(points[p]);
            require(miss(ray, points[p]) <= 1e-4 * scale,
                    "the ray through an image passes its point by: " + told(letters, image.pixel));
        }
}

void require_shots(const Renderer& renderer, const Scene& scene, const Renderer& searching) {
    std::vector<Vec2> places;
    for (int y = 1; y < scene.film.height; y += 6)
        for (int x = 1; x < scene.film.width; x += 6) places.push_back({x + 0.5, y + 0.5});
    const ShotRays shot = renderer.shoot(places);
    std::map<std::string, std::vector<std::size_t>> by_word;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const ShotRay& ray = shot.rays[i];
        const double share = std::max({ray.weight.x, ray.weight.y, ray.weight.z});
        require(share >= 0 && share <= 1 + 1e-9, "a ray's weight that is no share");
        if (ray.state != ShotState::kSeen || ray.cut || share < 1e-6) continue;
        const std::string letters = letters_of(shot.events_of(ray));
        if (letters.size() <= 1 && shot.events_of(ray).size() == letters.size())
            by_word[letters].push_back(i);
    }
    for (const auto& entry : by_word) {
        const std::string& letters = entry.first;
        const std::vector<std::size_t>& rays = entry.second;
        ProjectRequest request;
        if (!letters.empty()) request.path = EventWord(letters);
        std::vector<Vec3> points;
        for (const std::size_t i : rays) points.push_back(shot.rays[i].position);
        const std::vector<PointProjection> found = searching.project(points, request);
        for (std::size_t k = 0; k < rays.size(); ++k) {
            if (!letters.empty() && !found[k].complete) continue;
            const Vec2 place = places[rays[k]];
            const bool is_there = std::ranges::any_of(found[k].images, [&](const WorldImage& image) {
                return letters_of(image.steps) == letters && length(image.pixel - place) < 1e-2;
            });
            require(is_there, "what a ray sees is not projected there: " + told(letters, place));
        }
    }
}

}  // namespace trilens_fuzz
