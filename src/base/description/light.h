// Lights, and the background that rays see where they hit nothing.
#pragma once

#include <memory>

#include "base/description/material.h"
#include "base/math/vec.h"
#include "base/util/names.h"

namespace trilens {

/// KHR_lights_punctual, and an ambient term.
struct Light {
    enum class Type { kDirectional, kPoint, kAmbient };
    Type type = Type::kAmbient;
    Vec3 color{1};
    double intensity =
        1;  // directional: lux; point: candela; ambient: radiance added to every diffuse surface
    Vec3 direction{0, -1, 0};  // unit, the way the light travels
    Vec3 position{0};
    bool shadows = false;
};

template <>
struct EnumNames<Light::Type> {
    static constexpr std::array kTable{NamedValue<Light::Type>{Light::Type::kDirectional, "directional"},
                                       NamedValue<Light::Type>{Light::Type::kPoint, "point"},
                                       NamedValue<Light::Type>{Light::Type::kAmbient, "ambient"}};
};

/// What rays see that hit nothing: a colour, or a latitude-longitude picture turned about +Y.
struct Background {
    Vec3 color{0};
    std::shared_ptr<const Texture> environment;  // may be null; then color holds
    double rotate_cos = 1, rotate_sin = 0;       // of the rotation about +Y
};

}  // namespace trilens
