#include "render/first_paths.h"

#include <algorithm>

#include "base/box.h"

namespace trilens {
namespace {

/// Where rays start is asked at so many places along each side of the film.
constexpr int kPlaces = 17;

bool holds(const Box& box, const Vec3& point) {
    return glm::all(glm::greaterThanEqual(point, box.low)) && glm::all(glm::lessThanEqual(point, box.high));
}

/// Whether some ray of the camera may start inside the optic's bounds.
bool starts_within(const World& world, const Frame& frame, const SurfaceGrid& grid) {
    Box box;
    for (const Vec3& point : grid.points) box.include(point);
    if (const LinearCamera* linear = frame.camera.linear ? &*frame.camera.linear : nullptr) {
        if (!linear->parallel) return holds(box, linear->eye);
        // Parallel rays start on a plane: all of the optic lies before it, or none.
        const auto is_before = [&](const Vec3& point) {
            return dot(linear->view_direction, point - linear->eye) > 0;
        };
        const auto before = std::count_if(grid.points.begin(), grid.points.end(), is_before);
        return before > 0 && static_cast<std::size_t>(before) < grid.points.size();
    }
    const Vec2 film(world.scene.film.width, world.scene.film.height);
    for (int i = 0; i < kPlaces * kPlaces; ++i) {
        const Vec2 share = Vec2(i % kPlaces, i / kPlaces) / double{kPlaces - 1};
        const std::optional<Ray> ray = exact_ray(frame.camera, share * film);
        if (ray && holds(box, ray->origin)) return true;
    }
    return false;
}

}  // namespace

bool ends_at_first(const World& world, const Frame& frame, std::size_t optic) {
    const Optic& asked = world.optics[optic];
    if (!frame.surroundings.none()) return false;
    if (world.scene.meshes[asked.mesh].normals.type == NormalOverride::Type::kNoise) return false;
    if (!asked.mirror && !path_world(world).optics[optic].patches().is_closed()) return false;
    return !starts_within(world, frame, frame.optics[optic].facets->grid());
}

}  // namespace trilens
