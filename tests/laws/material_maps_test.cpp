// Filtered normal, roughness, occlusion and emission maps in whole pictures, seen directly and in a mirror,
// against many samples per pixel; second sets of uv against the same picture on the first.
#include <cmath>
#include <string>

#include "laws/agreement.h"
#include "laws/pictures.h"
#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

struct Ground {
    std::string material;  // its fields
    std::string lights;    // entries
    bool with_mirror = false;
    std::string uvs = R"("uvs": [[0, 0], [1, 0], [1, 1], [0, 1]])";
};

std::unique_ptr<World> ground(const Ground& of) {
    const std::string ball = of.with_mirror ? R"(,{"name": "ball", "role": "optic", "material": "ball",
                            "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 1}})"
                                            : "";
    return world_from("mapped ground",
                      R"({"version": 1, "film": {"width": 48, "height": 36},
        "cameras": [{"name": "main", "yfov": 40,
                     "lookAt": {"eye": [0.3, 1.6, 4.5], "at": [0, 0.6, 0], "up": [0, 1, 0]}}],
        "background": {"color": [0.2, 0.2, 0.2]}, "render": {"fresnel": false},
        "materials": [{"name": "ball", "metallicFactor": 1},
                      {"name": "ground", )" +
                          of.material + R"(}],
        "meshes": [{"name": "ground", "role": "object", "material": "ground",
                    "points": [[-40, 0, 40], [40, 0, 40], [40, 0, -40], [-40, 0, -40]], )" +
                          of.uvs + R"(,
                    "faceVertexCounts": [4], "faceVertexIndices": [0, 1, 2, 3]})" +
                          ball + R"(],
        "lights": [)" + of.lights +
                          "]}",
                      32);
}

/// In parts of the truth's mean.
PictureError relative_error(const Image& from, const Image& truth) {
    const PictureError one = picture_error(from, truth);
    return {one.rms / one.mean, one.bias / one.mean, one.mean};
}

const char* const kAbove = R"({"type": "directional", "direction": [-1, -1.5, -1], "intensity": 3})";
const char* const kAhead = R"({"type": "directional", "direction": [0, -1, 2.2], "intensity": 3})";
const char* const kAround = R"({"type": "ambient"})";

struct Case {
    const char* name;
    std::string material, lights;
    double most_one, most_four, most_bias;  // rms of one sample and of 4 x 4
    double of_points = 0.8;                 // what of the error that unfiltered samples have is left at most
};

std::vector<Case> cases() {
    const std::string ripples =
        R"("normalTexture": {"pattern": "ripples", "count": [64, 64], "heights": true, "scale": 5,
            "transform": {"scale": [3, 3]}})";
    const std::string checker =
        R"({"pattern": "checker", "count": [8, 8], "transform": {"scale": [10, 10]}})";
    return {{"matt ripples", ripples, kAbove, 0.06, 0.06, 0.01, 0.5},
            {"rippled metal", R"("metallicFactor": 1, "roughnessFactor": 0.45, )" + ripples, kAhead, 0.45,
             0.225, 0.06},
            {"two metals", R"("metallicFactor": 1, "roughnessFactor": 1, "metallicRoughnessTexture":
                {"pattern": "checker", "count": [8, 8], "colors": [[0, 0.7, 1], [0, 0.4, 1]],
                 "transform": {"scale": [10, 10]}})",
             kAhead, 0.36, 0.19, 0.02},
            {"occlusion", R"("occlusionTexture": )" + checker, kAround, 0.09, 0.07, 0.005, 0.5},
            {"emission",
             R"("baseColorFactor": [0, 0, 0], "emissiveFactor": [1, 1, 1], "emissiveTexture": )" + checker,
             kAround, 0.09, 0.07, 0.005, 0.5}};
}

}  // namespace

TEST_CASE(
    "maps of normals, roughness, occlusion and emission to the horizon: single samples and fragments are "
    "the means over pixels",
    "[laws][law][textures]") {
    for (const bool with_mirror : {false, true})
        for (const Case& one : cases()) {
            const auto world = ground({one.material, one.lights, with_mirror});
            const Image truth = drawn_by(*world, 16, Engine::kLimitTruth);
            const PictureError fragments = relative_error(drawn_by(*world, 4, Engine::kExact), truth),
                               single = relative_error(drawn_by(*world, 1, Engine::kExact), truth),
                               traced = relative_error(drawn_by(*world, 1, Engine::kLimitTruth), truth);
            world->shading.mips.clear();
            const PictureError points = relative_error(drawn_by(*world, 1, Engine::kExact), truth);
            INFO(one.name << (with_mirror ? " with mirror" : "") << ": 4 x 4 rms " << fragments.rms
                          << " bias " << fragments.bias << ", 1 rms " << single.rms << " bias " << single.bias
                          << ", traced rms " << traced.rms << " bias " << traced.bias << ", points rms "
                          << points.rms);
            CHECK(fragments.rms < one.most_four);
            CHECK(std::fabs(fragments.bias) < one.most_bias);
            CHECK(single.rms < one.most_one);
            CHECK(traced.rms < one.most_one);
            CHECK(single.rms < one.of_points * points.rms);
        }
}

TEST_CASE("a texture of the second set of uv is the same picture as one of the first",
          "[laws][law][textures]") {
    const std::string first = R"("uvs": [[0, 0], [1, 0], [1, 1], [0, 1]])",
                      other = R"("uvs": [[0.3, 0.1], [0.5, 0], [0.2, 0.7], [0, 0.4]])",
                      second = R"("uvs1": [[0, 0], [1, 0], [1, 1], [0, 1]])";
    const auto occlusion = [](const char* set) {
        return R"("roughnessFactor": 0.5, "occlusionTexture": {"pattern": "checker", "count": [16, 16])" +
               std::string(set) + R"(}, "normalTexture": {"pattern": "dimples", "count": [32, 32],
               "heights": true, "scale": 3)" +
               set + "}";
    };
    const std::string lights = std::string(kAbove) + ", " + kAround;
    const auto one = ground({occlusion(""), lights, true, first}),
               two = ground({occlusion(R"(, "texCoord": 1)"), lights, true, other + ", " + second}),
               wrong = ground({occlusion(""), lights, true, other + ", " + second});
    for (const int spp : {1, 3}) {
        const Image expected = drawn_by(*one, spp, Engine::kExact);
        CHECK(drawn_by(*two, spp, Engine::kExact).find("G")->floats() == expected.find("G")->floats());
        CHECK(drawn_by(*wrong, spp, Engine::kExact).find("G")->floats() != expected.find("G")->floats());
    }
}
