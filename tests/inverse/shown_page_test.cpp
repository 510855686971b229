// What is seen through slits and past needles: an unwrap's map and an anamorphosis' page against every pixel.
#include <string>
#include <vector>

#include "ball_worlds.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "inverse/anamorph/anamorph.h"
#include "inverse/maps/film_images.h"
#include "inverse/maps/film_map.h"
#include "inverse/maps/proxy.h"
#include "inverse/maps/target.h"
#include "render/shoot/shoot.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr int kDots = 128;  // across the page

/// A page behind the camera, seen in a mirror ball through a slit between two walls, or past one needle, all
/// of which is seen before the page.
std::string page_behind(double x, double width, bool slit) {
    const auto wall = [&](const char* name, double middle, double wide) {
        return fmt::format(R"(, {{"name": "{}", "role": "object", "material": "paper",
            "primitive": {{"type": "box", "center": [{}, 0, 2], "size": [{}, {}, 0.02]}}}})",
                           name, middle, wide, slit ? 20 : 1.8);
    };
    const std::string walls =
        slit ? wall("left", x - 10 - width / 2, 20) + wall("right", x + 10 + width / 2, 20)
             : wall("needle", x, width);
    return R"({"version": 1, "film": {"width": 320, "height": 240},
  "cameras": [{"name": "eye", "yfov": 40, "lookAt": {"eye": [0, 0, 1.9], "at": [0, 0, -1]}}],
  "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0},
                {"name": "paper", "unlit": true}],
  "meshes": [{"name": "ball", "role": "optic", "material": "chrome", "resolution": 8,
              "primitive": {"type": "sphere", "center": [0, 0, -1], "radius": 0.8}},
             {"name": "page", "role": "object", "material": "paper",
              "points": [[-2, -2, 4], [2, -2, 4], [2, 2, 4], [-2, 2, 4]],
              "faceVertexCounts": [4], "faceVertexIndices": [3, 2, 1, 0]})" +
           walls + R"(], "render": {"maxDepth": 0}})";
}

FilmMapRequest to_page(const World& world) {
    FilmMapRequest request;
    request.target = parse_target(fmt::format("page:{}x{}", kDots, kDots), world.scene);
    return request;
}

/// Whether each of the page's dots has an image on the film, asked one by one.
std::vector<unsigned char> seen_dots(const World& world, const TargetDescription& page) {
    const Target target(page, world.scene);
    const Proxy proxy({}, world, Vec3(0));
    std::vector<Vec2> middles;
    for (int y = 0; y < kDots; ++y)
        for (int x = 0; x < kDots; ++x) middles.emplace_back(x + 0.5, y + 0.5);
    std::vector<MapImages> images(middles.size());
    FilmImagesParams params;
    params.objects_hide = true;
    find_film_images(world, params, world_places(target, proxy, middles), images);
    std::vector<unsigned char> seen;
    for (const MapImages& some : images) seen.push_back(!some.empty());
    return seen;
}

/// Of the film's pixels, those whose rays end over the mirror at an object of this name.
std::size_t film_pixels(const World& world, const std::string& name) {
    std::vector<Vec2> middles;
    for (int y = 0; y < world.scene.film.height; ++y)
        for (int x = 0; x < world.scene.film.width; ++x) middles.emplace_back(x + 0.5, y + 0.5);
    std::size_t count = 0;
    for (const ShotRay& shot : shoot_places(world, {}, middles).rays)
        count += shot.state == ShotState::kSeen && shot.event_count > 0 &&
                 world.scene.meshes[shot.object].name == name;
    return count;
}

/// Slits and needles that some pixel's own ray shows, and that are wider than a dot where they lie on the
/// page.
template <class Use>
void for_slits(std::uint64_t seed, const Use& use) {
    Draw draw(seed);
    int held = 0;
    for (int k = 0; k < 24; ++k) {
        const double x = draw.uniform(-0.9, 0.9), width = draw.log_uniform(0.02, 0.1);
        const auto world = world_of(page_behind(x, width, k % 2 == 0));
        if (film_pixels(*world, k % 2 == 0 ? "page" : "needle") == 0) continue;
        ++held;
        INFO((k % 2 == 0 ? "slit" : "needle") << " at " << x << ", " << width << " wide");
        use(*world, to_page(*world));
    }
    CHECK(held > 15);
}

}  // namespace

TEST_CASE("an unwrap's map has what the film's rays show through a slit, and nothing of a needle",
          "[inverse][law]") {
    for_slits(31, [](const World& world, const FilmMapRequest& request) {
        const std::vector<unsigned char> seen = seen_dots(world, request.target);
        const FilmMap map = make_film_map(world, request);
        CHECK((map.valid == seen));
    });
}

TEST_CASE("an anamorphosis is drawn wherever the film's rays show its page through a slit",
          "[inverse][law]") {
    for_slits(32, [](const World& world, const FilmMapRequest& request) {
        AnamorphRequest asked;
        asked.picture = std::make_shared<Texture>(Texture{2, 2, std::vector<float>(12, 0.0f), {}});
        asked.page = request.target.object;
        asked.window = PictureWindow{0, 0, 320, 240};
        asked.dpi = kDots / 40.0 * 25.4;  // 4 units of 10 mm
        const AnamorphPage page = make_anamorph(world, asked).page;
        REQUIRE(page.width == kDots);
        REQUIRE(page.height == kDots);
        std::vector<unsigned char> drawn;
        for (std::size_t dot = 0; dot < page.rgb.size(); dot += 3) drawn.push_back(page.rgb[dot] < 1);
        CHECK((drawn == seen_dots(world, request.target)));
    });
}
