// What shading by fragments misses of shadows and of the border between lit and unlit: counted on a scene
// made for it, of bars whose shadows are as wide as a pixel, a third and an eighth of it.
#include <cmath>

#include "laws/agreement.h"
#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A floor under a row of bars, `width` of them in world units, in a lamp's light; a pixel is 0.075 wide
/// there.
std::unique_ptr<World> fenced_floor(double width, int samples = 4) {
    std::string bars;
    for (int k = -12; k <= 12; ++k)
        bars += R"(,{"name": "bar)" + std::to_string(k) +
                R"(", "role": "object", "material": "grey", "primitive": {"type": "box", "center": [)" +
                std::to_string(0.27 * k + 0.013) + R"(, 1.2, 0], "size": [)" + std::to_string(width) +
                ", 0.01, 5]}}";
    return world_from("fence",
                      R"({"version": 1, "film": {"width": 64, "height": 48, "spp": )" +
                          std::to_string(samples) +
                          R"(},
        "cameras": [{"name": "main", "yfov": 40, "lookAt": {"eye": [0.2, 1, 4.6], "at": [0, 0, 0], "up": [0, 1, 0]}}],
        "materials": [{"name": "grey", "baseColorFactor": [0.8, 0.8, 0.8]}],
        "lights": [{"type": "directional", "direction": [-0.3, -1, -0.2], "intensity": 3, "shadows": true},
                   {"type": "ambient", "color": [0.1, 0.1, 0.1]}],
        "meshes": [{"name": "floor", "role": "object", "material": "grey",
                    "primitive": {"type": "plane", "size": [9, 9]}},
                   {"name": "ball", "role": "object", "material": "grey",
                    "primitive": {"type": "sphere", "center": [0, 0.4, 1.5], "radius": 0.4}})" +
                          bars + "]}",
                      8);
}

struct Missed {
    double pixels = 0;          // share that is off by more than 0.02
    double mean = 0, bias = 0;  // of all
    double shaded_by_sample = 0;
};

Missed missed(const World& world) {
    PictureRequest by_fragment, by_sample;
    by_sample.layers.shading = Shading::kSample;
    const Picture fast = draw_picture(world, by_fragment, {}, ignore, nullptr),
                  whole = draw_picture(world, by_sample, {}, ignore, nullptr);
    const std::vector<float>&a = fast.image.find("G")->floats(), &b = whole.image.find("G")->floats();
    Missed result;
    const double share = 1.0 / static_cast<double>(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double off = double{a[i]} - double{b[i]};
        result.pixels += share * (std::fabs(off) > 0.02);
        result.mean += share * std::fabs(off);
        result.bias += share * off;
    }
    result.shaded_by_sample = share * static_cast<double>(fast.statistics.pixels_shaded_by_sample);
    return result;
}

}  // namespace

TEST_CASE("shadows and terminators inside pixels: what fragments miss of them", "[laws][law][fragments]") {
    struct Limit {
        double width, pixels, bias;
    };
    for (const Limit& limit : {Limit{0.075, 0.003, 3e-4}, {0.025, 0.05, 5e-3}, {0.009, 0.08, 6e-3}}) {
        const Missed found = missed(*fenced_floor(limit.width));
        INFO("width " << limit.width << ": " << 100 * found.pixels << " % of the pixels, mean " << found.mean
                      << ", bias " << found.bias << ", lit by sample " << 100 * found.shaded_by_sample
                      << " %");
        CHECK(found.pixels < limit.pixels);
        CHECK(std::fabs(found.bias) < limit.bias);
        CHECK(found.shaded_by_sample > 0.02);
    }
}

TEST_CASE("fragments of few samples show what each of their samples does", "[laws][law][fragments]") {
    const Missed found = missed(*fenced_floor(0.025, 2));
    INFO("mean " << found.mean << ", pixels " << found.pixels);
    CHECK(found.pixels == 0);
    CHECK(found.mean < 1e-6);
}
