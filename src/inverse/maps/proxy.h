// Proxy geometry: how far what a direction shows is taken to be, since a photograph of a mirror does not say.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/math/box.h"
#include "base/raymesh/triangle_scene.h"
#include "inverse/maps/film_images.h"
#include "inverse/maps/target.h"
#include "render/world/world.h"

namespace trilens {

class Tracer;

/// What lies along directions from a centre. The world must live longer. Thread-safe to read.
class Proxy {
  public:
    /// Throws InputError for a file that cannot be used, UsageError for a centre outside a box or a radius
    /// that is not positive.
    Proxy(const ProxyDescription& description, const World& world, const Vec3& center);
    ~Proxy();

    /// `place`: a direction. Points at infinity are put kFar times the scene's size away, where the film
    /// shows them to 1e-4 pixels.
    WorldPlace along(const TargetPlace& place) const;

    /// Back: the direction from the centre (any length) to where a ray (unit direction) meets the proxy; its
    /// own direction where it meets nothing.
    Vec3 direction_met(const Ray& ray) const;

    /// Whether objects between the last optic and the point hide it: only of the scene itself.
    bool is_hidden_by_objects() const {
        return description_.kind == ProxyKind::kScene && world_.objects.size() > 0;
    }

    /// Whether anything may lie before the last optic.
    bool may_be_hidden() const { return world_.objects.size() > 0 || world_.optics.size() > 1; }

  private:
    WorldPlace far_along(const TargetPlace& place) const;
    WorldPlace on_triangle(const Tracer& tracer, const TriangleScene& triangles,
                           const TargetPlace& place) const;

    ProxyDescription description_;
    const World& world_;
    Vec3 center_{0};
    double far_ = 1;
    TriangleScene triangles_;         // kMesh
    std::unique_ptr<Tracer> tracer_;  // of these
};

/// What the target's pixels show in the world; none where a pixel shows nothing. Directions go to the proxy.
std::vector<std::optional<WorldPlace>> world_places(const Target& target, const Proxy& proxy,
                                                    std::span<const Vec2> pixels);

/// A box around all that the scene has: objects, optics, its cameras' eyes.
Box scene_box(const World& world);

}  // namespace trilens
