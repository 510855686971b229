// Terrains with a tolerance: none of their places is seen farther from where it belongs, in any picture.
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "image/image_io.h"
#include "laws/worlds.h"
#include "measure/displacement/displacement.h"
#include "render/picture/picture.h"
#include "render/project/film_moves.h"
#include "render/project/project.h"
#include "support/mountains.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr int kColumns = 129, kRows = 97;
const Vec3 kSize(8, 1.2, 6);

/// What stands over the terrain, and who looks at it.
struct SightLine {
    const char* name;
    const char* camera;
    const char* optic;
};

constexpr std::array<SightLine, 5> kSights{{
    {"a camera over it", R"("yfov": 50, "lookAt": {"eye": [0.2, 1.6, 3.6], "at": [0, 0.4, 0]})", ""},
    {"a camera high above", R"("yfov": 60, "lookAt": {"eye": [0, 7, 0], "at": [0, 0, 0], "up": [0, 0, -1]})",
     ""},
    {"a fisheye", R"("type": "fisheye", "fov": 120, "lookAt": {"eye": [0.5, 2, 0.5], "at": [0.5, 0, -0.5]})",
     ""},
    {"a ball", R"("yfov": 16, "lookAt": {"eye": [0, 6.6, 0.4], "at": [0, 1.5, 0.4], "up": [0, 0, -1]})",
     R"({"name": "ball", "role": "optic", "material": "chrome", "primitive": {"type": "sphere", "center": [0, 1.5, 0.4], "radius": 0.7}},)"},
    {"a hollow mirror", R"("yfov": 30, "lookAt": {"eye": [0, 1.4, 2], "at": [0, 1.9, 0]})",
     R"({"name": "dish", "role": "optic", "material": "chrome", "primitive": {"type": "paraboloid", "center": [0, 2.6, -1], "axis": [0, -0.55, 0.83], "focalLength": 9, "radius": 0.9}},)"},
}};

std::string heights_file() {
    const std::string file = scratch_dir("terrain_tolerance") + "/heights.exr";
    write_heights(file, mountains(kColumns, kRows));
    return file;
}

std::unique_ptr<World> terrain_seen(const SightLine& sight, const std::string& keys) {
    const std::string json =
        std::string(
            R"({"version": 1, "film": {"width": 160, "height": 120}, "background": {"color": [0.3, 0.4, 0.6]},
            "cameras": [{"name": "main", )") +
        sight.camera + R"(}], "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0}],
            "meshes": [)" +
        sight.optic + R"({"name": "range", "role": "terrain", "size": [8, 1.2, 6], "heights": ")" +
        heights_file() + "\"" + keys + "}]}";
    TextureReader reader = {};
    reader.heights_from_file = read_heights;
    reader.film_moves = film_moves;
    return make_world(load_scene_text(json, SceneSource("terrain", ""), {}, reader), ignore);
}

std::string tolerance_of(double pixels) {
    return ", \"tolerance\": " + std::to_string(pixels);
}

Image traced(const World& world) {
    PictureRequest request;
    request.engine = Engine::kLimitTruth;
    request.layers.layers = {"position", "reflect"};
    return draw_picture(world, request, {}, ignore, nullptr).image;
}

const Mesh& terrain_of(const World& world) {
    return world.scene.meshes.back();
}

/// Where the triangles are at the samples of the grid, by rays from above.
std::vector<Vec3> places_of(const World& world) {
    std::vector<Vec3> places;
    for (int y = 0; y < kRows; ++y)
        for (int x = 0; x < kColumns; ++x) {
            // Off the border, which rays along it may miss.
            const double u = std::clamp(x / (kColumns - 1.0), 1e-9, 1 - 1e-9),
                         v = std::clamp(y / (kRows - 1.0), 1e-9, 1 - 1e-9);
            const Vec3 above((u - 0.5) * kSize.x, 5, (v - 0.5) * kSize.z);
            const Hit hit = object_tracer(world).first_hit({above, Vec3(0, -1, 0)});
            REQUIRE(hit.seen());
            places.push_back(above - Vec3(0, hit.t, 0));
        }
    return places;
}

/// The farthest that an image that is seen lies from the next image of the same place elsewhere; of those
/// that have one: beyond the rim of a mirror, or of what a camera sees, there is none.
struct Farthest {
    double pixels = 0;
    std::size_t images = 0, beyond = 0;
};
Farthest farthest(const World& world, const std::vector<Vec3>& places, const std::vector<Vec3>& thinned) {
    const ProjectRequest request;
    const auto belong = project_points(world, request, places), are = project_points(world, request, thinned);
    Farthest found;
    for (std::size_t p = 0; p < places.size(); ++p)
        for (const WorldImage& image : belong[p].images) {
            if (!image.visible) continue;
            double least = std::numeric_limits<double>::infinity();
            for (const WorldImage& moved : are[p].images)
                if (moved.path == image.path) least = std::min(least, length(moved.pixel - image.pixel));
            ++found.images;
            if (std::isinf(least)) {
                ++found.beyond;
                continue;
            }
            found.pixels = std::max(found.pixels, least);
        }
    return found;
}

}  // namespace

TEST_CASE("no sample of a terrain with a tolerance is seen farther from where it belongs", "[terrain][law]") {
    for (const SightLine& sight : kSights) {
        const auto whole = terrain_seen(sight, "");
        const std::vector<Vec3> places = places_of(*whole);
        std::size_t before = terrain_of(*whole).object.triangles.size();
        CHECK(before == 2 * (kColumns - 1) * (kRows - 1));
        double last = 0;
        for (const double tolerance : {0.3, 1.0, 3.0}) {
            const auto thinned = terrain_seen(sight, tolerance_of(tolerance));
            const Farthest off = farthest(*whole, places, places_of(*thinned));
            const std::size_t count = terrain_of(*thinned).object.triangles.size();
            INFO(sight.name << ", " << tolerance << " px: " << count << " triangles, off by " << off.pixels
                            << " px, " << off.images << " images");
            CHECK(off.images > 1000);
            CHECK(off.beyond <= off.images / 50);
            CHECK(off.pixels <= tolerance);
            CHECK(count < before);
            before = count;
            last = off.pixels / tolerance;
        }
        // Not by keeping too much.
        INFO(sight.name);
        CHECK(last > 0.1);
    }
}

TEST_CASE("pictures of a terrain with a tolerance are displaced by less at 99 of 100 pixels",
          "[terrain][law]") {
    for (const std::size_t s : {std::size_t{0}, std::size_t{3}}) {
        const auto whole = terrain_seen(kSights[s], "");
        const Image truth = traced(*whole);
        for (const double tolerance : {0.5, 2.0}) {
            const auto thinned = terrain_seen(kSights[s], tolerance_of(tolerance));
            const Image test = traced(*thinned);
            const auto displacement = measure_displacement(truth, test, s == 0 ? "direct" : "reflect");
            REQUIRE(displacement);
            REQUIRE(displacement->summary);
            INFO(kSights[s].name << ", " << tolerance << " px: " << displacement->summary->p99
                                 << " px at 99 %, " << displacement->lost << " lost of "
                                 << displacement->pixels);
            CHECK(displacement->pixels > 3000);
            CHECK(displacement->summary->p99 <= tolerance);
            CHECK(displacement->summary->p99 > 0);
        }
    }
}

TEST_CASE("what no camera sees of a terrain is left out, on larger films more is kept", "[terrain][law]") {
    const auto count = [](const char* camera, const std::string& keys) {
        return terrain_of(*terrain_seen({"", camera, ""}, keys)).object.triangles.size();
    };
    const std::string one = tolerance_of(1);
    CHECK(count(R"("yfov": 50, "lookAt": {"eye": [0, 1.6, 5], "at": [0, 1.6, 9]})", one) <= 4);
    const std::size_t wide = count(R"("yfov": 50, "lookAt": {"eye": [0, 1.6, 4], "at": [0, 0.4, 0]})", one),
                      narrow = count(R"("yfov": 5, "lookAt": {"eye": [0, 1.6, 4], "at": [0, 0.4, 0]})", one);
    CHECK(narrow < wide);
    CHECK(narrow > 100);
}
