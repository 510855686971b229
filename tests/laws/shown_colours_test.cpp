// No picture shows a colour that the truth does not show near it: shipped scenes at their own settings.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "image/image_io.h"
#include "image/tone.h"
#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "scene/examples/examples.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr int kReach = 3;        // pixels around, in which the truth may show a colour
constexpr double kUnlike = 0.1;  // of sRGB, in any of the three

/// The part of the film that is looked at; all zero: the whole.
using Window = std::array<int, 4>;

/// A layer's colours as a screen shows them.
struct Shown {
    int width = 0, height = 0;
    std::vector<Vec3> colours;

    const Vec3& at(int x, int y) const {
        return colours[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                       static_cast<std::size_t>(x)];
    }
};

/// Of the layer "" (the beauty), "direct", "reflect" or "refract"; without colours where the image has none.
Shown shown(const Image& image, const std::string& layer) {
    Shown result{image.data_width, image.data_height, {}};
    std::array<const std::vector<float>*, 3> light{};
    for (std::size_t c = 0; c < 3; ++c) {
        const Channel* channel = image.find((layer.empty() ? "" : layer + ".") + "RGB"[c]);
        if (!channel) return result;
        light[c] = &channel->floats();
    }
    for (std::size_t p = 0; p < image.pixels(); ++p) {
        Vec3 colour(0);
        for (std::size_t c = 0; c < 3; ++c)
            colour[static_cast<int>(c)] = srgb_from_linear(std::clamp(double{(*light[c])[p]}, 0.0, 1.0));
        result.colours.push_back(colour);
    }
    return result;
}

double largest(const Vec3& v) {
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

/// How far the colour is from a mix of the two.
double off_mix(const Vec3& colour, const Vec3& a, const Vec3& b) {
    const Vec3 along = b - a;
    const double square = dot(along, along), t = square > 0 ? dot(colour - a, along) / square : 0;
    return largest(colour - (a + std::clamp(t, 0.0, 1.0) * along));
}

/// Whether the truth shows the colour within kReach pixels, or two pixels that touch there whose mix it is.
bool is_near(const Vec3& colour, const Shown& truth, int x, int y) {
    const int x0 = std::max(0, x - kReach), x1 = std::min(truth.width - 1, x + kReach);
    const int y0 = std::max(0, y - kReach), y1 = std::min(truth.height - 1, y + kReach);
    for (int v = y0; v <= y1; ++v)
        for (int u = x0; u <= x1; ++u)
            if (largest(colour - truth.at(u, v)) <= kUnlike) return true;
    for (int v = y0; v <= y1; ++v)
        for (int u = x0; u <= x1; ++u)
            for (const auto& [du, dv] : {std::pair(1, 0), {0, 1}, {1, 1}, {-1, 1}}) {
                if (u + du < x0 || u + du > x1 || v + dv > y1) continue;
                if (off_mix(colour, truth.at(u, v), truth.at(u + du, v + dv)) <= kUnlike) return true;
            }
    return false;
}

std::size_t count_unlike(const Shown& picture, const Shown& truth) {
    std::size_t unlike = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) unlike += !is_near(picture.at(x, y), truth, x, y);
    return unlike;
}

/// A scene of the folder scenes, or an example's text, at its own settings.
std::unique_ptr<World> own_world(const std::string& name) {
    return make_world(load_scene(source_dir() + "/scenes/" + name + ".json", {},
                                 {read_texture, decode_texture, read_heights}),
                      ignore);
}
std::unique_ptr<World> world_of_text(const std::string& json) {
    return make_world(
        load_scene_text(json, SceneSource("scene", ""), {}, {read_texture, decode_texture, read_heights}),
        ignore);
}

struct ShownCase {
    std::string name;
    Window window{};
    std::size_t most_beauty = 0, most_layer = 0;  // of the whole film; 0 unless said why
};

Image drawn(const World& world, std::size_t camera, Engine engine, const Window& window) {
    PictureRequest request;
    request.frame.camera = camera;
    request.engine = engine;
    request.frame.facets = FacetUse::kWorthwhile;  // as `trilens render` draws
    request.layers = {window[0], window[1], window[2], window[3], {"direct", "reflect", "refract"}};
    return draw_picture(world, request, {}, ignore).image;
}

/// Every camera and every layer of the world at its own settings.
void check_colours(const World& world, const ShownCase& one) {
    for (std::size_t camera = 0; camera < world.scene.cameras.size(); ++camera) {
        const Image picture = drawn(world, camera, Engine::kExact, one.window),
                    truth = drawn(world, camera, Engine::kLimitTruth, one.window);
        for (const std::string layer : {"", "direct", "reflect", "refract"}) {
            const Shown ours = shown(picture, layer), theirs = shown(truth, layer);
            REQUIRE(ours.colours.size() == theirs.colours.size());
            REQUIRE((!layer.empty() || !ours.colours.empty()));
            const std::size_t unlike = ours.colours.empty() ? 0 : count_unlike(ours, theirs);
            INFO(one.name << ", " << world.scene.cameras[camera].name << ", " << layer << ": " << unlike
                          << " pixels show what the truth does not show near them");
            CHECK(unlike <= (layer.empty() ? one.most_beauty : one.most_layer));
        }
    }
}

/// What is known to be off, and why.
ShownCase case_of(const std::string& name) {
    // Outlines of facets are chords, and parts of facets are fitted one by one.
    if (name == "lenses/anamorphic") return {name, {}, 1, 0};
    if (name == "patches/nurbs") return {name, {}, 1, 1};
    // The mirror fills the film but for a pixel at its left and right edge: what the truth shows beside those
    // is off the film.
    if (name == "inverse/dome") return {name, {}, 0, 8};
    // Figures of the thesis that show what 5 x 5 facets do: outlines are polygons.
    if (name == "thesis/fig_7_4") return {name, {}, 1, 80};
    if (name == "thesis/fig_7_5") return {name, {}, 27, 27};
    return {name};
}

void expect_shown_colours(const ShownCase& one) {
    if (one.name == "engine" && !std::filesystem::exists("/usr/share/assimp/models"))
        return note_skip("colours of scene " + one.name, "needs the models of the package assimp-testmodels");
    check_colours(*own_world(one.name), one);
}

}  // namespace

TEST_CASE("no pixel shows a colour that the truth does not show near it", "[laws][law]") {
    expect_shown_colours({"sphere", {240, 170, 400, 310}});
    expect_shown_colours({"closed", {160, 100, 320, 200}});
    expect_shown_colours({"paths/prism", {300, 40, 370, 160}});
    expect_shown_colours({"paths/mirror-balls", {180, 150, 300, 250}});
    // A body wound inwards in a mirror ball, and corners of triangles.
    expect_shown_colours({"gltf/room", {262, 206, 302, 246}});
    expect_shown_colours({"patches/nurbs", {334, 223, 354, 243}});
    expect_shown_colours({"patches/nurbs", {273, 79, 293, 99}});  // a ring in a vase
    expect_shown_colours(
        {"paths/under-water", {144, 244, 168, 268}});  // the pool's corner, from below the water
}

TEST_CASE("the count finds facets that are too coarse", "[laws][law]") {
    // A mirror ball in a box: at n = 3 it shows its walls where others are.
    const auto world = own_world("closed");
    const Window window{160, 100, 480, 380};
    PictureRequest request;
    request.frame.resolution = 3;
    request.layers = {window[0], window[1], window[2], window[3], {"reflect"}};
    const Shown coarse = shown(draw_picture(*world, request, {}, ignore).image, ""),
                truth = shown(drawn(*world, 0, Engine::kLimitTruth, window), "");
    CHECK(count_unlike(coarse, truth) > 20);
    CHECK(count_unlike(truth, truth) == 0);
}

TEST_CASE("nor does any shipped scene, through any camera, at its own settings", "[.long][laws][law]") {
    const std::filesystem::path scenes(source_dir() + "/scenes");
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(scenes))
        if (entry.path().extension() == ".json")
            names.push_back(std::filesystem::relative(entry.path(), scenes).replace_extension().string());
    std::sort(names.begin(), names.end());
    REQUIRE(names.size() > 70);
    for (const std::string& name : names) expect_shown_colours(case_of(name));
    for (const SceneExample& example : scene_examples())
        check_colours(*world_of_text(example.json), case_of(example.name));
}
