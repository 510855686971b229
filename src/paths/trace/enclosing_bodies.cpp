#include "paths/trace/enclosing_bodies.h"

#include <algorithm>
#include <array>
#include <utility>

namespace trilens {
namespace {

/// Unit directions and their opposites, so that a plane has half of them on each side; none along an axis,
/// where edges and planes of scenes like to lie.
constexpr std::array<Vec3, 10> kDirections{
    Vec3(0.36, 0.48, 0.8),   Vec3(-0.36, -0.48, -0.8), Vec3(0.8, -0.36, -0.48), Vec3(-0.8, 0.36, 0.48),
    Vec3(-0.6, 0.64, -0.48), Vec3(0.6, -0.64, 0.48),   Vec3(0.64, 0.48, -0.6),  Vec3(-0.64, -0.48, 0.6),
    Vec3(0.48, -0.6, 0.64),  Vec3(-0.48, 0.6, -0.64)};

/// A body, and how far it is to its skin.
using Held = std::pair<double, Id>;

/// Those left last were entered first.
Media nested(std::vector<Held> held) {
    std::sort(held.begin(), held.end());
    held.resize(std::min<std::size_t>(held.size(), Media::kMost));
    Media media;
    for (auto one = held.rbegin(); one != held.rend(); ++one) media.enter(one->second);
    return media;
}

/// Where the ray leaves the body that it starts in; none where it starts in no such body.
std::optional<double> leaves(const PathWorld& world, Id body, const Ray& ray) {
    const std::optional<SurfaceHit> hit = world.optics[body].tracer->first_hit(ray);
    if (!hit || !(dot(hit->point.normal, ray.direction) > 0)) return std::nullopt;
    return hit->t;
}

}  // namespace

Media bodies_along(const PathWorld& world, const std::vector<Id>& asked, const Ray& ray) {
    std::vector<Held> held;
    for (const Id body : asked) {
        if (world.optics[body].mirror) continue;
        if (const auto t = leaves(world, body, ray)) held.emplace_back(*t, body);
    }
    return nested(std::move(held));
}

EnclosingBodies enclosing_bodies(const PathWorld& world, const std::vector<Id>& asked, const Vec3& point) {
    std::vector<Held> held;
    EnclosingBodies around;
    for (const Id body : asked) {
        if (world.optics[body].mirror) continue;
        double way = 0;
        std::size_t votes = 0;
        for (const Vec3& direction : kDirections)
            if (const auto t = leaves(world, body, {point, direction})) {
                way += *t;
                ++votes;
            }
        if (votes > 0 && votes < kDirections.size()) around.unsure.push_back(body);
        if (2 * votes > kDirections.size()) held.emplace_back(way / static_cast<double>(votes), body);
    }
    around.media = nested(std::move(held));
    return around;
}

}  // namespace trilens
