#include "render/world/blended_surfaces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/math/box.h"
#include "base/raymesh/triangle_corners.h"
#include "intersect/tracer.h"

namespace trilens {
namespace {

constexpr double kOnEdge = 1e-9;  // weights of less lie on a triangle's edge

std::vector<Box> boxes_of(const TriangleScene& scene) {
    std::vector<Box> boxes(scene.size());
    for (std::size_t t = 0; t < boxes.size(); ++t)
        for (const Vec3& corner : corners_of(scene, static_cast<Id>(t))) boxes[t].include(corner);
    return boxes;
}

bool is_on_edge(const Hit& hit) {
    return std::min({hit.barycentric.x, hit.barycentric.y, 1 - hit.barycentric.x - hit.barycentric.y}) <
           kOnEdge;
}

/// Whether both are one place of one surface, on the edge that two of its triangles share.
bool is_same_place(const TriangleScene& scene, const Hit& a, const Hit& b) {
    return scene.object[a.triangle] == scene.object[b.triangle] &&
           std::fabs(a.t - b.t) <= kDepthTie * std::fabs(a.t) && is_on_edge(a) && is_on_edge(b);
}

}  // namespace

BlendedSurfaces::BlendedSurfaces(TriangleScene triangles, ShadeScene shading)
    : triangles_(std::move(triangles)), shading_(std::move(shading)), tree_(boxes_of(triangles_)) {
    shading_.triangles = &triangles_;
}

void BlendedSurfaces::set_up(const ShadeSurroundings& others) {
    static_cast<ShadeSurroundings&>(shading_) = others;
    if (!others.caustic) return;
    shading_.caustic = [caustic = others.caustic](std::size_t light, Receiver receiver) {
        receiver.triangle = kNone;
        return caustic(light, receiver);
    };
}

bool BlendedSurfaces::is_seen_by(const Ray& ray, Id triangle) const {
    if (shading_.materials[shading_.material[triangle]].double_sided) return true;
    const auto [a, b, c] = corners_of(triangles_, triangle);
    return dot(cross(b - a, c - a), ray.direction) < 0;
}

std::vector<Hit> BlendedSurfaces::crossings(const Ray& ray, double until) const {
    return crossings_from(-same_place(ray.origin) / length(ray.direction), ray, until);
}

std::vector<Hit> BlendedSurfaces::crossings_after_start(const Ray& ray, double until) const {
    return crossings_from(same_place(ray.origin) / length(ray.direction), ray, until);
}

std::vector<Hit> BlendedSurfaces::crossings_from(double from, const Ray& ray, double until) const {
    std::vector<Hit> hits;
    const double most = std::isfinite(until)
                            ? until + same_place(ray.origin + until * ray.direction) / length(ray.direction)
                            : until;
    const ShearedRay sheared(ray);
    tree_.visit(ray, std::min(from, 0.0), most, [&](Id triangle) {
        if (const auto met = sheared.meet(corners_of(triangles_, triangle)))
            if (met->t >= from && met->t <= most && is_seen_by(ray, triangle))
                hits.push_back({triangle, met->t, met->barycentric});
        return most;
    });
    std::sort(hits.begin(), hits.end(), [&](const Hit& a, const Hit& b) {
        return std::pair(a.t, a.triangle) < std::pair(b.t, b.triangle);
    });
    // Of surfaces at one depth the scene's first lies in front, as everywhere.
    for (std::size_t i = 1; i < hits.size(); ++i)
        for (std::size_t k = i; k > 0; --k) {
            const Hit &before = hits[k - 1], &after = hits[k];
            if (after.t - before.t > kDepthTie * before.t ||
                triangles_.object[before.triangle] <= triangles_.object[after.triangle])
                break;
            std::swap(hits[k - 1], hits[k]);
        }
    const auto last = std::unique(hits.begin(), hits.end(), [&](const Hit& a, const Hit& b) {
        return is_same_place(triangles_, a, b);
    });
    hits.erase(last, hits.end());
    return hits;
}

Veil BlendedSurfaces::veil(const Ray& segment) const {
    Veil veil;
    for (const Hit& hit : crossings({segment.origin + segment.direction, -segment.direction}, 1)) {
        veil.through *= 1 - opacity_at(shading_, hit);
        veil.surfaces.emplace_back(triangles_.object[hit.triangle], shading_.material[hit.triangle]);
    }
    return veil;
}

std::vector<VolumeLight> BlendedSurfaces::shade(const Ray& ray, std::span<const Hit> crossings) const {
    std::vector<SeenAlong> seen;
    for (const Hit& hit : crossings) seen.push_back({&hit, &ray});
    std::vector<Vec3> colour(seen.size());
    shade_rays(shading_, seen, colour);
    std::vector<VolumeLight> light;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        const double opacity = opacity_at(shading_, crossings[i]);
        light.push_back({opacity * colour[i], 1 - opacity});
    }
    return light;
}

}  // namespace trilens
