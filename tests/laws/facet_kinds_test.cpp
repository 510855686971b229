// What facets are among the general linear cameras, asked of scenes, pixels and the command.
#include <map>
#include <string>

#include "cli/command_line.h"
#include "support/test.h"
#include "trilens/trilens.h"

using namespace trilens;
using namespace trilens_test;

namespace {

Scene optic_before_wall(const Primitive& optic) {
    Scene scene;
    scene.film = {64, 48, 1};
    CameraDescription camera;
    camera.name = "main";
    camera.eye = {0.4, 0.7, 5};
    camera.at = {0, 0, 0};
    camera.kind = PerspectiveCamera{.yfov = 30};
    scene.cameras.push_back(camera);
    Material chrome, red;
    chrome.metallic_factor = 1;
    red.unlit = true;
    scene.materials = {chrome, red};
    Mesh mirror, wall;
    mirror.name = "mirror", mirror.role = Role::kOptic, mirror.material = 0, mirror.resolution = 16;
    mirror.primitive = optic;
    wall.name = "wall";
    wall.object.points = {{-60, -60, 9}, {60, -60, 9}, {60, 60, 9}, {-60, 60, 9}};
    wall.object.triangles = {{0, 1, 2}, {0, 2, 3}};
    wall.object.material = {1, 1};
    scene.meshes = {mirror, wall};
    return scene;
}

/// How many ends of pixels on the optic are of which kind.
std::map<std::string, int> kinds_over_film(const Scene& scene) {
    const Renderer renderer(scene);
    std::map<std::string, int> counts;
    for (int y = 0; y < scene.film.height; y += 3)
        for (int x = 0; x < scene.film.width; x += 3) {
            const PixelExplanation pixel = renderer.explain({}, x, y);
            REQUIRE(pixel.camera_kind == GeneralLinearKind::kPinhole);
            REQUIRE(pixel.camera_facet < 2);
            for (const PixelEnd& end : pixel.ends)
                ++counts[end.facet_kind ? general_linear_kind_name(*end.facet_kind) : "none"];
        }
    return counts;
}

}  // namespace

TEST_CASE("a flat mirror is a pinhole, a ball one of two slits: rays of one eye stay normal to a surface",
          "[laws][law]") {
    Primitive flat;
    flat.kind = PlanePrimitive();
    flat.axis = {0, 0, 1};
    const auto of_flat = kinds_over_film(optic_before_wall(flat));
    REQUIRE(of_flat.size() == 1);
    CHECK(of_flat.at("pinhole") > 50);

    // By Malus' and Dupin's theorem the rays have two real foci everywhere: in the limit no facet is
    // bilinear.
    auto of_ball = kinds_over_film(optic_before_wall(Primitive{}));
    CHECK(of_ball["crossedSlits"] > 50);
    CHECK(of_ball["bilinear"] * 20 < of_ball["crossedSlits"]);
    CHECK(of_ball["pinhole"] == 0);
}

TEST_CASE("the exact rays of the limit truth belong to no facet", "[laws][law]") {
    PictureRequest truth;
    truth.engine = Engine::kLimitTruth;
    const PixelExplanation pixel = Renderer(optic_before_wall(Primitive{})).explain(truth, 32, 24);
    CHECK(pixel.camera_facet == kNone);
    CHECK_FALSE(pixel.camera_kind);
    REQUIRE(pixel.ends.size() == 1);
    CHECK_FALSE(pixel.ends[0].facet_kind);
}

TEST_CASE("scene info and --pixel name the kinds of facets", "[laws][law]") {
    const std::string scene = source_dir() + "/scenes/cameras.json";
    const CommandRun text = run_trilens("scene info " + scene),
                     json = run_trilens("scene info --json " + scene);
    CHECK(text.out.find("  camera  strip: pushbroom, 8192 facets: pushbroom\n") != std::string::npos);
    CHECK(text.out.find("  camera  oblique: oblique, 2 facets: orthographic\n") != std::string::npos);
    CHECK(text.out.find("  camera  panorama: spherical, 8192 facets: 8064 pinhole, 128 none\n") !=
          std::string::npos);
    CHECK(json.out.find("\"pushbroom\": 8192\n") != std::string::npos);
    CHECK(json.out.find("\"pinhole\": 8064,\n      \"none\": 128\n") != std::string::npos);

    const CommandRun pixel = run_trilens("render " + scene + " --camera strip --pixel 320,240 --json");
    CHECK(pixel.exit_code == 0);
    CHECK(pixel.out.find("\"facet_kind\": \"pushbroom\"") != std::string::npos);
    CHECK(pixel.out.find("\"facet_kind\": \"crossedSlits\"") != std::string::npos);
}
