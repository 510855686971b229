// A camera in glass: its rays run in that from the beginning, for truth, projector and point images alike.
#include <algorithm>
#include <cmath>

#include "laws/agreement.h"
#include "laws/worlds.h"
#include "render/engines/engine.h"
#include "render/picture/sample_colour.h"
#include "render/project/project.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::string kPlainPerspective =
    R"({"name":"main","yfov":70,"lookAt":{"eye":[0.2,0.3,1.5],"at":[0,0,-0.4],"up":[0,1,0]}})";

/// A big ball of tinted glass with a ball of light glass and a mirror in it, in a room; `more` meshes.
std::string glass_room(const std::string& camera, const std::string& render, const std::string& more = "") {
    return R"({"version":1,"film":{"width":96,"height":72},"cameras":[)" + camera + R"(],"render":{)" +
           render +
           R"(},"materials":[{"name":"glass","transmissionFactor":1,"ior":1.5,"volume":{"attenuationColor":[0.6,0.9,0.7],"attenuationDistance":3}},
             {"name":"light","transmissionFactor":1,"ior":1.2},{"name":"mirror","metallicFactor":1},
             {"name":"red","unlit":true,"baseColorFactor":[0.8,0.3,0.2]},{"name":"blue","unlit":true,"baseColorFactor":[0.2,0.4,0.8]}],
           "meshes":[)" +
           more +
           R"({"name":"big","role":"optic","material":"glass","primitive":{"type":"sphere","center":[0,0,0],"radius":2}},
             {"name":"small","role":"optic","material":"light","priority":1,"primitive":{"type":"sphere","center":[0,0,-0.5],"radius":0.5}},
             {"name":"mirror","role":"optic","material":"mirror","primitive":{"type":"sphere","center":[-0.8,-0.2,-0.6],"radius":0.35}},
             {"name":"wall","role":"object","material":"red","points":[[-4,-3,-5],[4,-3,-5],[4,4,-5],[-4,4,-5]],"faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]},
             {"name":"floor","role":"object","material":"blue","points":[[-4,-3,-5],[4,-3,-5],[4,-3,6],[-4,-3,6]],"faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]},
             {"name":"inside","role":"object","material":"blue","points":[[0.7,-0.5,-0.5],[1.1,-0.5,-0.5],[1.1,0.3,-0.5],[0.7,0.3,-0.5]],"faceVertexCounts":[4],"faceVertexIndices":[0,1,2,3]}]})";
}

std::vector<std::string> said(const World& world, Engine engine) {
    std::vector<std::string> all;
    make_viewer(world, {}, engine, [&](const std::string& message) {
        if (message.find("inside of") != std::string::npos) all.push_back(message);
    });
    return all;
}

}  // namespace

TEST_CASE("from inside of glass, past other glass: projector and Embree on the same facets",
          "[laws][oracle][law]") {
    struct Case {
        std::string name, camera, render;
    };
    const std::string look = R"("lookAt":{"eye":[0.2,0.3,1.2],"at":[0,0,-0.4],"up":[0,1,0]}})";
    const std::vector<Case> cases = {
        {"perspective", kPlainPerspective, R"("maxDepth":8,"fresnel":false)"},
        {"perspective, weighted", kPlainPerspective, R"("maxDepth":8)"},
        {"first optic alone", kPlainPerspective, R"("maxDepth":0)"},
        {"in both",
         R"({"name":"main","yfov":70,"lookAt":{"eye":[0.1,0.1,-0.4],"at":[-1,0,-0.6],"up":[0,1,0]}})",
         R"("maxDepth":8,"fresnel":false)"},
        {"near plane", R"({"name":"main","yfov":60,"near":0.5,)" + look, R"("maxDepth":8,"fresnel":false)"},
        {"parallel rays", R"({"name":"main","type":"orthographic","ymag":2.5,)" + look,
         R"("maxDepth":8,"fresnel":false)"},
        {"fisheye", R"({"name":"main","type":"fisheye","fov":150,)" + look,
         R"("maxDepth":8,"fresnel":false)"}};
    for (const Case& one : cases) {
        const auto world = world_from("in_glass", glass_room(one.camera, one.render), 10);
        const Agreement a = compare_engines(*world);
        INFO(one.name << ": " << a.first_off_edge);
        CHECK(a.off_edge == 0);
        CHECK(a.optic_pixels > a.pixels / 8);
        CHECK(said(*world, Engine::kExact).empty());
        CHECK(said(*world, Engine::kLimitTruth).empty());
    }
}

TEST_CASE("from inside of glass the projected picture is the truth's", "[laws][oracle][law]") {
    const auto world =
        world_from("in_glass", glass_room(kPlainPerspective, R"("maxDepth":8,"fresnel":false)"), 16);
    const SampleGrid grid{0, 0, 96, 72, 1};
    SampleViews projected, traced;
    make_viewer(*world, {}, Engine::kExact, ignore)->view(grid, projected);
    make_viewer(*world, {}, Engine::kLimitTruth, ignore)->view(grid, traced);
    std::size_t other = 0, drawn = 0;
    double worst = 0;
    for (std::size_t s = 0; s < grid.size(); ++s) {
        const SampleView &a = projected.samples[s], &b = traced.samples[s];
        drawn += a.optic != kNone && !a.traced;
        const auto shown = [](const SampleViews& views, const SampleView& view, Path path) {
            const PathEnd* end = views.find(view, path);
            return std::pair(end != nullptr, end ? end->hit.triangle : kNone);
        };
        if (a.optic != b.optic || shown(projected, a, Path::kRefract) != shown(traced, b, Path::kRefract) ||
            shown(projected, a, Path::kReflect) != shown(traced, b, Path::kReflect)) {
            ++other;
            continue;
        }
        const SampleColour c = sample_colour(*world, projected, a), d = sample_colour(*world, traced, b);
        const Vec3 off = glm::abs(c.direct + c.reflect + c.refract - d.direct - d.reflect - d.refract);
        worst = std::max({worst, off.x, off.y, off.z});
    }
    CHECK(drawn > grid.size() / 2);
    CHECK(other < grid.size() / 40);
    CHECK(worst < 0.05);
}

TEST_CASE("tinted glass around the eye takes light on the way to what is seen in it", "[laws][law]") {
    const auto world = world_from("in_glass", glass_room(kPlainPerspective, R"("maxDepth":8)"), 8);
    for (const Engine engine : {Engine::kExact, Engine::kLimitTruth}) {
        SampleViews views;
        make_viewer(*world, {}, engine, ignore)->view({0, 0, 96, 72, 1}, views);
        std::size_t seen = 0;
        for (const SampleView& view : views.samples) {
            if (view.optic != kNone || !view.hit.seen()) continue;
            REQUIRE(world->names[world->objects.object[view.hit.triangle]] == "inside");
            ++seen;
            const double way = length(view.hit.t * view.ray.direction);
            const SampleColour colour = sample_colour(*world, views, view);
            const Vec3 own(0.2, 0.4, 0.8), tint(0.6, 0.9, 0.7);
            for (int c = 0; c < 3; ++c)
                CHECK(colour.direct[c] == Approx(own[c] * std::pow(tint[c], way / 3)).epsilon(1e-12));
        }
        CHECK(seen > 20);
    }
}

TEST_CASE("points are imaged into glass where its truth shows them", "[laws][law]") {
    const auto world =
        world_from("in_glass", glass_room(kPlainPerspective, R"("maxDepth":8,"fresnel":false)"), 16);
    SampleViews views;
    const SampleGrid grid{0, 0, 96, 72, 1};
    make_viewer(*world, {}, Engine::kLimitTruth, ignore)->view(grid, views);
    std::vector<Vec3> points;
    std::vector<Vec2> pixels;
    std::vector<std::vector<Step>> steps;
    for (std::size_t s = 0; s < grid.size(); s += 97) {
        const SampleView& view = views.samples[s];
        const PathEnd* end = view.optic == kNone ? nullptr : views.find(view, Path::kRefract);
        if (!end || !end->hit.seen() || end->step_count > 3) continue;
        points.push_back(end->ray.origin + end->hit.t * end->ray.direction);
        pixels.push_back(grid.position(s));
        const auto own = views.steps_of(*end);
        steps.emplace_back(own.begin(), own.end());
    }
    REQUIRE(points.size() > 30);
    const std::vector<PointProjection> found = project_points(*world, {}, points);
    std::size_t several = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        INFO("pixel " << pixels[i].x << "," << pixels[i].y << ", " << steps[i].size() << " steps");
        several += steps[i].size() > 1;
        CHECK(std::any_of(found[i].images.begin(), found[i].images.end(), [&](const WorldImage& image) {
            return image.steps == steps[i] && length(image.pixel - pixels[i]) < 1e-6;
        }));
    }
    CHECK(several > 0);
}

TEST_CASE("glass that holds the eye in some directions only is told of", "[laws][law]") {
    const std::string gutter =
        R"({"name":"gutter","role":"optic","material":"glass","points":[[-2,-1,-3],[2,-1,-3],[2,-1,3],[-2,-1,3],[2,2,-3],[2,2,3],[-2,2,-3],[-2,2,3]],
           "faceVertexCounts":[4,4,4],"faceVertexIndices":[0,1,2,3, 1,4,5,2, 0,3,7,6]},)";
    const auto world = world_from("in_glass", glass_room(kPlainPerspective, R"("maxDepth":8)", gutter), 4);
    for (const Engine engine : {Engine::kExact, Engine::kLimitTruth}) {
        const std::vector<std::string> warnings = said(*world, engine);
        REQUIRE(warnings.size() == 1);
        CHECK(warnings[0].find("the camera is inside of gutter in some directions only") == 0);
    }
}
