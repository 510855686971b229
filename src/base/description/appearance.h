// What things look like: materials, textures, lights, background; plain data that scene writes and shade
// reads.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/math/vec.h"

namespace trilens {

/// A picture to look up: linear Rec.709, rows from the top, three floats per texel.
struct Texture {
    int width = 0, height = 0;
    std::vector<float> rgb;
};

/// glTF's names. On an optic either metallic_factor or transmission_factor is 1.
struct Material {
    std::string name;
    Vec3 base_color_factor{1};
    std::shared_ptr<const Texture> base_color_texture;  // may be null
    bool unlit = false;
    double metallic_factor = 0;
    double roughness_factor = 0;
    double transmission_factor = 0;
    double ior = 1.5;
    double dispersion = 0;
    Vec3 attenuation_color{1};
    double attenuation_distance = 0;  // scene units; 0: no absorption
};

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

/// What rays see that hit nothing: a colour, or a latitude-longitude picture turned about +Y.
struct Background {
    Vec3 color{0};
    std::shared_ptr<const Texture> environment;  // may be null; then color holds
    double rotate_cos = 1, rotate_sin = 0;       // of the rotation about +Y
};

}  // namespace trilens
