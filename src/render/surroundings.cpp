#include "render/surroundings.h"

#include "render/geometry.h"

namespace trilens {

void warn_of_surroundings(const World& world, const LinearCamera& camera, const Warn& warn) {
    if (!warn || camera.parallel || world.scene.render.max_depth == 0) return;
    const Ray ray{camera.eye, Vec3(0.36, 0.48, 0.8)};
    std::size_t bodies = 0;
    std::string around;
    for (std::size_t i = 0; i < world.optics.size(); ++i) {
        if (world.optics[i].mirror) continue;
        ++bodies;
        const std::optional<SurfaceHit> hit = limit_tracer(world, i).first_hit(ray);
        if (hit && dot(hit->point.normal, ray.direction) > 0) around = world.names[world.optics[i].mesh];
    }
    if (!around.empty() && bodies > 1)
        warn("the camera is inside of " + around + ": other glass in it is drawn as if it stood in air");
}

}  // namespace trilens
