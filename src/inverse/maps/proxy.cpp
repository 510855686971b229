#include "inverse/maps/proxy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "intersect/tracer.h"
#include "inverse/maps/number_list.h"
#include "render/world/world.h"
#include "scene/formats/obj.h"

namespace trilens {
namespace {

/// Times the scene's size: near enough to infinity (the film's places are 1e-4 pixels off), and not so far
/// that the search of images loses digits.
constexpr double kFar = 1e6;

TriangleScene read_triangles(const std::string& file) {
    const auto bytes = read_whole_file(file);
    if (!bytes) throw InputError(file, "", "cannot be read");
    const ObjectMesh mesh = triangulate(parse_obj(*bytes, file).mesh).object;
    TriangleScene triangles{mesh.points, mesh.triangles, std::vector<Id>(mesh.triangles.size(), 0), {}};
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) triangles.primitive.push_back(static_cast<Id>(t));
    return triangles;
}

/// The point at distance t along the place's direction, on a plane with this normal (any length).
WorldPlace on_plane(const Vec3& center, const TargetPlace& place, double t, const Vec3& normal) {
    const double down = dot(normal, place.at);
    const auto moved = [&](const Vec3& step) { return t * (step - place.at * (dot(normal, step) / down)); };
    return {center + t * place.at, moved(place.dx), moved(place.dy)};
}

}  // namespace

Box scene_box(const World& world) {
    Box box;
    for (const Vec3& point : world.objects.points) box.include(point);
    for (std::size_t o = 0; o < world.optics.size(); ++o)
        for (const Vec3& point : optic_facets(world, o, world.optics[o].resolution)->grid().points)
            box.include(point);
    for (const CameraDescription& camera : world.scene.cameras)
        if (has_look_at(camera)) box.include(camera.eye);
    return box;
}

ProxyDescription parse_proxy(const std::string& text) {
    ProxyDescription proxy;
    const std::size_t colon = text.find(':');
    const std::string kind = text.substr(0, colon);
    const auto numbers = colon == std::string::npos ? std::nullopt : number_list(text.substr(colon + 1));
    if (text == "scene") return proxy;
    if (text == "infinity") {
        proxy.kind = ProxyKind::kInfinity;
        return proxy;
    }
    if (kind == "sphere" && numbers && numbers->size() == 1) {
        proxy.kind = ProxyKind::kSphere;
        proxy.radius = numbers->front();
        return proxy;
    }
    if (kind == "box" && numbers && numbers->size() == 6) {
        proxy.kind = ProxyKind::kBox;
        const std::vector<double>& n = *numbers;
        proxy.box.include(Vec3(n[0], n[1], n[2]));
        proxy.box.include(Vec3(n[3], n[4], n[5]));
        return proxy;
    }
    if (file_ending(text) == ".obj") {
        proxy.kind = ProxyKind::kMesh;
        proxy.file = text;
        return proxy;
    }
    throw UsageError("a proxy is scene, infinity, sphere:R, box:x0,y0,z0,x1,y1,z1 or a file.obj, not \"" +
                     text + "\"");
}

Proxy::Proxy(const ProxyDescription& description, const World& world, const Vec3& center)
    : description_(description), world_(world), center_(center) {
    Box box = scene_box(world);
    box.include(center);
    far_ = kFar * std::max(length(box.size()), 1e-300);
    if (description.kind == ProxyKind::kSphere && !(description.radius > 0))
        throw UsageError("a proxy's sphere has a positive radius");
    if (description.kind == ProxyKind::kBox && !(glm::all(glm::lessThan(description.box.low, center)) &&
                                                 glm::all(glm::lessThan(center, description.box.high))))
        throw UsageError("the centre lies outside the proxy's box; --center moves it");
    if (description.kind != ProxyKind::kMesh) return;
    triangles_ = read_triangles(description.file);
    tracer_ = std::make_unique<Tracer>(triangles_);
}

Proxy::~Proxy() = default;

WorldPlace Proxy::far_along(const TargetPlace& place) const {
    return {center_ + far_ * place.at, far_ * place.dx, far_ * place.dy};
}

WorldPlace Proxy::on_triangle(const Tracer& tracer, const TriangleScene& triangles,
                              const TargetPlace& place) const {
    const Hit hit = tracer.first_hit({center_, place.at});
    if (!hit.seen()) return far_along(place);
    const IdTriple& t = triangles.triangles[hit.triangle];
    const Vec3& a = triangles.points[t[0]];
    return on_plane(center_, place, hit.t, cross(triangles.points[t[1]] - a, triangles.points[t[2]] - a));
}

WorldPlace Proxy::along(const TargetPlace& place) const {
    switch (description_.kind) {
        case ProxyKind::kInfinity:
            break;
        case ProxyKind::kSphere:
            return {center_ + description_.radius * place.at, description_.radius * place.dx,
                    description_.radius * place.dy};
        case ProxyKind::kBox: {
            int wall = 0;
            double t = std::numeric_limits<double>::infinity();
            for (int k = 0; k < 3; ++k) {
                const double to = place.at[k] > 0 ? description_.box.high[k] : description_.box.low[k];
                const double way = place.at[k] == 0 ? t : (to - center_[k]) / place.at[k];
                if (way < t) t = way, wall = k;
            }
            Vec3 normal{0};
            normal[wall] = 1;
            return on_plane(center_, place, t, normal);
        }
        case ProxyKind::kScene:
            return on_triangle(object_tracer(world_), world_.objects, place);
        case ProxyKind::kMesh:
            return on_triangle(*tracer_, triangles_, place);
    }
    return far_along(place);
}

Vec3 Proxy::direction_met(const Ray& ray) const {
    const Vec3 from = ray.origin - center_;
    switch (description_.kind) {
        case ProxyKind::kInfinity:
            return ray.direction;
        case ProxyKind::kSphere: {
            const double b = dot(from, ray.direction);
            const double c = dot(from, from) - description_.radius * description_.radius;
            const double root = std::sqrt(std::max(0.0, b * b - c));
            return b * b < c ? ray.direction
                             : from + (root - b) * ray.direction;  // the far wall, from inside
        }
        case ProxyKind::kBox: {
            double t = std::numeric_limits<double>::infinity();
            for (int k = 0; k < 3; ++k) {
                const double to = ray.direction[k] > 0 ? description_.box.high[k] : description_.box.low[k];
                if (ray.direction[k] != 0) t = std::min(t, (to - ray.origin[k]) / ray.direction[k]);
            }
            return t > 0 ? from + t * ray.direction : ray.direction;
        }
        case ProxyKind::kScene:
        case ProxyKind::kMesh:
            break;
    }
    const Tracer& tracer = tracer_ ? *tracer_ : object_tracer(world_);
    const Hit hit = tracer.first_hit(ray);
    return hit.seen() ? from + hit.t * ray.direction : ray.direction;
}

std::vector<std::optional<WorldPlace>> world_places(const Target& target, const Proxy& proxy,
                                                    std::span<const Vec2> pixels) {
    std::vector<std::optional<WorldPlace>> places(pixels.size());
    parallel_for(pixels.size(), 1024, [&](std::size_t first, std::size_t last) {
        for (std::size_t p = first; p < last; ++p) {
            const std::optional<TargetPlace> place = target.place(pixels[p]);
            if (!place) continue;
            places[p] =
                place->is_direction ? proxy.along(*place) : WorldPlace{place->at, place->dx, place->dy};
        }
    });
    return places;
}

}  // namespace trilens
