// Lights, and the background that rays see where they hit nothing.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "base/description/material.h"
#include "base/math/vec.h"

namespace trilens {

// The kinds of lights, world frame and scene units. Directions are unit and point the way the light travels;
// `samples` is how many points or directions stand for what is more than one: the same at every shaded point.

/// KHR_lights_punctual's, where `angle` is 0; else a disk in the sky, a sun: half a degree is ours.
struct DirectionalLight {
    static constexpr const char* kName = "directional";
    Vec3 direction{0, -1, 0};
    double angle = 0;  // degrees across the disk, below 180
    int samples = 16;
};

/// KHR_lights_punctual's.
struct PointLight {
    static constexpr const char* kName = "point";
    Vec3 position{0};
};

/// KHR_lights_punctual's: full within the inner angle, none beyond the outer one, both from the axis.
struct SpotLight {
    static constexpr const char* kName = "spot";
    Vec3 position{0}, direction{0, -1, 0};
    double inner_cone_angle = 0, outer_cone_angle = 45;  // degrees: 0 <= inner < outer <= 90
};

/// A flat light that shines from its front, the side that `direction` points to, alike in all directions.
struct RectangleLight {
    static constexpr const char* kName = "rectangle";
    Vec3 position{0};  // its middle
    Vec3 direction{0, -1, 0};
    Vec2 size{1, 1};   // width and height
    Vec3 up{0, 1, 0};  // the height runs along its part across `direction`; along -Z where it has none
    int samples = 16;
    bool visible = true;
};

/// Its sides as vectors of their lengths: the width's, then the height's.
struct RectangleSides {
    Vec3 width, height;
};
inline RectangleSides sides_of(const RectangleLight& light) {
    Vec3 upward = light.up - dot(light.up, light.direction) * light.direction;
    if (!(dot(upward, upward) > 1e-12 * dot(light.up, light.up)))
        upward = Vec3(0, 0, -1) + light.direction.z * light.direction;
    upward = normalize_or_zero(upward);
    return {light.size.x * cross(upward, light.direction), light.size.y * upward};
}

struct DiskLight {
    static constexpr const char* kName = "disk";
    Vec3 position{0};  // its middle
    Vec3 direction{0, -1, 0};
    double radius = 0.5;
    int samples = 16;
    bool visible = true;
};

/// Shines outward.
struct SphereLight {
    static constexpr const char* kName = "sphere";
    Vec3 position{0};  // its middle
    double radius = 0.5;
    int samples = 16;
    bool visible = true;
};

/// The same radiance from everywhere. With shadows: ambient occlusion, where something stands nearer than
/// `distance` its part is missing.
struct AmbientLight {
    static constexpr const char* kName = "ambient";
    double distance = 0;  // 0: however far
    int samples = 16;
};

/// The background as a light.
struct EnvironmentLight {
    static constexpr const char* kName = "environment";
    int samples = 64;
};

using LightKind = std::variant<AmbientLight, DirectionalLight, PointLight, SpotLight, RectangleLight,
                               DiskLight, SphereLight, EnvironmentLight>;

/// A light of some kind. `intensity` is lux of a directional light (on a surface that faces it), candela of
/// a point or spot light, radiance of rectangle, disk, sphere and ambient light, and a factor of the
/// background's radiance of an environment.
struct Light {
    std::string name;  // may be empty
    Vec3 color{1};
    double intensity = 1;
    bool shadows = false;
    bool caustics = false;  // its light is followed over optics; all of them stop what comes straight
    bool baked = false;     // its light is in the objects' baked light: it shows, but shines no more
    LightKind kind;
};

/// Whether things stand in the way of its light.
inline bool is_hindered(const Light& light) {
    return (light.shadows || light.caustics) && !light.baked;
}

/// Whether its light is followed over optics.
inline bool has_followed_light(const Light& light) {
    return light.caustics && !light.baked;
}

/// Whether it comes from all around.
inline bool is_dome(const Light& light) {
    return std::holds_alternative<AmbientLight>(light.kind) ||
           std::holds_alternative<EnvironmentLight>(light.kind);
}

inline const char* kind_name(const Light& light) {
    return std::visit([](const auto& kind) { return kind.kName; }, light.kind);
}

/// Whether the light has an area, and shows as an object of its own.
inline bool is_visible(const Light& light) {
    return std::visit(
        [](const auto& kind) {
            if constexpr (requires { kind.visible; }) return kind.visible;
            return false;
        },
        light.kind);
}

/// Light that was computed beforehand, at the corners of a triangle: irradiance over pi, on the side where
/// the corners turn anticlockwise, and on the other.
struct BakedLight {
    std::array<Vec3, 3> front{Vec3(0), Vec3(0), Vec3(0)}, back{Vec3(0), Vec3(0), Vec3(0)};
};

/// What rays see that hit nothing: a colour, or a latitude-longitude picture turned about +Y.
struct Background {
    Vec3 color{0};
    std::shared_ptr<const Texture> environment;  // may be null; then color holds
    double rotate_cos = 1, rotate_sin = 0;       // of the rotation about +Y
};

}  // namespace trilens
