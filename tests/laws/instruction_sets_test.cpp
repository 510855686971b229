// What is measured does not depend on the processor.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "measure/displacement/displacement.h"
#include "measure/synthetic.h"
#include "projector/kernel/kernel.h"
#include "render/picture/picture.h"
#include "specular/specular_search.h"
#include "support/test.h"
#include "surfaces/surfaces.h"
#include "worlds.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("displacement has the same bits with every instruction set", "[laws][displacement][law]") {
    constexpr int kSize = 90;
    const Image reference =
        image_of(kSize, kSize, [](double x, double y) { return mirror_sphere(x, y, kSize); });
    const Image test = image_of(kSize, kSize, [](double x, double y) {
        return mirror_sphere(x + 0.8 * std::sin(0.1 * y), y + 3 * std::cos(0.05 * x), kSize);
    });
    std::optional<Displacement> first;
    const std::vector<std::string> sets = kernel_instruction_sets();
    for (const std::string& set : sets) {
        REQUIRE(use_instruction_set(set));
        const Displacement found = measure_displacement(reference, test, "reflect").value();
        if (!first) first = found;
        INFO(set);
        CHECK(found.pixels > 3000);
        CHECK(found.shift_x == first->shift_x);
        CHECK(found.shift_y == first->shift_y);
        CHECK(found.state == first->state);
        CHECK(found.missing == first->missing);
    }
    CHECK(use_instruction_set(""));
}

TEST_CASE("the search for images has the same answers with every instruction set", "[laws][project][law]") {
    const auto sphere = make_primitive_surface(Primitive{});
    SpecularQuery query;
    query.camera.eye = {0.3, 0.6, 4.4};
    query.camera.screen_x = {1, 0, 0, 0};
    query.camera.screen_y = {0, 1, 0, 0};
    query.camera.screen_w = {0, 0, -1, 4.4};
    std::vector<Vec3> points;
    for (int k = 0; k < 2000; ++k)
        points.push_back(Vec3(3 * std::sin(0.7 * k), 2 * std::cos(1.1 * k), 3 * std::sin(1.9 * k + 1)));
    std::optional<std::vector<SpecularSearch>> first;
    for (const std::string& set : kernel_instruction_sets()) {
        REQUIRE(use_instruction_set(set));
        const std::vector<SpecularSearch> found = SpecularSearcher(*sphere).find_each(query, points);
        if (!first) first = found;
        INFO(set);
        std::size_t images = 0, different = 0;
        for (std::size_t p = 0; p < points.size(); ++p) {
            const SpecularSearch &here = found[p], &there = (*first)[p];
            images += here.images.size();
            different += here.cells != there.cells || here.complete != there.complete ||
                         !std::equal(here.images.begin(), here.images.end(), there.images.begin(),
                                     there.images.end(), [](const SpecularPoint& a, const SpecularPoint& b) {
                                         return a.pixel == b.pixel && a.t == b.t && a.at.uv == b.at.uv;
                                     });
        }
        CHECK(images > points.size());
        CHECK(different == 0);
    }
    CHECK(use_instruction_set(""));
}

TEST_CASE("pictures have the same bits with every instruction set", "[laws][render][law]") {
    for (const char* name : {"sphere", "torus", "water"}) {
        const auto world = shipped_world(name, 4, 90, 60);
        REQUIRE(world);
        std::optional<Image> first;
        for (const std::string& set : kernel_instruction_sets()) {
            REQUIRE(use_instruction_set(set));
            Picture picture = draw_picture(*world, {}, {}, nullptr);
            if (!first) first = picture.image;
            INFO(name << " " << set);
            REQUIRE(picture.image.channels.size() == first->channels.size());
            for (std::size_t c = 0; c < first->channels.size(); ++c)
                CHECK(picture.image.channels[c].values == first->channels[c].values);
        }
        CHECK(use_instruction_set(""));
    }
}
