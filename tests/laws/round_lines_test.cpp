// Line drawings of finely divided balls, whose last triangles before the rim are thinner than a sample: their
// silhouettes are no dashes.
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "laws/line_borders.h"
#include "support/test.h"
#include "trilens/trilens.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A ball of flat quads cut into triangles, `divisions` from pole to pole and twice as many around.
ObjectMesh ball_mesh(const Vec3& center, double radius, Id divisions) {
    ObjectMesh ball;
    const auto point = [&](Id row, Id column) {
        const double polar = std::numbers::pi * row / divisions,
                     around = std::numbers::pi * column / divisions;
        return center + radius * Vec3(std::sin(polar) * std::cos(around), std::cos(polar),
                                      std::sin(polar) * std::sin(around));
    };
    for (Id row = 0; row <= divisions; ++row)
        for (Id column = 0; column < 2 * divisions; ++column)
            ball.points.push_back(row == 0 || row == divisions ? point(row, 0) : point(row, column));
    const auto at = [&](Id row, Id column) { return row * 2 * divisions + column % (2 * divisions); };
    for (Id row = 0; row < divisions; ++row)
        for (Id column = 0; column < 2 * divisions; ++column) {
            if (row + 1 < divisions)
                ball.triangles.push_back({at(row, column), at(row + 1, column + 1), at(row + 1, column)});
            if (row > 0)
                ball.triangles.push_back({at(row, column), at(row, column + 1), at(row + 1, column + 1)});
        }
    ball.material.assign(ball.triangles.size(), 0);
    return ball;
}

enum class Over { kNothing, kPlane, kSphere };

Scene balls_over(const CameraKind& camera, Over over, Id divisions, unsigned seed) {
    std::mt19937 random(seed);
    const auto number = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / static_cast<double>(random.max());
    };
    Scene scene;
    scene.film = {96, 72, 1};
    CameraDescription view;
    view.name = "main", view.kind = camera;
    view.eye = {0, 0, 6}, view.at = Vec3(0);
    scene.cameras = {view};
    Material plain, chrome;
    plain.unlit = true, chrome.metallic_factor = 1;
    scene.materials = {plain, chrome};
    for (int k = 0; k < 3; ++k) {
        Mesh ball;
        ball.name = "ball " + std::to_string(k);
        const double height = over == Over::kNothing ? number(-0.5, 0.5) : number(9, 11);
        const double spread = over == Over::kNothing ? 1 : 4;
        ball.object =
            ball_mesh({spread * (1.1 * (k - 1) + number(-0.1, 0.1)), spread * number(-0.6, 0.6), height},
                      spread * number(0.3, 0.5), divisions);
        scene.meshes.push_back(ball);
    }
    if (over == Over::kNothing) return scene;
    Mesh mirror;
    mirror.name = "mirror", mirror.role = Role::kOptic, mirror.material = 1, mirror.resolution = 8,
    mirror.rays = CornerRays::kInterpolated;
    mirror.primitive = Primitive{.axis = {0, 0, 1}, .kind = PlanePrimitive{.size = {9, 7}}};
    if (over == Over::kSphere) mirror.primitive = Primitive{.kind = SpherePrimitive{.radius = 1.7}};
    scene.meshes.push_back(mirror);
    return scene;
}

}  // namespace

TEST_CASE("a ball's silhouette is whole, however finely the ball is divided", "[laws][vector][law]") {
    const std::vector<CameraKind> cameras{PerspectiveCamera{.yfov = 35}, OrthographicCamera{.ymag = 1.8},
                                          FisheyeCamera{.fov = 50}};
    for (std::size_t camera = 0; camera < cameras.size(); ++camera)
        for (const Over over : {Over::kNothing, Over::kPlane, Over::kSphere})
            for (const Id divisions : {24u, 100u}) {
                const Renderer renderer(balls_over(cameras[camera], over, divisions, divisions + 7));
                const LinedBorders borders = lined_borders(renderer);
                INFO("camera " << camera << ", over " << static_cast<int>(over) << ", " << divisions
                               << " divisions: " << borders.without << " of " << borders.count
                               << " without a line, farthest " << borders.farthest);
                REQUIRE(borders.count > 40);
                CHECK(borders.without == 0);
            }
}

TEST_CASE("lines in facets of the film of a camera that is not linear name those", "[laws][vector][law]") {
    Scene scene = balls_over(FisheyeCamera{.fov = 50}, Over::kPlane, 24, 3);
    scene.meshes.back().resolution = 3;
    for (const GridKind grid : {GridKind::kSurface, GridKind::kScreen}) {
        scene.meshes.back().grid = grid;
        const std::string svg = Renderer(scene).draw_lines({}).svg;
        CHECK(svg.find("data-facet", svg.find("class=\"reflect\"")) != std::string::npos);
    }
}
