// Scenes of the outside data in which attackers found pictures, images or sums that were not the truth's.
#include <algorithm>
#include <string>
#include <vector>

#include "laws/hunt.h"
#include "laws/worlds.h"
#include "render/picture/explain.h"
#include "render/picture/picture.h"
#include "render/project/project.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string file_of(const std::string& name) {
    return "scenes/" + name + ".json";
}

Picture drawn(const World& world, Engine engine, int n, std::vector<std::string> layers = {}) {
    PictureRequest request;
    request.frame.resolution = n;
    request.engine = engine;
    request.layers.layers = std::move(layers);
    return draw_picture(world, request, {}, ignore);
}

struct ShownImages {
    std::size_t paths = 0, found = 0, hidden = 0;  // of the traced pixels' paths; images there; not `visible`
};

/// Projects what the traced pixels of a lattice show, and looks for the images in those pixels.
ShownImages images_of_pixels(const World& world, int step) {
    ShownImages shown;
    PictureRequest truth;
    truth.engine = Engine::kLimitTruth;
    for (int y = step / 2; y < world.scene.film.height; y += step)
        for (int x = step / 2; x < world.scene.film.width; x += step) {
            const PixelExplanation pixel = explain_pixel(world, truth, x, y);
            for (const PixelEnd& end : pixel.ends) {
                if (!end.hit.seen() || !end.principal) continue;
                const Vec3 point = end.ray.origin + end.hit.t * end.ray.direction;
                const std::vector<Step>& steps = end.steps;
                ++shown.paths;
                const PointProjection all = project_points(world, {}, {&point, 1})[0];
                for (const WorldImage& image : all.images) {
                    CHECK(image.weight != Vec3(0));
                    if (!std::equal(steps.begin(), steps.end(), image.steps.begin(), image.steps.end()))
                        continue;
                    if (length(image.pixel - Vec2(x + 0.5, y + 0.5)) > 1e-3) continue;
                    ++shown.found;
                    shown.hidden += !image.visible;
                    break;
                }
            }
        }
    return shown;
}

}  // namespace

TEST_CASE("Scenes that an attack found have the truth's paths", "[laws][law][data][oracle][thorough]") {
    struct Attack {
        const char* name;
        int n;
        double max_error;
        std::size_t most_other;
    };
    for (const Attack& one :
         {Attack{"ball-behind-glass", 8, 0, 60}, Attack{"ball-behind-glass", 8, 0.5, 4},
          Attack{"ball-in-flat-mirror", 8, 0.5, 4}, Attack{"ball-in-flat-mirror", 8, 0.1, 4},
          Attack{"outline", 2, 0.5, 4}, Attack{"law-01-depth0-inside-glass-total-reflection", 8, 0, 4},
          Attack{"law-02-depth0-inside-mirror-crossed-slits", 8, 0, 4},
          Attack{"law-03-depth0-inside-sphere-black-ring", 8, 0, 40},
          Attack{"law-04-depth0-noise-mirrors", 8, 0, 4},
          Attack{"law-06-max-error-noise-inside-glass", 8, 0.5, 40}}) {
        TRILENS_NEEDS_DATA(file_of(one.name));
        FrameParams frame;
        frame.resolution = one.n;
        if (one.max_error > 0) frame.max_error = one.max_error;
        const Bag bag = beside_truth(*data_world(one.name), frame);
        INFO(one.name << ", n " << one.n << ", error " << one.max_error);
        CHECK(bag.missing.empty());
        CHECK(bag.other <= one.most_other);
    }
}

TEST_CASE("Ids without weight and reflections without light are not drawn: as the truth has them",
          "[laws][law][data]") {
    for (const std::string name :
         {"law-05-depth0-weightless-reflect-ids", "law-07-nofresnel-grazing-pure-reflection"}) {
        TRILENS_NEEDS_DATA(file_of(name));
        const auto world = data_world(name);
        const Picture ours = drawn(*world, Engine::kExact, 8), truth = drawn(*world, Engine::kLimitTruth, 8);
        const auto& seen = ours.image.find("reflectID.object")->ids();
        const auto& traced = truth.image.find("reflectID.object")->ids();
        std::size_t only_ours = 0;
        for (std::size_t i = 0; i < seen.size(); ++i) only_ours += seen[i] != kNone && traced[i] == kNone;
        INFO(name);
        CHECK(only_ours <= seen.size() / 500);
    }
}

TEST_CASE("What an attack's white rooms lose is what the pictures say", "[laws][law][data]") {
    for (const std::string name : {"law-11-cut-over-100-percent-dispersion", "law-12-energy-below-stated-cut",
                                   "law-14-energy-above-1"})
        for (const int n : {1, 8}) {
            TRILENS_NEEDS_DATA(file_of(name));
            const Picture picture = drawn(*data_world(name), Engine::kExact, n);
            double least = 1, most = 0;
            for (const char* channel : {"R", "G", "B"})
                for (const float value : picture.image.find(channel)->floats()) {
                    least = std::min(least, static_cast<double>(value));
                    most = std::max(most, static_cast<double>(value));
                }
            INFO(name << ", n " << n);
            CHECK(picture.statistics.deep_light <= 1 + 1e-6);
            // Glass that absorbs may be darker than white: there only the upper bound is a law.
            CHECK(most <= 1 + 1e-6);
            if (name == "law-12-energy-below-stated-cut")
                CHECK(least >= 1 - picture.statistics.faint_light - 1e-6);
        }
}

TEST_CASE("Paths at a seam of mirrors meet as many optics as the truth's", "[laws][law][data][oracle]") {
    const std::string name = "law-13-overlapping-mirrors-33-hits";
    TRILENS_NEEDS_DATA(file_of(name));
    const auto world = data_world(name);
    const auto most = [&](Engine engine, int n) {
        const Picture picture = drawn(*world, engine, n, {"path"});
        const auto& count = picture.image.find("path.count")->ids();
        return *std::max_element(count.begin(), count.end());
    };
    const Id truth = most(Engine::kLimitTruth, 8);
    for (const int n : {1, 2, 4, 8}) CHECK(most(Engine::kExact, n) <= truth);
}

TEST_CASE("What the truth shows in a pixel is a visible image there", "[laws][law][data][oracle][thorough]") {
    struct Attack {
        const char* name;
        int step;
        double least_found;
    };
    for (const Attack& one : {Attack{"law-08-project-lists-reflection-without-fresnel", 24, 0.9},
                              Attack{"law-09-project-visible-false-pushbroom", 15, 0.6},
                              Attack{"law-10-project-visible-false-inward-sphere", 36, 0.6},
                              Attack{"law-15-project-unrefined-1px-off", 24, 0.9}}) {
        TRILENS_NEEDS_DATA(file_of(one.name));
        const ShownImages shown = images_of_pixels(*data_world(one.name), one.step);
        INFO(one.name << ": " << shown.paths << " paths, " << shown.found << " found, " << shown.hidden
                      << " hidden");
        CHECK(shown.paths > 0);
        CHECK(shown.hidden == 0);
        CHECK(static_cast<double>(shown.found) >= one.least_found * static_cast<double>(shown.paths));
    }
}
