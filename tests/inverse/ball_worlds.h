// Worlds of the tests of unwrap, map and anamorph: a mirror ball under a smooth sky, a mirror on a page.
#pragma once

#include <cmath>
#include <memory>
#include <string>

#include "base/image/image.h"
#include "image/image_io.h"
#include "render/picture/picture.h"
#include "render/world/world.h"
#include "scene/data/check_scene.h"
#include "scene/load.h"

namespace trilens_test {

inline std::unique_ptr<trilens::World> world_of(const std::string& json) {
    using namespace trilens;
    Scene scene = load_scene_text(json, SceneSource("test"), {}, {read_texture, decode_texture});
    check_scene(scene);
    return make_world(std::move(scene), {});
}

/// A smooth radiance of directions, R G B.
inline trilens::Vec3 sky_colour(const trilens::Vec3& d) {
    return {0.5 + 0.3 * std::sin(6 * d.x) * std::cos(5 * d.y), 0.5 + 0.4 * d.z * d.y,
            0.4 + 0.3 * std::cos(7 * d.z)};
}

/// A mirror ball of radius 1 at the origin, `distance` from the eye; film width x height.
inline std::string ball_json(int width, int height, double distance, const std::string& mirror = "",
                             int spp = 1) {
    const std::string primitive =
        mirror.empty() ? R"("primitive": {"type": "sphere", "center": [0, 0, 0], "radius": 1})" : mirror;
    return R"({"version": 1, "film": {"width": )" + std::to_string(width) + R"(, "height": )" +
           std::to_string(height) + R"(, "spp": )" + std::to_string(spp) + R"(},
  "cameras": [{"name": "front", "type": "perspective", "yfov": )" +
           std::to_string(2.3 * std::atan(1 / distance) * 57.29577951308232) +
           R"(, "lookAt": {"eye": [0, 0, )" + std::to_string(distance) +
           R"(], "at": [0, 0, 0], "up": [0, 1, 0]}},
              {"name": "side", "type": "perspective", "yfov": )" +
           std::to_string(2.3 * std::atan(1 / distance) * 57.29577951308232) + R"(, "lookAt": {"eye": [)" +
           std::to_string(distance) + R"(, 0, 0], "at": [0, 0, 0], "up": [0, 1, 0]}}],
  "background": {"color": [0.2, 0.3, 0.5]},
  "materials": [{"name": "chrome", "baseColorFactor": [0.9, 0.8, 0.7], "metallicFactor": 1, "roughnessFactor": 0}],
  "meshes": [{"name": "ball", "role": "optic", "material": "chrome", "resolution": 8, )" +
           primitive + R"(}],
  "render": {"maxDepth": 0, "fresnel": false}})";
}

/// A scene under the smooth sky, as a latitude-longitude picture of `sky_width` columns.
inline std::unique_ptr<trilens::World> world_under_sky(const std::string& json, int sky_width) {
    using namespace trilens;
    Scene scene = load_scene_text(json, SceneSource("test"), {}, {read_texture, decode_texture});
    auto sky = std::make_shared<Texture>();
    sky->width = sky_width, sky->height = sky_width / 2;
    for (int y = 0; y < sky->height; ++y)
        for (int x = 0; x < sky->width; ++x) {
            const double longitude = ((x + 0.5) / sky->width - 0.5) * 2 * 3.14159265358979323846;
            const double latitude = (0.5 - (y + 0.5) / sky->height) * 3.14159265358979323846;
            const Vec3 c = sky_colour({std::sin(longitude) * std::cos(latitude), std::sin(latitude),
                                       -std::cos(longitude) * std::cos(latitude)});
            for (int k = 0; k < 3; ++k) sky->rgb.push_back(static_cast<float>(c[k]));
        }
    scene.background.environment = sky;
    return make_world(std::move(scene), {});
}

inline std::unique_ptr<trilens::World> ball_under_sky(int width, int height, double distance, int sky_width,
                                                      int spp = 1) {
    return world_under_sky(ball_json(width, height, distance, "", spp), sky_width);
}

/// The same ball of glass that mirrors nothing.
inline std::unique_ptr<trilens::World> glass_under_sky(int width, int height, double distance,
                                                       int sky_width) {
    std::string json = ball_json(width, height, distance);
    const auto put = [&](const std::string& old, const std::string& now) {
        json.replace(json.find(old), old.size(), now);
    };
    put(R"("baseColorFactor": [0.9, 0.8, 0.7], "metallicFactor": 1, "roughnessFactor": 0)",
        R"("transmissionFactor": 1, "ior": 1.5)");
    put(R"("maxDepth": 0)", R"("maxDepth": 1)");
    put(R"("resolution": 8)", R"("resolution": 9)");
    return world_under_sky(json, sky_width);
}

/// A photograph by ray tracing, as a texture.
inline std::shared_ptr<trilens::Texture> photograph(const trilens::World& world, std::size_t camera = 0) {
    using namespace trilens;
    PictureRequest request;
    request.frame.camera = camera;
    request.engine = Engine::kLimitTruth;
    const Image image = draw_picture(world, request, {}, {}).image;
    auto photo = std::make_shared<Texture>();
    photo->width = image.width, photo->height = image.height;
    photo->rgb.resize(3 * image.pixels());
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t p = 0; p < image.pixels(); ++p)
            photo->rgb[3 * p + c] = image.find(std::string(1, "RGB"[c]))->floats()[p];
    return photo;
}

}  // namespace trilens_test
