#include "fit_scenes.h"

#include <random>

using namespace trilens;

namespace trilens_test {
namespace {

std::string scene_with(const std::string& mesh) {
    return R"({"version": 1, "film": {"width": 1024, "height": 768},
 "cameras": [{"name": "main", "type": "perspective", "yfov": 40,
              "lookAt": {"eye": [0.2, 0.3, 4.5], "at": [0, 0, 0]}}],
 "materials": [{"name": "chrome", "metallicFactor": 1, "roughnessFactor": 0},
               {"name": "glass", "transmissionFactor": 1, "roughnessFactor": 0, "ior": 1.5}],
 "meshes": [)" +
           mesh + "]}";
}

}  // namespace

std::string ball_scene() {
    return scene_with(R"({"name": "ball", "role": "optic", "material": "chrome",
        "primitive": {"type": "sphere", "center": [0.05, -0.03, 0.02], "radius": 1}})");
}

std::string glass_scene() {
    return scene_with(R"({"name": "ball", "role": "optic", "material": "glass",
        "primitive": {"type": "sphere", "center": [0.05, -0.03, 0.02], "radius": 1}})");
}

std::string saddle_scene() {
    std::string points, faces, counts;
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) {
            const double x = (column - 1.5) * 0.7, y = (row - 1.5) * 0.7;
            points += (points.empty() ? "[" : ",[") + std::to_string(x) + "," + std::to_string(y) + "," +
                      std::to_string(0.25 * (x * x - 0.6 * y * y + 0.3 * x * y)) + "]";
        }
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) {
            const int a = 4 * row + column;
            for (const int corner : {a, a + 1, a + 5, a + 4})
                faces += (faces.empty() ? "" : ",") + std::to_string(corner);
            counts += counts.empty() ? "4" : ",4";
        }
    return scene_with(R"({"name": "saddle", "role": "optic", "material": "chrome",
        "transform": {"translate": [0.05, -0.03, 0.02], "rotate": [0.05, -0.1, 0.02, 1]}, "points": [)" +
                      points + "], \"faceVertexCounts\": [" + counts + "], \"faceVertexIndices\": [" + faces +
                      "]}");
}

std::vector<Correspondence> make_pairs(const Scene& scene, std::size_t count, const std::string& word,
                                       unsigned seed) {
    const Renderer renderer(scene);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> share(-1, 1);
    std::vector<Correspondence> pairs;
    while (pairs.size() < count) {
        std::vector<Vec3> points;
        for (std::size_t k = 0; k < count; ++k) {
            // Mirrors see what lies before them, glass what lies behind it.
            const double depth = word == "TT" ? -4 + share(random) : 3 + 1.5 * share(random);
            points.emplace_back(3 * share(random), 2 * share(random), depth);
        }
        const std::vector<PointProjection> found = renderer.project(points);
        for (std::size_t k = 0; k < count; ++k)
            for (const WorldImage& image : found[k].images) {
                std::string is;
                for (const Step& step : image.steps) is += step.event == Event::kReflect ? 'R' : 'T';
                if (is != word || !image.inside || !image.refined || pairs.size() == count) continue;
                Correspondence pair;
                pair.pixel = image.pixel;
                pair.point = points[k];
                pairs.push_back(pair);
            }
    }
    return pairs;
}

std::vector<Correspondence> with_noise(std::vector<Correspondence> pairs, double sigma, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, sigma);
    for (Correspondence& pair : pairs) pair.pixel += Vec2(normal(random), normal(random));
    return pairs;
}

}  // namespace trilens_test
