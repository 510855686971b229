// What a material's pictures show at a point of a surface, or in the mean over the footprint of a ray.
#pragma once

#include <memory>

#include "base/description/material.h"
#include "base/math/vec.h"
#include "shade/texture_filter.h"

namespace trilens {

/// A material's pictures with their means; null where it has none.
struct MaterialMips {
    std::shared_ptr<const MipMap> base_color, metallic_roughness, occlusion, emissive;
    std::shared_ptr<const MipMap> normal;  // means of unit normals, not texels: normals_of() of the picture
    // What `normal` was made of.
    std::shared_ptr<const Texture> normal_picture;
    double normal_scale = 1;
};

/// What the pictures show. Without pictures it is as it stands here, but for the base colour.
struct MapTexels {
    Vec3 base{1};      // base colour with the material's factor; of the background its radiance
    Vec3 emissive{1};  // factors of the material's own
    double roughness = 1, metallic = 1;
    double occlusion = 1;      // share of ambient and environment light that arrives
    Vec3 normal{0, 0, 1};      // unit; along u, along v (upward) and the surface's normal
    double normal_length = 1;  // of the mean of unit normals: below 1 where they differ within the footprint
};

/// The unit normal that a normal map shows where its texels, or what lies between them, have this value; its
/// slopes times `scale`. Zero where it shows none.
Vec3 normal_of_texel(const Vec3& texel, double scale);

/// Of each texel's area the mean of the unit normals that the map shows there, at the middles of its quarters
/// between the texels (repeated at its edges): red, green and blue are x, y and z.
std::shared_ptr<const Texture> normals_of(const Texture& map, double scale);

/// The roughness of a surface whose normals, within what is seen as one, have a mean of this length. Normals
/// are taken for those of a von Mises-Fisher distribution, whose slopes' variance widens the lobe's.
/// Source: Toksvig, Mipmapping Normal Maps, 2005; Han et al., Frequency Domain Normal Map Filtering, 2007.
double widened_roughness(double roughness, double normal_length);

}  // namespace trilens
