// Scenes in which facets drawn whole once showed what no exact ray sees: things between the points that were
// looked at, paths that end at the first optic, outlines.
#include <algorithm>
#include <string>

#include "laws/hunt.h"
#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "scene/load.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::unique_ptr<World> whole_world_of(const std::string& json) {
    return make_world(load_scene_text(json, SceneSource("test", ""), {}, {}), ignore);
}

/// A film of 320 x 240 pixels, materials, a floor and a wall; meshes as they are given.
std::string scene_of(const std::string& camera, int max_depth, const std::string& optics) {
    return R"({ "version": 1, "film": { "width": 320, "height": 240 }, "cameras": [ { "name": "c", )" +
           camera + R"( } ], "background": { "color": [0.1, 0.2, 0.3] }, "render": { "maxDepth": )" +
           std::to_string(max_depth) +
           R"( }, "materials": [ { "name": "glass", "transmissionFactor": 1, "ior": 1.5 },
    { "name": "diamond", "transmissionFactor": 1, "ior": 2.4 },
    { "name": "gold", "metallicFactor": 1, "baseColorFactor": [0.9, 0.5, 0.2] },
    { "name": "red", "unlit": true, "baseColorFactor": [0.8, 0.1, 0.1] } ],
  "meshes": [ )" +
           optics + R"(, { "name": "floor", "role": "object", "material": "red",
    "points": [[-4,-2,-4],[4,-2,-4],[4,-2,6],[-4,-2,6]], "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0] },
    { "name": "wall", "role": "object", "material": "red",
    "points": [[-3,-2,-5],[3,-2,-5],[3,1,-5],[-3,1,-5]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] } ] })";
}

const char* const kAbove = R"("yfov": 40, "lookAt": { "eye": [0, 1.2, 4.4], "at": [0, 0, 0] })";

std::string whole_ball(const std::string& name, const std::string& material, const Vec3& at, double radius) {
    std::ostringstream out;
    out << R"({ "name": ")" << name << R"(", "role": "optic", "material": ")" << material
        << R"(", "primitive": { "type": "sphere", "center": [)" << at.x << ", " << at.y << ", " << at.z
        << R"(], "radius": )" << radius << " } }";
    return out.str();
}

std::string plane(const std::string& material, double z) {
    return R"({ "name": "pane", "role": "optic", "material": ")" + material +
           R"(", "primitive": { "type": "plane", "center": [0, 0, )" + std::to_string(z) +
           R"(], "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [6, 4] } })";
}

FrameParams frame_of(int n, double max_error = 0) {
    FrameParams frame;
    frame.resolution = n;
    if (max_error > 0) frame.max_error = max_error;
    return frame;
}

/// Pixels that show another optic first than the exact surfaces, and those whose neighbours show another,
/// too.
struct Outlines {
    std::size_t differ = 0, far = 0;
    LayerStatistics said;
};

Outlines outlines_of(const World& world, const FrameParams& frame) {
    PictureRequest request;
    request.frame = frame;
    request.layers.layers = {"optic"};
    const Picture drawn = draw_picture(world, request, {}, ignore);
    request.engine.engine = Engine::kLimitTruth;
    const Picture truth = draw_picture(world, request, {}, ignore);
    const auto* seen = drawn.image.find("optic.object");
    const auto* exact = truth.image.find("optic.object");
    REQUIRE((seen && exact));
    const int width = truth.image.width, height = truth.image.height;
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(std::clamp(y, 0, height - 1) * width + std::clamp(x, 0, width - 1));
    };
    Outlines outlines;
    outlines.said = drawn.statistics;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Id shown = seen->ids()[at(x, y)];
            if (shown == exact->ids()[at(x, y)]) continue;
            ++outlines.differ;
            bool beside = false;
            for (const auto& [dx, dy] :
                 {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)})
                beside = beside || exact->ids()[at(x + dx, y + dy)] == shown;
            outlines.far += !beside;
        }
    return outlines;
}

}  // namespace

TEST_CASE("A ball behind a pane of glass is seen wherever it is", "[laws][law][thorough]") {
    for (const double radius : {0.05, 0.1, 0.2})
        for (int i = 0; i < 6; i += 2) {
            const Vec3 at(-1.1 + 0.37 * i, 0.5 - 0.13 * i, -1 - 0.1 * i);
            const auto world = whole_world_of(
                scene_of(kAbove, 4, plane("glass", 0.5) + ", " + whole_ball("ball", "gold", at, radius)));
            for (const double max_error : {0.0, 0.5}) {
                const Bag bag = beside_truth(*world, frame_of(8, max_error));
                INFO("radius " << radius << ", place " << i << ", error " << max_error);
                CHECK(bag.missing.empty());
                CHECK(bag.other <= 2);
            }
        }
}

TEST_CASE("A flat mirror shows a ball whatever error is asked for", "[laws][law][thorough]") {
    for (const double radius : {0.04, 0.1})
        for (int i = 0; i < 4; ++i) {
            const auto world = whole_world_of(
                scene_of(kAbove, 4,
                         plane("gold", -2) + ", " +
                             whole_ball("ball", "gold", {-0.9 + 0.6 * i, 0.7 - 0.2 * i, -0.5}, radius)));
            for (const double max_error : {0.0, 0.1, 0.5}) {
                const Bag bag = beside_truth(*world, frame_of(4, max_error));
                INFO("radius " << radius << ", place " << i << ", error " << max_error);
                CHECK(bag.missing.empty());
                if (max_error > 0) CHECK(bag.other <= 5);  // slivers at the ball's rim
            }
        }
}

TEST_CASE("Paths that end at the first optic are true where the eye is in it", "[laws][law]") {
    const char* const inside = R"("yfov": 90, "lookAt": { "eye": [0.5, 0.2, 0.3], "at": [-1, 0, -1] })";
    for (const char* const material : {"diamond", "gold"})
        for (const int n : {8, 32}) {
            const auto world =
                whole_world_of(scene_of(inside, 0, whole_ball("ball", material, {0, 0, 0}, 1)));
            const Bag bag = beside_truth(*world, frame_of(n));
            INFO(material << ", n " << n);
            CHECK(bag.other == 0);
        }
}

TEST_CASE("A path that carries no light shows nothing, projected or traced", "[laws][law]") {
    // Glass without Fresnel passes all light on: at its front nothing is reflected.
    std::string json = scene_of(kAbove, 0, whole_ball("ball", "glass", {0, 0, 0}, 1));
    json.replace(json.find("\"maxDepth\": 0"), 13, "\"maxDepth\": 0, \"fresnel\": false");
    const auto world = whole_world_of(json);
    for (const Engine engine : {Engine::kExact, Engine::kFacetsTruth, Engine::kLimitTruth}) {
        PictureRequest request;
        request.frame.resolution = 8;
        request.engine.engine = engine;
        const Picture picture = draw_picture(*world, request, {}, ignore);
        const auto count = [&](const char* channel) {
            const Channel* ids = picture.image.find(channel);
            REQUIRE(ids);
            return std::count_if(ids->ids().begin(), ids->ids().end(), [](Id id) { return id != kNone; });
        };
        INFO(engine_name(engine));
        CHECK(count("optic.object") > 3000);
        CHECK(count("reflectID.object") == 0);
        CHECK(count("refractID.object") > 1000);
    }
}

TEST_CASE("The outline of an optic is that of its surface within the error asked for", "[laws][law]") {
    const std::string balls = whole_ball("ball", "gold", {-0.4, 0, 0}, 0.9) + ", " +
                              whole_ball("small", "glass", {1, 0.4, -1}, 0.3);
    for (const char* const camera :
         {kAbove,
          R"("type": "orthographic", "ymag": 1.6, "lookAt": { "eye": [0, 1.2, 4.4], "at": [0, 0, 0] })",
          R"("type": "fisheye", "fov": 120, "lookAt": { "eye": [0, 1.2, 3], "at": [0, 0, 0] })"})
        for (const int n : {1, 2, 4, 8}) {
            const auto world = whole_world_of(scene_of(camera, 2, balls));
            INFO(camera << ", n " << n);
            const Outlines plain = outlines_of(*world, frame_of(n));
            // What is said to be lost to the outline: within a factor of four.
            if (plain.differ > 100) {
                CHECK(plain.said.outline_pixels > 0.25 * static_cast<double>(plain.differ));
                CHECK(plain.said.outline_pixels < 4.0 * static_cast<double>(plain.differ));
            }
            const Outlines half = outlines_of(*world, frame_of(n, 0.5)),
                           exact = outlines_of(*world, frame_of(n, 0.01));
            CHECK(half.far == 0);
            CHECK(half.differ < 60);  // middles of pixels within half a pixel of the outline
            CHECK(half.said.predicted_error <= 0.5);
            CHECK(exact.differ <= 1);
            CHECK(exact.said.predicted_error <= 0.01);
            CHECK(exact.said.outline_pixels < 5);
        }
}

TEST_CASE("Where mirrors cross, a path starts on the one that comes first, not inside of it", "[laws][law]") {
    const std::string balls = R"({ "name": "one", "role": "optic", "material": "gold",
    "primitive": { "type": "sphere", "center": [-0.5, 0, 0], "radius": 0.9 } },
  { "name": "two", "role": "optic", "material": "gold",
    "primitive": { "type": "sphere", "center": [0.45, 0.2, 0.1], "radius": 0.8 } })";
    const auto world = whole_world_of(scene_of(kAbove, 32, balls));
    const auto most_met = [&](Engine engine, int n) {
        PictureRequest request;
        request.frame = frame_of(n);
        request.engine = engine;
        request.layers.layers = {"path"};
        const Picture picture = draw_picture(*world, request, {}, ignore);
        const auto& count = picture.image.find("path.count")->ids();
        return *std::max_element(count.begin(), count.end());
    };
    const Id truth = most_met(Engine::kLimitTruth, 8);
    CHECK(truth >= 2);
    for (const int n : {1, 2, 4, 8, 16})
        for (const Engine engine : {Engine::kExact, Engine::kFacetsTruth}) {
            INFO("n " << n << ", " << engine_name(engine));
            CHECK(most_met(engine, n) <= truth);
        }
}
