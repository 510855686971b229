// The weight of an image is what pictures give that path: the traced pixel's, and none that carries no light.
#include <algorithm>
#include <span>

#include "laws/worlds.h"
#include "render/engines/engine.h"
#include "render/frame/camera_rays.h"
#include "render/picture/sample_colour.h"
#include "render/project/project.h"
#include "scene/load.h"
#include "shade/shade.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

PictureRequest traced() {
    PictureRequest request;
    request.engine.engine = Engine::kLimitTruth;
    return request;
}

/// What a traced path weighs, from what its last ray meets to the eye.
Vec3 traced_weight(const World& world, const SampleViews& pixel, const PathEnd& end) {
    const OpticWeights first = first_weights(world, pixel, pixel.samples.front());
    Vec3 weight = (end.path == Path::kReflect ? first.reflect : first.refract) * end.weight;
    if (end.medium != kNone)
        weight *=
            volume_transmittance(world.scene.materials[world.optics[end.medium].material], path_length(end));
    return weight;
}

struct Tally {
    std::size_t paths = 0, found = 0, several = 0;
    double worst = 0;  // difference of weights
};

struct TracedPath {
    Vec2 pixel{0};
    std::vector<Step> steps;
    Vec3 weight{0}, point{0};
};

/// The paths of the pixels of a lattice that carry light to the eye.
std::vector<TracedPath> traced_paths(const World& world, int step) {
    std::vector<TracedPath> paths;
    const Film& film = world.scene.film;
    const PictureRequest truth = traced();
    const std::unique_ptr<Viewer> viewer = make_viewer(world, truth.frame, truth.engine, Warn());
    for (int y = step / 2; y < film.height; y += step)
        for (int x = step / 2; x < film.width; x += step) {
            SampleViews pixel;
            viewer->view({x, y, x + 1, y + 1, 1}, pixel);
            for (const PathEnd& end : pixel.ends_of(pixel.samples.front())) {
                // Of a dispersed path green alone is searched for.
                if (!end.hit.seen() || (end.colours != kAllColours && end.colours != 1)) continue;
                const Vec3 weight = traced_weight(world, pixel, end);
                if (weight == Vec3(0)) continue;
                const std::span<const Step> steps = pixel.steps_of(end);
                paths.push_back({Vec2(x + 0.5, y + 0.5), {steps.begin(), steps.end()}, weight,
                                 end.ray.origin + end.hit.t * end.ray.direction});
            }
        }
    return paths;
}

/// Projects what each pixel of a lattice sees and looks for the image that the pixel is.
Tally compare(const World& world, int step) {
    const std::vector<TracedPath> paths = traced_paths(world, step);
    std::vector<Vec3> points;
    for (const TracedPath& path : paths) points.push_back(path.point);
    const std::vector<PointProjection> all = project_points(world, {}, points);
    Tally tally;
    for (std::size_t i = 0; i < paths.size(); ++i) {
        ++tally.paths;
        for (const WorldImage& image : all[i].images) {
            if (image.steps != paths[i].steps || length(image.pixel - paths[i].pixel) > 1e-3) continue;
            ++tally.found;
            tally.several += image.steps.size() > 1;
            const Vec3 off = glm::abs(image.weight - paths[i].weight);
            tally.worst = std::max({tally.worst, off.x, off.y, off.z});
            break;
        }
    }
    return tally;
}

}  // namespace

TEST_CASE("an image of project weighs what the traced pixel's path does", "[laws][law][thorough]") {
    std::size_t compared = 0, several = 0;
    for (const char* name :
         {"sphere", "water", "torus", "paths/crystal-ball", "paths/under-water", "paths/meniscus",
          "paths/mirror-balls", "paths/prism", "paths/glass-before-mirror"}) {
        CAPTURE(name);
        const auto world = shipped_world(name, 4, 64, 48);
        if (!world) continue;
        const Tally tally = compare(*world, 10);
        CHECK(tally.worst < 1e-6);
        CHECK(10 * tally.found >= 7 * tally.paths);
        compared += tally.found;
        several += tally.several;
    }
    CHECK(compared > 100);
    CHECK(several > 30);
}

TEST_CASE(
    "what carries no light is no image: glass without Fresnel's equations reflects below the critical angle "
    "nothing",
    "[laws][oracle][law]") {
    const auto world_with = [](const char* fresnel) {
        const std::string json =
            std::string(R"({ "version": 1, "film": { "width": 64, "height": 48 },
  "cameras": [ { "name": "c", "type": "perspective", "yfov": 40, "lookAt": { "eye": [0, 0.5, 4], "at": [0, 0, 0] } } ],
  "render": { "fresnel": )") +
            fresnel +
            R"( }, "materials": [ { "name": "glass", "transmissionFactor": 1, "ior": 1.5 } ],
  "meshes": [ { "name": "ball", "role": "optic", "material": "glass",
                "primitive": { "type": "sphere", "center": [0, 0, 0], "radius": 1 } } ] })";
        return make_world(load_scene_text(json, SceneSource("test", ""), {}, {}), ignore);
    };
    const Vec3 point(0.3, 1.2, 2.5);
    for (const bool fresnel : {true, false}) {
        const auto world = world_with(fresnel ? "true" : "false");
        std::size_t reflected = 0;
        const PointProjection all = project_points(*world, {}, {&point, 1})[0];
        for (const WorldImage& image : all.images) {
            CHECK(image.weight != Vec3(0));
            reflected += image.path == Path::kReflect && image.steps.size() == 1;
        }
        CHECK(reflected == (fresnel ? 1 : 0));
    }
}
