#include "shade/material_maps.h"

#include <algorithm>
#include <cmath>

#include "base/util/parallel.h"

namespace trilens {

std::shared_ptr<const Texture> normals_of(const Texture& map, double scale) {
    auto normals = std::make_shared<Texture>();
    normals->width = map.width;
    normals->height = map.height;
    normals->rgb.resize(map.rgb.size());
    parallel_for(map.rgb.size() / 3, 4096, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            const float* rgb = &map.rgb[3 * i];
            const Vec3 normal = normalize_or_zero(
                Vec3(scale * (2.0 * rgb[0] - 1), scale * (2.0 * rgb[1] - 1), 2.0 * rgb[2] - 1));
            for (int k = 0; k < 3; ++k)
                normals->rgb[3 * i + static_cast<std::size_t>(k)] = static_cast<float>(normal[k]);
        }
    });
    return normals;
}

double widened_roughness(double roughness, double normal_length) {
    if (!(normal_length < 1)) return roughness;
    const double square = normal_length * normal_length;
    if (!(square > 0)) return 1;
    // The distribution's concentration (Banerjee et al. 2005); a slope's variance is one over it.
    const double concentration = normal_length * (3 - square) / (1 - square);
    const double alpha = roughness * roughness;
    return std::pow(std::min(alpha * alpha + 2 / concentration, 1.0), 0.25);
}

}  // namespace trilens
