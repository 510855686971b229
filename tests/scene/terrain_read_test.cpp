// Terrains out of scene files: where they lie, what is refused, what is warned of.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "scene/animation.h"
#include "scene/info.h"
#include "scene/parameters.h"
#include "scene/scene_text.h"
#include "support/mountains.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string terrain_scene(const std::string& keys, const std::string& role = "terrain") {
    return R"({"version": 1, "cameras": [{"yfov": 40, "lookAt": {"eye": [0, 1, 4], "at": [0, 0, 0]}}],
        "meshes": [{"name": "range", "role": ")" +
           role + "\", " + keys + "}]}";
}

/// As if all cameras looked from above, and a unit were a hundredth of the film.
FilmMoves moves_of(int width) {
    return [width](std::span<const FilmMoveQuery> queries) {
        std::vector<FilmMove> moves;
        for (const FilmMoveQuery& query : queries)
            moves.push_back({0.01 * width * length(query.along), true, true});
        return moves;
    };
}

/// A file that is there, and a reader that says what is in it.
struct HeightsInFile {
    explicit HeightsInFile(HeightGrid field) : heights(std::move(field)) {
        path = scratch_dir("terrain_read") + "/heights.exr";
        std::ofstream(path) << "heights";
    }
    std::string keys(const std::string& more = "") const {
        return "\"heights\": \"" + path + "\", \"size\": [8, 2, 6]" + more;
    }
    Scene load(const std::string& json) const {
        TextureReader reader = white_textures();
        reader.heights_from_file = [this](const std::string&) { return heights; };
        reader.film_moves = [](const Scene& scene) { return moves_of(scene.film.width); };
        return load_scene_text(json, SceneSource("room.json", ""), {}, reader);
    }
    std::string refusal(const std::string& json) const {
        try {
            load(json);
            return "";
        } catch (const InputError& error) {
            return error.what();
        }
    }
    HeightGrid heights;
    std::string path;
};

}  // namespace

TEST_CASE("a terrain is an object whose middle is the origin", "[scene][terrain]") {
    const HeightsInFile file(mountains(9, 5));
    const Scene scene = file.load(terrain_scene(file.keys(R"(, "transform": {"translate": [10, 1, 0]})")));
    REQUIRE(scene.meshes.size() == 1);
    const Mesh& mesh = scene.meshes[0];
    CHECK(mesh.role == Role::kObject);
    CHECK(mesh.object.triangles.size() == 2 * 8 * 4);
    CHECK(mesh.object.material.size() == mesh.object.triangles.size());
    CHECK(mesh.object.normals.size() == mesh.object.triangles.size());
    const MeshInfo info = make_scene_info(scene).meshes[0];
    CHECK(info.shape == "terrain");
    CHECK(info.bounds.low.x == Approx(6));
    CHECK(info.bounds.high.x == Approx(14));
    CHECK(info.bounds.low.z == Approx(-3));
    REQUIRE(info.terrain);
    CHECK(info.terrain->columns == 9);
    CHECK(info.terrain->greatest_error == 0);
    // The picture's first sample is its top left: far and left, u 0 and v 1.
    const Vec3 first(6, 1 + 2 * static_cast<double>(file.heights.at(0, 0)), -3);
    bool found = false;
    for (std::size_t t = 0; t < mesh.object.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k)
            if (length(mesh.object.points[mesh.object.triangles[t][k]] - first) < 1e-12) {
                found = true;
                CHECK(mesh.object.uvs[t][k] == Vec2(0, 1));
            }
    CHECK(found);
}

TEST_CASE("fronts and normals of a terrain stay together where it is mirrored", "[scene][terrain]") {
    const HeightsInFile file(mountains(12, 12));
    for (const char* scale : {"[1, 1, 1]", "[-1, 1, 1]", "[1, -2, 1]"}) {
        const Scene scene =
            file.load(terrain_scene(file.keys(std::string(R"(, "transform": {"scale": )") + scale + "}")));
        const ObjectMesh& mesh = scene.meshes[0].object;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const auto& [a, b, c] = mesh.triangles[t];
            const Vec3 front = cross(mesh.points[b] - mesh.points[a], mesh.points[c] - mesh.points[a]);
            for (const Vec3& normal : mesh.normals[t]) REQUIRE(dot(front, normal) > 0);
        }
    }
    CHECK(file.load(terrain_scene(file.keys(R"(, "shading": "flat")"))).meshes[0].object.normals.empty());
}

TEST_CASE("a terrain is thinned as its scene says", "[scene][terrain]") {
    const HeightsInFile file(mountains(65, 65));
    const auto info = [&](const std::string& more) {
        return make_scene_info(file.load(terrain_scene(file.keys(more)))).meshes[0];
    };
    const MeshInfo whole = info(""), bound = info(R"(, "heightError": 0.1)"),
                   haar = info(R"(, "heightError": 0.1, "thinning": "haar")"),
                   region = info(
                       R"(, "heightError": 0.1, "region": {"center": [1, 1], "radii": [1, 1], "turn": 30})");
    CHECK(bound.triangles < whole.triangles / 2);
    CHECK(bound.terrain->greatest_error <= 0.1);
    CHECK(bound.terrain->greatest_error > 0.02);
    CHECK(haar.triangles != bound.triangles);
    CHECK(region.triangles < bound.triangles);
    CHECK(region.terrain->greatest_error > 0.1);
}

TEST_CASE("a terrain's tolerance is its heights' error on the film of its scene", "[scene][terrain]") {
    const HeightsInFile file(mountains(65, 65));
    const auto triangles = [&](const std::string& more, const char* film) {
        std::string json = terrain_scene(file.keys(more));
        json.insert(1, film);
        return make_scene_info(file.load(json)).meshes[0].triangles;
    };
    const char *usual = R"("film": {"width": 100, "height": 100}, )",
               *large = R"("film": {"width": 1000, "height": 100}, )";
    const std::size_t by_height = triangles(R"(, "heightError": 0.1)", usual);
    CHECK(triangles(R"(, "tolerance": 0.1)", usual) == by_height);
    CHECK(triangles(R"(, "tolerance": 1)", large) == by_height);
    CHECK(triangles(R"(, "tolerance": 0.1)", large) > by_height);
    // Pixels go by what the transform makes of a height.
    CHECK(triangles(R"(, "tolerance": 0.3, "transform": {"scale": [1, 3, 1]})", usual) == by_height);
    CHECK(triangles(R"(, "tolerance": 0.1, "thinning": "haar")", usual) ==
          triangles(R"(, "heightError": 0.1, "thinning": "haar")", usual));
    CHECK(triangles(R"(, "tolerance": 0.1, "region": {"radii": [1, 1]})", usual) < by_height);
}

TEST_CASE("a terrain with a tolerance is thinned anew where its film changes, and says how far that is",
          "[scene][terrain]") {
    const HeightsInFile file(mountains(65, 65));
    const Scene scene = file.load(terrain_scene(file.keys(R"(, "tolerance": 1)")));
    const SceneOverride larger{"/film/width", "6400"};
    TextureReader reader = white_textures();
    reader.heights_from_file = [&](const std::string&) { return file.heights; };
    reader.film_moves = [](const Scene& of) { return moves_of(of.film.width); };
    std::vector<double> told;
    reader.progress = {[&](double done) { told.push_back(done); }};
    CHECK(load_frame(scene, 0, std::span(&larger, 1), reader).meshes[0].object.triangles.size() >
          scene.meshes[0].object.triangles.size());
    CHECK(told.size() > 1);
    CHECK(std::is_sorted(told.begin(), told.end()));
}

TEST_CASE("a terrain keeps its heights where a number of its scene changes", "[scene][terrain]") {
    const HeightsInFile file(mountains(33, 33));
    const Scene scene = file.load(terrain_scene(file.keys(R"(, "heightError": 0.1)")));
    const SceneNumber finer{"/meshes/0/heightError", 0.01};
    const Scene changed = scene_with(scene, std::span(&finer, 1));
    CHECK(changed.meshes[0].object.triangles.size() > scene.meshes[0].object.triangles.size());
    CHECK(changed.meshes[0].terrain->greatest_error <= 0.01);
}

TEST_CASE("terrains that cannot be are refused with their place", "[scene][terrain][bad-input]") {
    const HeightsInFile file(mountains(5, 5));
    CHECK(contains(file.refusal(terrain_scene("\"heights\": \"nowhere.exr\", \"size\": [1, 1, 1]")),
                   "/meshes/0/heights: the picture 'nowhere.exr' does not exist"));
    CHECK(contains(file.refusal(terrain_scene("\"heights\": \"" + file.path + "\"")), "/meshes/0"));
    CHECK(contains(file.refusal(terrain_scene("\"heights\": \"" + file.path + "\", \"size\": [1, 0, 1]")),
                   "/meshes/0/size/1"));
    CHECK(contains(file.refusal(terrain_scene(file.keys(), "object")), "/meshes/0/role"));
    CHECK(contains(file.refusal(terrain_scene(file.keys(), "optic")), "/meshes/0"));
    CHECK(contains(file.refusal(terrain_scene("\"primitive\": {\"type\": \"disk\"}")), "/meshes/0"));
    CHECK(contains(file.refusal(terrain_scene(file.keys(R"(, "thinning": "haar")"))), "heightError"));
    CHECK(
        contains(file.refusal(terrain_scene(file.keys(R"(, "heightError": -1)"))), "/meshes/0/heightError"));
    CHECK(contains(file.refusal(terrain_scene(file.keys(R"(, "heightErrors": 1)"))), "heightError"));
    CHECK(contains(file.refusal(terrain_scene(file.keys(R"(, "tolerance": 0)"))), "/meshes/0/tolerance"));
    CHECK(contains(file.refusal(terrain_scene(file.keys(R"(, "tolerance": 1, "heightError": 1)"))),
                   "'heightError' is no key of a terrain with a tolerance"));
    CHECK(contains(file.refusal(terrain_scene(file.keys(R"(, "tolerance": 1, "fit": {"size": 1})"))),
                   "'fit' is no key of a terrain with a tolerance"));
    CHECK(
        contains(file.refusal(terrain_scene(file.keys(R"(, "heightError": 1, "region": {"radii": [1, 0]})"))),
                 "/meshes/0/region/radii/1"));

    const HeightsInFile thin(HeightGrid{1, 7, 1, std::vector<float>(7, 1)});
    CHECK(contains(thin.refusal(terrain_scene(thin.keys())),
                   "has 1 x 7 samples: a terrain has at least 2 x 2"));
    const HeightsInFile none(
        HeightGrid{3, 3, 1, std::vector<float>(9, std::numeric_limits<float>::quiet_NaN())});
    CHECK(contains(none.refusal(terrain_scene(none.keys())), "no cell"));
    const HeightsInFile vast(HeightGrid{6000, 6000, 1, std::vector<float>(36'000'000, 1)});
    CHECK(contains(vast.refusal(terrain_scene(vast.keys())),
                   "makes 71976002 triangles, more than 40000000: give a larger heightError"));
    CHECK(vast.load(terrain_scene(vast.keys(R"(, "heightError": 0)"))).meshes[0].object.triangles.size() <
          100);
}

TEST_CASE("missing heights and channels that are not read are warned of", "[scene][terrain][bad-input]") {
    HeightGrid heights = mountains(9, 9);
    heights.values[40] = std::numeric_limits<float>::quiet_NaN();
    heights.values[12] = -9999;
    heights.channels = 3;
    const HeightsInFile file(heights);
    const Scene scene = file.load(terrain_scene(file.keys(R"(, "noData": -9999)")));
    std::string warnings;
    for (const std::string& warning : scene.warnings) warnings += warning + "\n";
    CHECK(contains(warnings, "2 samples have no height: the triangles that touch them are left out"));
    CHECK(contains(warnings, "has 3 channels: the heights are the first one"));
    CHECK(make_scene_info(scene).meshes[0].terrain->missing_heights == 2);
    CHECK(scene.meshes[0].object.triangles.size() < 2 * 64 - 8);
}

TEST_CASE("noData is a number of the file, and one that no sample has is warned of", "[scene][terrain]") {
    HeightGrid bytes{
        .columns = 3, .rows = 3, .values = {0, 1, 2, 7, 100, 128, 254, 255, 255}, .greatest = 255};
    for (float& value : bytes.values) value *= 1 / 255.f;
    const HeightsInFile file(bytes);
    const auto warnings = [](const HeightsInFile& in, const std::string& number) {
        std::string all;
        for (const std::string& warning :
             in.load(terrain_scene(in.keys(R"(, "noData": )" + number))).warnings)
            all += warning + "\n";
        return all;
    };
    const std::string none = "/meshes/0/noData: no sample of '" + file.path + "' has that number";
    for (const char* number : {"0", "2", "7", "254"}) {
        INFO(number);
        CHECK(contains(warnings(file, number), "1 samples have no height"));
        CHECK(!contains(warnings(file, number), none));
    }
    for (const char* number : {"3", "-1", "256", "0.00392156862745098", "1.5"}) {
        INFO(number);
        CHECK(contains(warnings(file, number), none));
        CHECK(!contains(warnings(file, number), "no height"));
    }
    HeightGrid said = mountains(5, 5);  // the file has said so itself
    said.values[24] = std::numeric_limits<float>::quiet_NaN();
    said.no_data = -9999;
    const HeightsInFile tagged(said);
    CHECK(!contains(warnings(tagged, "-9999"), "has that number"));
    CHECK(contains(warnings(tagged, "-9998"), "has that number"));
    said.no_data = -3.40282346638529e+38;
    CHECK(!contains(warnings(HeightsInFile(said), "-3.4028234663852886e+38"), "has that number"));
}

TEST_CASE("noData finds floats to their own precision; numbers beyond 1e30 need it",
          "[scene][terrain][bad-input]") {
    const auto missing = [](float sample, const std::string& number) {
        HeightGrid heights = mountains(5, 5);
        heights.values[24] = sample;
        const HeightsInFile file(heights);
        const Scene scene = file.load(terrain_scene(file.keys(R"(, "noData": )" + number)));
        return scene.meshes[0].terrain->missing_heights;
    };
    CHECK(missing(-32768.1f, "-32768.1") == 1);
    CHECK(missing(-32768.1f, "-32768.2") == 0);
    CHECK(missing(-3.4e38f, "-3.4e38") == 1);
    CHECK(missing(std::numeric_limits<float>::lowest(), "-3.4028234663852886e+38") == 1);
    CHECK(missing(std::numeric_limits<float>::lowest(), "-3.40282346638529e+38") == 1);
    CHECK(missing(-std::numeric_limits<float>::infinity(), "-1.7976931348623157e308") == 1);

    HeightGrid heights = mountains(5, 5);
    heights.values[13] = -3e38f;
    const HeightsInFile file(heights);
    for (const char* keys : {"", R"(, "noData": -9999)"})
        CHECK(contains(file.refusal(terrain_scene(file.keys(keys))),
                       "/meshes/0/heights: the sample in column 3, row 2 is -3"));
    CHECK(contains(file.refusal(terrain_scene(file.keys())), "if that is no height, say so by noData"));
}
