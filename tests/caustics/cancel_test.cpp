// The making of beams and the gathering of their light: told how far they are, stopped, and begun again.
#include <atomic>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <mutex>
#include <string>
#include <vector>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "support/lit_world.h"
#include "support/test.h"
#include "trilens/render.h"

using namespace trilens;
using namespace trilens_test;
namespace fs = std::filesystem;

namespace {

const std::string kBall = R"({"name": "ball", "role": "optic", "material": "mirror", "resolution": 8,
    "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})";
/// A flat lamp, of two samples.
const std::string kPanel =
    R"({"type": "rectangle", "position": [0, 4, 3], "direction": [0, -0.8, -0.6], "size": [0.5, 0.5],
    "intensity": 10, "samples": 2, "caustics": true})";

/// What a job was told, and when it was to stop.
struct Told {
    std::vector<double> shares;
    std::vector<std::string> stages;
    std::atomic<bool> cancel = false;
    double stop_at = 2;  // of its share

    Progress progress() {
        return {[this](double done) {
                    shares.push_back(done);
                    cancel = cancel || done >= stop_at;
                },
                &cancel, [this](const std::string& what, double) { stages.push_back(what); }};
    }
};

std::vector<Vec3> light_on_floor(const CausticLights& lights) {
    std::vector<Vec3> light;
    for (double z = -5; z < 1; z += 0.5) {
        Receiver there = on_floor(0.1, z);
        there.sides = {Vec3(0.05, 0, 0), Vec3(0, 0, 0.05)};
        there.triangle = 0;
        light.push_back(irradiance(lights.by_light[0], there));
    }
    return light;
}

}  // namespace

TEST_CASE("beams are made and gathered with a progress that grows and tells of a light's samples",
          "[caustics][progress]") {
    const auto world = lit_world(kBall, kPanel);
    Told making, gathering;
    const CausticLights& lights = caustic_lights(*world, false, making.progress());
    const ReceiverSide floor = lights.faces->side_of(0, Vec3(0, 1, 0));
    gather_light(lights.all(), {&floor, 1}, gathering.progress());
    CHECK(making.stages == std::vector<std::string>{"beams of light 0, 2 samples"});
    CHECK(gathering.stages == std::vector<std::string>{"light on 1 face of 2 samples"});
    for (const Told* told : {&making, &gathering}) {
        CHECK(told->shares.size() > 100);
        CHECK(std::is_sorted(told->shares.begin(), told->shares.end()));
        CHECK(told->shares.back() == Approx(1));
        // No step is long.
        for (std::size_t i = 1; i < told->shares.size(); ++i)
            CHECK(told->shares[i] - told->shares[i - 1] < 0.2);
    }
    for (const BeamLight* light : lights.all()) CHECK(light->is_gathered(floor));
}

TEST_CASE("beams that are stopped in their midst are as if they had never been begun",
          "[caustics][progress]") {
    const auto world = lit_world(kBall, kPanel), other = lit_world(kBall, kPanel);
    const std::vector<Vec3> expected = light_on_floor(caustic_lights(*other, false));
    for (const double share : {0.0, 0.1, 0.6}) {
        Told told;
        told.stop_at = share;
        CHECK_THROWS_AS(caustic_lights(*world, false, told.progress()), Interrupted);
        CHECK(told.shares.back() < share + 0.1);
        CHECK(known_caustic_lights(*world, false) == nullptr);
    }
    const CausticLights& lights = caustic_lights(*world, false);
    const ReceiverSide floor = lights.faces->side_of(0, Vec3(0, 1, 0));
    for (const double share : {0.0, 0.6}) {
        Told told;
        told.stop_at = share;
        CHECK_THROWS_AS(gather_light(lights.all(), {&floor, 1}, told.progress()), Interrupted);
        CHECK_FALSE(lights.all().back()->is_gathered(floor));
    }
    // A receiver whose picture nobody wants any more.
    Receiver there = on_floor(0, -2);
    there.triangle = 0;
    const std::atomic<bool> cancel = true;
    there.cancel = &cancel;
    CHECK_THROWS_AS(irradiance(lights.by_light[0], there), Interrupted);
    there.exact = true;
    CHECK_THROWS_AS(irradiance(lights.by_light[0], there), Interrupted);
    CHECK_FALSE(lights.all().back()->is_gathered(floor));
    CHECK(light_on_floor(lights) == expected);
}

TEST_CASE("hardly a ray is traced after beams were stopped", "[caustics][progress]") {
    const auto world = lit_world(kBall, kLamp);
    const PathWorld optics = optics_for_lights(*world);
    LightSpace space;
    space.optics = &optics;
    space.objects = &object_tracer(*world);
    space.size = space.reach = 12;
    std::vector<Vec3> outline;
    for (const double sign : {-1.0, 1.0})
        for (int k = 0; k < 3; ++k) {
            outline.push_back(Vec3(0, 1, 0));
            outline.back()[k] += sign * 0.8;
        }
    for (const double share : {0.02, 0.15, 0.5, 0.9}) {
        Told told;
        told.stop_at = share;
        std::atomic<std::size_t> after = 0;
        BeamSource source = beam_sources(world->scene.lights[0], world->scene.background, 1).front();
        source.strength = [&, usual = source.strength](const Vec3& direction) {
            if (told.cancel) ++after;
            return usual(direction);
        };
        CHECK_THROWS_AS(BeamLight(space, source, {}, {outline}, told.progress()), Interrupted);
        CHECK(after <= 2 * static_cast<std::size_t>(thread_count()));
    }
}

TEST_CASE("a picture that is stopped while its light is followed leaves no file", "[caustics][progress]") {
    const std::string folder = scratch_dir("caustics_cancelled"), file = folder + "/picture.exr";
    const auto files = [&] {
        return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
    };
    const Renderer renderer(lit_world(kBall, kPanel)->scene);
    {
        Told told;
        renderer.write_exr(file, {}, told.progress());
        CHECK(told.stages == std::vector<std::string>{"beams of light 0, 2 samples", "",
                                                      "light on 1 face of 2 samples", ""});
        CHECK(std::is_sorted(told.shares.begin(), told.shares.end()));
        CHECK(told.shares.back() == 1);
        fs::remove(file);
    }
    // In beams, on the face, and in pixels.
    for (const double share : {0.02, 0.3, 0.8}) {
        const Renderer fresh(renderer.scene());
        Told told;
        told.stop_at = share;
        CHECK_THROWS_AS(fresh.write_exr(file, {}, told.progress()), Interrupted);
        CHECK(files() == 0);
    }
}
