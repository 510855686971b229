// Facets on the film against the truth on the same rays and on the exact surface; the usual approximations
// where they are none.
#include <algorithm>
#include <cmath>

#include "support/test.h"
#include "trilens/trilens.h"

using namespace trilens;

namespace {

/// A ball, or a plate, in a room whose walls are `far` away.
Scene in_room(double far, const Primitive& primitive, bool glass) {
    Scene scene;
    scene.film = {96, 72, 1};
    CameraDescription camera;
    camera.name = "main";
    camera.eye = {0.4, 0.6, 3};
    scene.cameras.push_back(camera);
    Material optic, wall;
    (glass ? optic.transmission_factor : optic.metallic_factor) = 1;
    wall.unlit = true;
    scene.materials = {optic, wall};
    Mesh mesh;
    mesh.name = "optic";
    mesh.role = Role::kOptic;
    mesh.material = 0;
    mesh.primitive = primitive;
    scene.meshes.push_back(mesh);
    // Each wall is an object of its own, cut in four.
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-far, far}) {
            Mesh one;
            one.name = "wall" + std::to_string(scene.meshes.size());
            Vec3 middle(0), a(0), b(0);
            middle[axis] = side;
            a[(axis + 1) % 3] = far;
            b[(axis + 2) % 3] = far;
            one.object.points = {middle, middle - a - b, middle + a - b, middle + a + b, middle - a + b};
            one.object.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
            one.object.material = {1, 1, 1, 1};
            scene.meshes.push_back(one);
        }
    return scene;
}

std::vector<Id> layer_ids(const Renderer& renderer, const EngineChoice& engine, const std::string& layer,
                          FrameParams frame = {}) {
    PictureRequest request;
    request.engine = engine;
    request.frame = frame;
    const Image image = renderer.draw(request).image;
    std::vector<Id> ids = image.find(layer + "ID.object")->ids();
    const std::vector<Id>& primitive = image.find(layer + "ID.primitive")->ids();
    for (std::size_t p = 0; p < ids.size(); ++p) ids[p] = ids[p] * 8 + primitive[p];
    return ids;
}

std::size_t different(const std::vector<Id>& a, const std::vector<Id>& b) {
    std::size_t count = 0;
    for (std::size_t p = 0; p < a.size(); ++p) count += a[p] != b[p];
    return count;
}

FrameParams on_film(int n) {
    FrameParams frame;
    frame.resolution = n;
    frame.grid = GridKind::kScreen;
    return frame;
}

Primitive plate() {
    return {.kind = PlanePrimitive()};
}

}  // namespace

TEST_CASE("facets on the film show what rays along them meet, and come to the exact surface's picture",
          "[laws][law]") {
    for (const bool glass : {false, true}) {
        const Renderer renderer(in_room(4, Primitive{}, glass));
        const std::string layer = glass ? "refract" : "reflect";
        const std::vector<Id> truth = layer_ids(renderer, Engine::kLimitTruth, layer);
        std::vector<std::size_t> wrong;
        for (const int n : {4, 8, 16, 32}) {
            const std::vector<Id> drawn = layer_ids(renderer, Engine::kExact, layer, on_film(n));
            CHECK(different(drawn, layer_ids(renderer, Engine::kFacetsTruth, layer, on_film(n))) == 0);
            wrong.push_back(different(drawn, truth));
        }
        INFO(layer << ": " << wrong[0] << ", " << wrong[1] << ", " << wrong[2] << ", " << wrong[3]);
        CHECK(wrong[0] > 4 * wrong[3]);
        CHECK(wrong[3] * 100 < truth.size());
    }
}

TEST_CASE("an environment map is right where everything is far away, and wrong nearby", "[laws][law]") {
    const Renderer far(in_room(1e6, Primitive{}, false)), near(in_room(3.5, Primitive{}, false));
    FrameParams same_rays;
    same_rays.rays = CornerRays::kInterpolated;
    const auto wrong = [&](const Renderer& renderer) {
        return different(layer_ids(renderer, Engine::kEnvironment, "reflect"),
                         layer_ids(renderer, Engine::kExact, "reflect", same_rays));
    };
    CHECK(wrong(far) == 0);
    CHECK(wrong(near) > 50);
}

TEST_CASE("flat facets are right for a flat mirror and wrong for a ball", "[laws][law]") {
    const Renderer flat(in_room(4, plate(), false)), round(in_room(4, Primitive{}, false));
    const auto wrong = [&](const Renderer& renderer) {
        return different(layer_ids(renderer, Engine::kPlanar, "reflect"),
                         layer_ids(renderer, Engine::kExact, "reflect"));
    };
    CHECK(wrong(flat) == 0);
    CHECK(wrong(round) > 100);
}
