// Materials, by glTF's names; plain data that scene writes and shade reads.
#pragma once

#include <memory>
#include <string>

#include "base/description/texture.h"
#include "base/math/vec.h"

namespace trilens {

/// glTF's names. On an optic either metallic_factor or transmission_factor is 1.
struct Material {
    std::string name;
    Vec3 base_color_factor{1};
    std::shared_ptr<const Texture> base_color_texture;  // may be null
    TextureSampler base_color_sampler;
    bool unlit = false;
    double metallic_factor = 0;
    double roughness_factor = 0;
    double transmission_factor = 0;
    double ior = 1.5;
    double dispersion = 0;
    Vec3 attenuation_color{1};
    double attenuation_distance = 0;  // scene units; 0: no absorption
};

}  // namespace trilens
