// On smooth parts displacement falls with the square of a facet's size: pixels that are projected at every
// resolution, away from the folds of the truth, through every path that ships.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "laws/worlds.h"
#include "measure/displacement/displacement.h"
#include "measure/field/position_field.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr int kOrderWidth = 320, kOrderHeight = 240;
constexpr std::size_t kLevels = 3;  // n, 2 n, 4 n

Image draw_layer(const World& world, Engine engine) {
    PictureRequest request;
    request.engine = engine;
    request.layers.layers = {"optic", "reflect", "refract", "stat"};
    return draw_picture(world, request, {}, ignore).image;
}

struct Smooth {
    std::size_t seen = 0, measured = 0;  // pixels found at all levels; those on smooth parts
    std::array<double, kLevels> mean{};  // displacement there, pixels
};

/// Nothing measured where the layer is in no picture.
Smooth measure_smooth(const Image& truth, const std::array<Image, kLevels>& images,
                      const std::string& layer) {
    Smooth smooth;
    auto field = make_seen_field(truth, layer);
    if (!field) return smooth;
    link_neighbours(*field);
    const std::vector<std::uint8_t> fold = near_folds(*field);
    std::array<Displacement, kLevels> found;
    for (std::size_t i = 0; i < kLevels; ++i) {
        auto one = measure_displacement(truth, images[i], layer);
        if (!one || !one->summary) return smooth;
        found[i] = std::move(*one);
    }
    for (std::size_t p = 0; p < fold.size(); ++p) {
        const auto all = [&](const auto& holds) {
            for (std::size_t i = 0; i < kLevels; ++i)
                if (!holds(i)) return false;
            return true;
        };
        if (!all([&](std::size_t i) { return found[i].state[p] == Shift::kFound; })) continue;
        ++smooth.seen;
        if (fold[p] || !all([&](std::size_t i) { return images[i].find("stat.method")->ids()[p] == 0; }))
            continue;
        ++smooth.measured;
        for (std::size_t i = 0; i < kLevels; ++i)
            smooth.mean[i] += std::hypot(found[i].shift_x[p], found[i].shift_y[p]);
    }
    for (double& mean : smooth.mean) mean /= static_cast<double>(std::max<std::size_t>(smooth.measured, 1));
    return smooth;
}

struct OrderCase {
    const char* scene;
    int n = 8;
};

void check_orders(const std::vector<OrderCase>& cases) {
    for (const OrderCase& one : cases) {
        std::string missing;
        std::array<Image, kLevels> images;
        Image truth;
        for (std::size_t i = 0; i < kLevels; ++i) {
            const auto world = shipped_world(one.scene, one.n << i, kOrderWidth, kOrderHeight, &missing);
            if (!world) break;
            images[i] = draw_layer(*world, Engine::kExact);
            if (i == 0) truth = draw_layer(*world, Engine::kLimitTruth);
        }
        if (!missing.empty()) {
            WARN(one.scene << " is left out: " << missing);
            continue;
        }
        int layers = 0;
        for (const std::string layer : {"reflect", "refract"}) {
            const Smooth smooth = measure_smooth(truth, images, layer);
            if (smooth.measured < 500) continue;
            ++layers;
            for (std::size_t i = 0; i + 1 < kLevels; ++i) {
                const double order = std::log2(smooth.mean[i] / smooth.mean[i + 1]);
                INFO(one.scene << " " << layer << " from n = " << (one.n << i) << ": order " << order
                               << ", means " << smooth.mean[i] << ", " << smooth.mean[i + 1] << " px over "
                               << smooth.measured << " of " << smooth.seen << " pixels");
                CHECK(order >= 1.9);
            }
        }
        INFO(one.scene);
        CHECK(layers > 0);
    }
}

}  // namespace

TEST_CASE("on smooth parts displacement falls with order 1.9 or more, whatever the path", "[laws][law][thorough]") {
    check_orders({{"sphere"},
                  {"torus"},
                  {"paths/crystal-ball"},
                  {"paths/glass-before-mirror"}});
}

TEST_CASE("the same in rings and balls, through lenses, a wine glass, water and in a bowl", "[.long][laws][law]") {
    // The wine glass and the water have so many faces that fewer facets on each are as small.
    check_orders({{"paths/glass-torus"},
                  {"paths/mirror-balls"},
                  {"paths/mirror-torus"},
                  {"paths/plano-convex"},
                  {"paths/meniscus"},
                  {"paths/wine-glass", 4},
                  {"paths/under-water", 4},
                  {"paths/bowl"}});
}
