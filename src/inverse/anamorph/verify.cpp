// Looks at a printed page: the scene ray traced with the page as a texture, against the picture.
#include <algorithm>
#include <cmath>

#include "base/util/error.h"
#include "image/tone.h"
#include "inverse/anamorph/anamorph.h"
#include "inverse/unwrap/photo.h"
#include "render/picture/picture.h"
#include "render/world/world.h"

namespace trilens {
namespace {

/// The page as it is printed: 8 bits of sRGB.
std::shared_ptr<const Texture> printed(const AnamorphPage& page) {
    auto texture = std::make_shared<Texture>();
    texture->width = page.width;
    texture->height = page.height;
    texture->rgb.resize(page.rgb.size());
    for (std::size_t i = 0; i < page.rgb.size(); ++i)
        texture->rgb[i] = static_cast<float>(linear_from_srgb(
            std::round(255 * srgb_from_linear(std::clamp(double(page.rgb[i]), 0.0, 1.0))) / 255));
    return texture;
}

Scene scene_with(const Scene& of, const AnamorphRequest& request, const AnamorphPage& page) {
    Scene scene = of;
    scene.film.spp = 4;
    scene.own_camera = request.frame.camera;
    scene.render.fresnel = false;
    for (Mesh& mesh : scene.meshes)
        if (mesh.role == Role::kOptic && mesh.material != kNone)
            scene.materials[mesh.material].base_color_factor = Vec3(1);
    Material paper;
    paper.name = "printed page";
    paper.base_color_texture = printed(page);
    paper.unlit = true;
    const Id material = static_cast<Id>(scene.materials.size());
    scene.materials.push_back(std::move(paper));
    Mesh& mesh = scene.meshes[request.page];
    const FlatRectangle& r = page.place;
    mesh.material = material;
    mesh.object = {};
    mesh.object.points = {r.origin, r.origin + r.u, r.origin + r.u + r.v, r.origin + r.v};
    mesh.object.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.object.uvs = {{Vec2(0, 0), Vec2(1, 0), Vec2(1, 1)}, {Vec2(0, 0), Vec2(1, 1), Vec2(0, 1)}};
    mesh.object.material = {material, material};
    return scene;
}

}  // namespace

AnamorphCheck verify_anamorph(const World& world, const AnamorphRequest& request, const Anamorph& made,
                              const Progress& progress) {
    const std::unique_ptr<World> printed_world = make_world(scene_with(world.scene, request, made.page), {});
    PictureRequest picture;
    picture.frame = request.frame;
    picture.engine = Engine::kLimitTruth;
    picture.layers.layers = {"reflect"};
    AnamorphCheck check;
    check.seen = draw_picture(*printed_world, picture, progress, {}).image;
    const Channel* object = check.seen.find("reflectID.object");
    const PictureWindow& w = made.window;
    const Vec2 scale(request.picture->width / (w[2] - w[0]), request.picture->height / (w[3] - w[1]));
    const Mat2 footprint(Vec2(scale.x, 0), Vec2(0, scale.y));
    std::array<const std::vector<float>*, 3> seen;
    for (std::size_t c = 0; c < 3; ++c) seen[c] = &check.seen.find(std::string(1, "RGB"[c]))->floats();

    double sum = 0;
    for (int y = std::max(0, int(std::ceil(w[1]))); y + 1 <= std::min<double>(check.seen.height, w[3]); ++y)
        for (int x = std::max(0, int(std::ceil(w[0]))); x + 1 <= std::min<double>(check.seen.width, w[2]);
             ++x) {
            const std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(check.seen.width) +
                                   static_cast<std::size_t>(x);
            if (object && object->ids()[at] != request.page) continue;
            const Vec3 wanted = sample_footprint(
                *request.picture, scale * (Vec2(x + 0.5, y + 0.5) - Vec2(w[0], w[1])), footprint);
            for (std::size_t c = 0; c < 3; ++c) {
                const auto stored = [](double v) { return srgb_from_linear(std::clamp(v, 0.0, 1.0)); };
                const double off = stored((*seen[c])[at]) - stored(wanted[static_cast<int>(c)]);
                sum += off * off;
            }
            ++check.pixels;
        }
    if (check.pixels == 0) throw ComputationError("the window shows no page to compare");
    check.psnr_db = -10 * std::log10(std::max(sum / (3.0 * double(check.pixels)), 1e-12));
    std::erase_if(check.seen.channels, [](const Channel& channel) { return channel.name.size() > 1; });
    return check;
}

}  // namespace trilens
