#include "shade/material_maps.h"

#include <algorithm>
#include <cmath>

#include "base/image/texture_lookup.h"
#include "base/util/parallel.h"

namespace trilens {

Vec3 normal_of_texel(const Vec3& texel, double scale) {
    return normalize_or_zero({scale * (2 * texel.x - 1), scale * (2 * texel.y - 1), 2 * texel.z - 1});
}

std::shared_ptr<const Texture> normals_of(const Texture& map, double scale) {
    auto normals = std::make_shared<Texture>();
    normals->width = map.width;
    normals->height = map.height;
    normals->rgb.resize(map.rgb.size());
    const auto beside = [](int i, int step, int size) { return (i + step + size) % size; };
    parallel_for(static_cast<std::size_t>(map.height), 16, [&](std::size_t from, std::size_t to) {
        for (int y = static_cast<int>(from); y < static_cast<int>(to); ++y)
            for (int x = 0; x < map.width; ++x) {
                const Vec3 own = texel_at(map, x, y);
                Vec3 sum(0);
                for (const int down : {-1, 1})
                    for (const int right : {-1, 1}) {
                        const int column = beside(x, right, map.width), row = beside(y, down, map.height);
                        sum += normal_of_texel((9.0 * own + 3.0 * texel_at(map, column, y) +
                                                3.0 * texel_at(map, x, row) + texel_at(map, column, row)) /
                                                   16.0,
                                               scale);
                    }
                float* const mean =
                    &normals->rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width) +
                                       static_cast<std::size_t>(x))];
                for (int k = 0; k < 3; ++k) mean[k] = static_cast<float>(sum[k] / 4);
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
