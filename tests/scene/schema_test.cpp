// The printed schema and the loader agree, as an independent validator (valijson, draft 7) sees it.
#include <filesystem>
#include <fstream>
#include <random>

#include "json/json.h"
#include "scene/examples/examples.h"
#include "scene_text.h"

#if __has_include(<valijson/validator.hpp>)
#define TRILENS_HAS_VALIJSON 1
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>
#endif

using namespace trilens;
using namespace trilens_test;

TEST_CASE("every example loads without warnings that matter", "[scene]") {
    CHECK(scene_examples().size() >= 3);
    for (const SceneExample& example : scene_examples()) {
        INFO(example.name);
        const Scene scene = load_text(example.json);
        CHECK(scene.meshes.size() >= 2);
        for (const std::string& warning : scene.warnings)
            CHECK(contains(warning, "this glass is one interface"));
    }
}

namespace {

/// Keys that an object must have, and whose schema says what they are where they are missing.
void collect_idle_defaults(const Json& schema, const std::string& place, std::string& all) {
    if (schema.is_object() && schema.contains("required") && schema.contains("properties"))
        for (const Json& key : schema.at("required")) {
            const Json& properties = schema.at("properties");
            const auto found = properties.find(key.get<std::string>());
            if (found != properties.end() && found->is_object() && found->contains("default"))
                all += place + "/" + key.get<std::string>() + "\n";
        }
    if (!schema.is_structured()) return;
    for (const auto& [key, part] : schema.items()) collect_idle_defaults(part, place + "/" + key, all);
}

}  // namespace

TEST_CASE("what a scene must say has no default", "[scene]") {
    std::string all;
    collect_idle_defaults(parse_json(scene_schema(), "the schema"), "", all);
    CHECK(all == "");
}

#ifdef TRILENS_HAS_VALIJSON
namespace {

class Validator {
  public:
    Validator() {
        const nlohmann::json text = nlohmann::json::parse(scene_schema());
        valijson::SchemaParser parser;
        parser.populateSchema(valijson::adapters::NlohmannJsonAdapter(text), schema_);
    }
    bool accepts(const nlohmann::json& scene) {
        return valijson::Validator().validate(schema_, valijson::adapters::NlohmannJsonAdapter(scene),
                                              nullptr);
    }

  private:
    valijson::Schema schema_;
};

nlohmann::json parse(const char* text) {
    return nlohmann::json::parse(text, nullptr, true, true);
}

/// Pointers to all parts of a document.
void collect(const nlohmann::json& value, const std::string& pointer, std::vector<std::string>& all) {
    if (!pointer.empty()) all.push_back(pointer);
    if (value.is_object())
        for (const auto& [key, part] : value.items()) collect(part, pointer + "/" + key, all);
    if (value.is_array())
        for (std::size_t i = 0; i < value.size(); ++i)
            collect(value[i], pointer + "/" + std::to_string(i), all);
}

}  // namespace

TEST_CASE("the schema accepts the good and refuses the broken", "[scene][bad-input][oracle]") {
    Validator validator;
    CHECK(validator.accepts(parse(kRoom)));
    for (const SceneExample& example : scene_examples()) {
        INFO(example.name);
        CHECK(validator.accepts(parse(example.json)));
    }
    const auto broken = [&](const std::string& pointer, const nlohmann::json& value) {
        nlohmann::json scene = parse(kRoom);
        scene[nlohmann::json::json_pointer(pointer)] = value;
        return !validator.accepts(scene);
    };
    CHECK(broken("/film/width", 0));
    CHECK(broken("/film/widht", 10));
    CHECK(broken("/cameras/0/type", "rayMesh"));
    CHECK(broken("/meshes/1/primitive/type", "box"));
    CHECK(broken("/meshes/1/primitive/height", 1));
    CHECK(broken("/meshes/1/file", "ball.obj"));
    CHECK(broken("/render/paths", {"direct", "direct"}));
    CHECK_FALSE(broken("/meshes/1/x-note", 3));
    CHECK_FALSE(broken("/extras", {{"free", 1}}));

    const std::string texture = "/materials/0/baseColorTexture";
    CHECK_FALSE(broken(texture, "a.png"));
    CHECK_FALSE(broken(texture, {{"file", "a.png"}}));
    CHECK_FALSE(broken(texture, {{"pattern", "checker"}}));
    CHECK(broken(texture, ""));
    CHECK(broken(texture, 3));
    CHECK(broken(texture, nlohmann::json::object()));
    CHECK(broken(texture, {{"file", "a.png"}, {"pattern", "checker"}}));
}

TEST_CASE("the schema accepts every scene that comes with the program", "[scene][oracle]") {
    Validator validator;
    int scenes = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source_dir() + "/scenes")) {
        if (entry.path().extension() != ".json") continue;
        std::ifstream file(entry.path());
        const nlohmann::json scene = nlohmann::json::parse(file, nullptr, true, true);
        // What it changes of an import is no whole mesh.
        if (!scene.contains("cameras") || scene.contains("import")) continue;
        INFO(entry.path());
        CHECK(validator.accepts(scene));
        ++scenes;
    }
    CHECK(scenes > 50);
}

TEST_CASE("law: what loads is what the schema accepts but for what a schema cannot say",
          "[scene][oracle][law]") {
    Validator validator;
    std::vector<std::string> pointers;
    collect(parse(kRoom), "", pointers);
    const std::vector<std::string> values = {
        "null",       "true",      "-1",          "0",          "0.5",
        "1",          "2",         "7",           "1e31",       "300",
        "\"sphere\"", "\"plane\"", "\"rayMesh\"", "\"object\"", "[]",
        "[0,0]",      "[1,2,3]",   "[1,0,0,1]",   "{}",         "{\"type\":\"smooth\"}"};
    std::mt19937 random(5);
    int refused_by_both = 0, accepted_by_both = 0;
    for (int i = 0; i < 1500; ++i) {
        nlohmann::json scene = parse(kRoom);
        const std::string& pointer = pointers[random() % pointers.size()];
        scene[nlohmann::json::json_pointer(pointer)] =
            nlohmann::json::parse(values[random() % values.size()]);
        const bool accepted = validator.accepts(scene);
        const std::string error = error_of(scene.dump());
        INFO(pointer << " -> " << error << "\n" << scene.dump());
        if (error.empty()) CHECK(accepted);  // the loader is never laxer than the schema
        // A loader's refusal of what the schema accepts is a semantic one: its message is not of the walker's
        // kind.
        if (accepted && !error.empty()) {
            CHECK_FALSE(contains(error, "unknown key"));
            CHECK_FALSE(contains(error, "expected "));
            CHECK_FALSE(contains(error, "must be at "));
        }
        refused_by_both += !accepted && !error.empty();
        accepted_by_both += accepted && error.empty();
    }
    CHECK(refused_by_both > 500);
    CHECK(accepted_by_both > 50);
}
#else
TEST_CASE("the schema accepts the good and refuses the broken", "[scene][bad-input][oracle]") {
    TRILENS_SKIP("needs valijson");
}
#endif
