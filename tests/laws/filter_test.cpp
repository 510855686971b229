// Laws of the filters that make pixels of samples: a constant stays constant, weights are what the papers
// say, a flat mirror is a second camera, a crop is a part of the whole, and projector and truth are filtered
// alike.
#include <cmath>
#include <string>

#include "laws/worlds.h"
#include "render/picture/picture.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::array kFilters{"box", "mitchell", "gaussian"};

std::string film_text(int width, int height, int spp, const std::string& filter) {
    return R"("film": { "width": )" + std::to_string(width) + R"(, "height": )" + std::to_string(height) +
           R"(, "spp": )" + std::to_string(spp) + R"(, "filter": ")" + filter + "\" }";
}

/// Three unlit triangles beside a mirror of colour 1; without the mirror where `mirrored` is false.
std::string film_room(const std::string& film, const std::string& camera, bool mirrored) {
    return R"({ "version": 1, )" + film + R"(, "cameras": [)" + camera + R"(],
      "background": { "color": [0.2, 0.4, 0.7] },
      "materials": [ { "name": "m", "metallicFactor": 1 }, { "name": "a", "baseColorFactor": [0.9, 0.2, 0.1], "unlit": true },
                     { "name": "b", "baseColorFactor": [0.1, 0.8, 0.2], "unlit": true } ],
      "meshes": [ )" +
           (mirrored ? R"({ "name": "mirror", "role": "optic", "material": "m", "resolution": 3,
                   "points": [[-9,-9,0],[9,-9,0],[9,9,0],[-9,9,0]], "subdivisionScheme": "bilinear",
                   "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] },)"
                     : "") +
           R"({ "name": "one", "role": "object", "material": "a", "points": [[-1.1,-0.3,2],[0.7,-0.8,1.5],[0.2,1.2,1.8]],
               "faceVertexCounts": [3], "faceVertexIndices": [0,1,2] },
             { "name": "two", "role": "object", "material": "b", "points": [[-0.4,-0.9,1.1],[1.6,-0.2,1.4],[0.9,0.7,1]],
               "faceVertexCounts": [3], "faceVertexIndices": [0,1,2] } ],
      "render": { "fresnel": false } })";
}

const std::string kEye = R"({ "yfov": 50, "lookAt": { "eye": [0.4, 0.3, 5], "at": [0.1, 0, 0] } })";

Image picture(const std::string& json, Engine engine = Engine::kExact, const LayerRequest& layers = {}) {
    const auto world = world_from("filter", json, 3);
    PictureRequest request;
    request.engine = engine;
    request.layers = layers;
    return draw_picture(*world, request, {}, [](const std::string&) {}).image;
}

double value(const Image& image, const char* channel, int x, int y) {
    return static_cast<double>(
        image.find(channel)->floats()[static_cast<std::size_t>(y * image.data_width + x)]);
}

/// The filters by their definitions, written anew: Mitchell and Netravali's formula with its B and C, and a
/// normal density less its value at its end.
double weight(const std::string& filter, double x) {
    x = std::fabs(x);
    if (filter == "box") return x < 0.5 ? 1 : 0;
    if (filter == "gaussian") return x < 1.5 ? std::exp(-2 * x * x) - std::exp(-4.5) : 0;
    const double b = 1.0 / 3, c = 1.0 / 3;
    if (x < 1)
        return ((12 - 9 * b - 6 * c) * std::pow(x, 3) + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
    if (x < 2)
        return ((-b - 6 * c) * std::pow(x, 3) + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x +
                (8 * b + 24 * c)) /
               6;
    return 0;
}

}  // namespace

TEST_CASE("a constant picture stays constant through every filter", "[laws][law]") {
    for (const std::string filter : kFilters)
        for (const int spp : {1, 2, 3}) {
            INFO(filter << " " << spp);
            const Image image =
                picture(R"({ "version": 1, )" + film_text(17, 11, spp, filter) + R"(, "cameras": [)" + kEye +
                        R"(], "background": { "color": [0.3, 0.6, 2.5] } })");
            for (int y = 0; y < 11; ++y)
                for (int x = 0; x < 17; ++x) {
                    CHECK(value(image, "R", x, y) == Approx(0.3).epsilon(1e-6));
                    CHECK(value(image, "G", x, y) == Approx(0.6).epsilon(1e-6));
                    CHECK(value(image, "B", x, y) == Approx(2.5).epsilon(1e-6));
                }
        }
}

TEST_CASE("a filtered picture is the weighted mean of a picture with a pixel for every sample",
          "[laws][law]") {
    constexpr int kWidth = 40, kHeight = 30, kSide = 3;
    const Image fine = picture(film_room(film_text(kWidth * kSide, kHeight * kSide, 1, "box"), kEye, true));
    for (const std::string filter : kFilters) {
        INFO(filter);
        const Image image = picture(film_room(film_text(kWidth, kHeight, kSide, filter), kEye, true));
        double worst = 0, least = 1, most = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                for (const char* channel : {"R", "G", "B", "reflect.G"}) {
                    double sum = 0, total = 0;
                    for (int v = 0; v < kHeight * kSide; ++v)
                        for (int u = 0; u < kWidth * kSide; ++u) {
                            if (std::abs(u - kSide * x) > 3 * kSide || std::abs(v - kSide * y) > 3 * kSide)
                                continue;
                            const double w = weight(filter, (u + 0.5) / kSide - x - 0.5) *
                                             weight(filter, (v + 0.5) / kSide - y - 0.5);
                            sum += w * value(fine, channel, u, v);
                            total += w;
                        }
                    worst = std::max(worst, std::fabs(sum / total - value(image, channel, x, y)));
                    least = std::min(least, value(image, channel, x, y));
                    most = std::max(most, value(image, channel, x, y));
                }
        CHECK(worst < 1e-6);
        CHECK(most - least > 0.5);
    }
}

TEST_CASE("filtered, a flat mirror shows what a second camera behind it sees", "[laws][law]") {
    constexpr int kWidth = 80, kHeight = 60;
    const std::string behind = R"({ "yfov": 50, "lookAt": { "eye": [0.4, 0.3, -5], "at": [0.1, 0, 0] } })";
    for (const std::string filter : kFilters) {
        INFO(filter);
        const std::string film = film_text(kWidth, kHeight, 2, filter);
        const Image mirrored = picture(film_room(film, kEye, true)),
                    direct = picture(film_room(film, behind, false));
        int differing = 0, covered = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                // What hides the mirror itself has no place in the second camera's picture.
                if (value(mirrored, "direct.R", x, y) != 0 || value(mirrored, "direct.G", x, y) != 0)
                    continue;
                ++covered;
                for (const char* channel : {"R", "G", "B"})
                    differing += !(std::fabs(value(mirrored, channel, x, y) -
                                             value(direct, channel, kWidth - 1 - x, y)) < 1e-6);
            }
        CHECK(covered > kWidth * kHeight / 2);
        CHECK(differing == 0);
    }
}

TEST_CASE("a filtered crop is a part of the filtered whole, and the truth is filtered alike", "[laws][law]") {
    for (const std::string filter : kFilters)
        for (const int spp : {1, 2}) {
            INFO(filter << " " << spp);
            const std::string json = film_room(film_text(50, 40, spp, filter), kEye, true);
            const Image whole = picture(json), crop = picture(json, Engine::kExact, {13, 7, 31, 40, {}}),
                        traced = picture(json, Engine::kFacetsTruth);
            std::size_t differing = 0;
            for (int y = 0; y < crop.data_height; ++y)
                for (int x = 0; x < crop.data_width; ++x)
                    for (const char* channel : {"R", "B", "A", "reflect.R"})
                        CHECK(value(crop, channel, x, y) == value(whole, channel, x + 13, y + 7));
            for (int y = 0; y < 40; ++y)
                for (int x = 0; x < 50; ++x)
                    differing += !(std::fabs(value(traced, "G", x, y) - value(whole, "G", x, y)) < 1e-6);
            CHECK(differing == 0);
        }
}
