// The library asked from eight threads at random: what all threads get is what one gets, whoever asks for
// what meanwhile.
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "support/test.h"
#include "trilens/trilens.h"

using namespace trilens;

namespace {

constexpr int kThreads = 8, kRounds = 5;

constexpr const char* kRoom = R"({ "version": 1, "film": { "width": 24, "height": 18, "spp": 2 },
  "cameras": [ { "name": "c", "yfov": 45, "lookAt": { "eye": [0.3, 0.8, 4], "at": [0, 0, 0] } } ],
  "background": { "color": [0.2, 0.3, 0.5] }, "render": { "maxDepth": 2 },
  "lights": [ { "type": "point", "position": [1, 3, 2], "intensity": 9, "shadows": true } ],
  "materials": [ { "name": "chrome", "metallicFactor": 1 }, { "name": "glass", "transmissionFactor": 1, "ior": 1.5 },
    { "name": "tiles", "baseColorTexture": { "pattern": "checker", "colors": [[0.1, 0.2, 0.9], [0.9, 0.8, 0.1]], "count": [8, 8] } } ],
  "meshes": [ { "name": "ball", "role": "optic", "material": "glass", "primitive": { "type": "sphere", "center": [1, 0, 0], "radius": 0.6 } },
    { "name": "cage", "role": "optic", "material": "chrome", "resolution": 4,
      "points": [[-1.6,-0.6,0.5],[-0.4,-0.6,0.5],[-0.4,0.6,0.5],[-1.6,0.6,0.5],[-1.6,-0.6,-0.5],[-0.4,-0.6,-0.5],[-0.4,0.6,-0.5],[-1.6,0.6,-0.5]],
      "faceVertexCounts": [4,4,4,4,4,4], "faceVertexIndices": [0,1,2,3, 1,5,6,2, 5,4,7,6, 4,0,3,7, 3,2,6,7, 4,5,1,0] },
    { "name": "floor", "role": "object", "material": "tiles", "points": [[-5,-1,-5],[5,-1,-5],[5,-1,5],[-5,-1,5]],
      "faceVertexCounts": [4], "faceVertexIndices": [3,2,1,0], "uvs": [[0,0],[4,0],[4,4],[0,4]], "uvIndices": [3,2,1,0] } ] })";

struct Question {
    std::string name;
    std::function<std::string()> ask;  // its answer, as bytes
};

std::string text_of(const std::vector<unsigned char>& bytes) {
    return {bytes.begin(), bytes.end()};
}

template <class Images>
std::string places_of(const Images& images) {
    std::string text;
    for (const WorldImage& image : images)
        text += std::to_string(image.pixel.x) + " " + std::to_string(image.pixel.y) + ";";
    return text;
}

/// All of them about one renderer, but for what loads a scene of its own.
std::vector<Question> questions(const Renderer& renderer, const Image& a, const Image& b,
                                const std::string& folder) {
    const std::vector<Vec3> points{{0.5, -0.9, 0.5}, {-1, -0.95, 1}, {0.1, 0.7, 2}};
    const std::string file = folder + "/a.exr", scene = folder + "/room.json";
    PictureRequest truth, bounded;
    truth.engine = Engine::kLimitTruth;
    bounded.frame.max_error = 0.5;
    replace_text_file(scene, kRoom);
    write_image(file, a);
    return {
        {"draw", [&renderer] { return text_of(encode_image(renderer.draw({}).image)); }},
        {"draw_exr", [&renderer] { return text_of(renderer.draw_exr({}).bytes); }},
        {"draw_png", [&renderer] { return text_of(renderer.draw_png({}).bytes); }},
        {"truth", [&renderer, truth] { return text_of(encode_image(renderer.draw(truth).image)); }},
        {"max_error", [&renderer, bounded] { return text_of(encode_image(renderer.draw(bounded).image)); }},
        {"project",
         [&renderer, points] {
             std::string text;
             for (const PointProjection& one : renderer.project(points)) text += places_of(one.images);
             return text;
         }},
        {"project facets",
         [&renderer, points] {
             ProjectRequest request;
             request.search = ImageSearch::kFacets;
             std::string text;
             for (const PointProjection& one : renderer.project(points, request))
                 text += places_of(one.images);
             return text;
         }},
        {"shoot",
         [&renderer] {
             std::string text;
             for (const ShotRay& ray : renderer.shoot(std::vector<Vec2>{{3.5, 4.5}, {12, 9}, {20, 15}}).rays)
                 text += std::to_string(ray.position.x) + " ";
             return text;
         }},
        {"explain", [&renderer] { return std::to_string(renderer.explain({}, 8, 9).depth); }},
        {"lines", [&renderer] { return renderer.draw_lines({}).svg; }},
        {"compare",
         [a, b] {
             const auto layers = compare_layers(b, a);
             return std::to_string(compare(b, a).metrics.rmse) + " " +
                    std::to_string(total_seen(layers).primitive_mismatch);
         }},
        {"read", [file] { return text_of(encode_image(read_image(file))); }},
        {"load",
         [scene] {
             SceneRequest request;
             request.file = scene;
             const Renderer own(load_scene(request));
             return text_of(encode_image(own.draw({}).image));
         }},
        {"threads",
         [] {
             set_threads(2);
             set_threads(0);
             return std::string();
         }},
        {"refusal",
         [&renderer] {
             FrameParams frame;
             frame.camera = 7;
             try {
                 renderer.check(frame);
             } catch (const UsageError& error) {
                 return std::string(error.what());
             }
             return std::string("none");
         }},
    };
}

}  // namespace

TEST_CASE("eight threads that ask at random get the answers of one", "[trilens][threads][law]") {
    const Renderer renderer(parse_scene(kRoom));
    const std::string folder = trilens_test::scratch_dir("eight_threads");
    PictureRequest truth;
    truth.engine = Engine::kLimitTruth;
    const Image a = renderer.draw({}).image, b = renderer.draw(truth).image;
    const std::vector<Question> all = questions(renderer, a, b, folder);
    std::vector<std::string> expected;
    for (const Question& one : all) expected.push_back(one.ask());
    REQUIRE(expected.back() != "none");

    // A renderer that nobody has asked yet: threads find what it makes at its first use half made, or not at
    // all.
    const Renderer fresh(parse_scene(kRoom));
    const std::vector<Question> asked = questions(fresh, a, b, folder);
    std::vector<std::string> wrong(kThreads);
    std::vector<std::thread> team;
    for (int k = 0; k < kThreads; ++k)
        team.emplace_back([&, k] {
            std::mt19937 draws(static_cast<unsigned>(k));
            for (int round = 0; round < kRounds; ++round) {
                const std::size_t which = draws() % asked.size();
                try {
                    if (asked[which].ask() != expected[which])
                        wrong[static_cast<std::size_t>(k)] += asked[which].name + " ";
                } catch (const std::exception& error) {
                    wrong[static_cast<std::size_t>(k)] += asked[which].name + ": " + error.what() + " ";
                }
            }
        });
    for (std::thread& one : team) one.join();
    for (const std::string& one : wrong) CHECK(one == "");
}
