// Law: a scene with any part deleted or replaced either loads or fails with a message that names its file.
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <random>

#include "scene/examples/examples.h"
#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

using Json = nlohmann::ordered_json;

Json random_value(std::mt19937& random, int depth) {
    static const std::vector<double> numbers = {0,
                                                1,
                                                -1,
                                                2,
                                                0.5,
                                                3,
                                                255,
                                                256,
                                                1e-320,
                                                -1e-30,
                                                1e30,
                                                1e31,
                                                1.7e308,
                                                4294967295.0,
                                                4294967296.0,
                                                -2147483649.0};
    static const std::vector<std::string> strings = {
        "",       "main",   "red",   "glass",  "chrome",   "inherit",      "optic",
        "object", "sphere", "plane", "noise",  "loop",     "catmullClark", "none.obj",
        ".",      "/",      "..",    "a.gltf", "\xc3\xa9", "/dev/null"};
    switch (random() % (depth > 2 ? 6 : 9)) {
        case 0:
            return nullptr;
        case 1:
            return random() % 2 == 0;
        case 2:
            return static_cast<int>(random() % 12) - 2;
        case 3:
            return numbers[random() % numbers.size()];
        case 4:
            return strings[random() % strings.size()];
        case 5:
            return static_cast<std::int64_t>(random()) * static_cast<std::int64_t>(random() % 100) - 7;
        case 6: {
            Json array = Json::array();
            for (unsigned i = random() % 6; i > 0; --i) array.push_back(random_value(random, depth + 1));
            return array;
        }
        case 7:
            return Json::array({static_cast<int>(random() % 5), 0.5, -1});
        default: {
            static const std::vector<std::string> keys = {"type",   "name",   "file",   "x-any",
                                                          "extras", "radius", "matrix", "points"};
            Json object = Json::object();
            for (unsigned i = random() % 4; i > 0; --i)
                object[keys[random() % keys.size()]] = random_value(random, depth + 1);
            return object;
        }
    }
}

/// Walks down at random, then replaces, deletes, doubles or renames what it finds.
void break_something(Json& value, std::mt19937& random) {
    Json* at = &value;
    while (at->is_structured() && !at->empty()) {
        auto part = at->begin();
        std::advance(part, random() % at->size());
        const bool go_on = part->is_structured() && !part->empty() && random() % 4 != 0;
        if (go_on) {
            at = &*part;
            continue;
        }
        switch (random() % 4) {
            case 0:
                at->erase(part);
                return;
            case 1:
                if (at->is_array()) {
                    at->push_back(Json(*part));
                } else {
                    const Json copy = *part;
                    (*at)[part.key() + "s"] = copy;
                }
                return;
            default:
                *part = random_value(random, 0);
                return;
        }
    }
}

}  // namespace

TEST_CASE("law: a broken scene loads or says what is wrong in which file", "[scene][bad-input][law]") {
    std::vector<Json> scenes = {Json::parse(kRoom)};
    for (const SceneExample& example : scene_examples())
        scenes.push_back(Json::parse(example.json, nullptr, true, true));
    std::mt19937 random(20);
    int loaded = 0, refused = 0;
    for (int i = 0; i < 3000; ++i) {
        Json scene = scenes[i % 2 == 0 ? 0 : random() % scenes.size()];
        for (unsigned k = 1 + random() % 2; k > 0; --k) break_something(scene, random);
        const std::string text = scene.dump();
        try {
            const Scene result = load_text(text);
            ++loaded;
            // What loads is whole: indices in range, numbers finite.
            for (const Mesh& mesh : result.meshes) {
                for (const Id material : mesh.object.material) REQUIRE(material < result.materials.size());
                for (const int index : mesh.cage.face_vertex_indices)
                    REQUIRE(static_cast<std::size_t>(index) < mesh.cage.points.size());
                for (const Vec3& point : mesh.object.points)
                    REQUIRE(std::isfinite(point.x + point.y + point.z));
                if (mesh.role == Role::kOptic) REQUIRE(mesh.material < result.materials.size());
            }
        } catch (const InputError& error) {
            ++refused;
            INFO(text);
            REQUIRE(contains(error.what(), "room.json"));
            REQUIRE(std::string(error.what()).find('\n') == std::string::npos);
        }
    }
    CHECK(loaded > 150);
    CHECK(refused > 1000);
}

TEST_CASE("law: broken text loads or says what is wrong in which file", "[scene][bad-input][law]") {
    std::mt19937 random(21);
    const std::string good = kRoom;
    const std::string letters = "{}[]\",:0e-.\\/\x80\n a";
    for (int i = 0; i < 3000; ++i) {
        std::string text = good;
        for (unsigned k = 1 + random() % 3; k > 0; --k) {
            const std::size_t at = random() % text.size();
            switch (random() % 3) {
                case 0:
                    text.erase(at, 1 + random() % 5);
                    break;
                case 1:
                    text[at] = letters[random() % letters.size()];
                    break;
                default:
                    text.resize(at);
                    break;
            }
            if (text.empty()) break;
        }
        const std::string error = error_of(text);
        INFO(error);
        REQUIRE((error.empty() || begins_with(error, "room.json: ")));
        REQUIRE(error.find('\n') == std::string::npos);
    }
}
