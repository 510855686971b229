// Keys of a glTF that have a wrong type or a value out of range: each is refused, with its place.
#include <iterator>

#include "gltf_scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A glTF with every key that is read, in valid JSON.
Json full_gltf(const std::string& folder) {
    GltfParts parts;
    parts.primitive =
        R"({"attributes":{"POSITION":0,"JOINTS_0":3,"WEIGHTS_0":4},"indices":1,"material":0,"mode":4,"targets":[{"POSITION":2}]})";
    parts.nodes =
        R"([{"name":"square","mesh":0,"skin":0,"weights":[0.5],"scale":[1,1,1],"rotation":[0,0,0,1]},
        {"children":[2],"camera":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]},
        {"translation":[1,3,0],"extensions":{"KHR_lights_punctual":{"light":0}}}])";
    parts.roots = "[0,1]";
    parts.materials =
        R"([{"name":"paint","pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0.5,"baseColorFactor":[1,1,1,1],
        "baseColorTexture":{"index":0,"texCoord":0,"extensions":{"KHR_texture_transform":{"offset":[0,0],"scale":[1,1],"rotation":0,"texCoord":0}}}},
        "normalTexture":{"index":0,"scale":1},"occlusionTexture":{"index":0,"strength":1},"emissiveTexture":{"index":0},
        "alphaMode":"MASK","alphaCutoff":0.5,"doubleSided":true,"emissiveFactor":[1,0,0],"extensions":{"KHR_materials_transmission":{"transmissionFactor":0},
        "KHR_materials_ior":{"ior":1.33},"KHR_materials_volume":{"thicknessFactor":1,"attenuationColor":[0.5,1,1],"attenuationDistance":2},
        "KHR_materials_specular":{"specularFactor":0.5,"specularColorFactor":[1,1,1]},"KHR_materials_dispersion":{"dispersion":0},
        "KHR_materials_emissive_strength":{"emissiveStrength":1}}}])";
    parts.more =
        R"(,"skins":[{"joints":[1,2],"inverseBindMatrices":5}],"textures":[{"source":0,"sampler":0,"extensions":{"EXT_texture_webp":{"source":0}}}],
        "images":[{"uri":"white.png"}],"samplers":[{"wrapS":33071,"wrapT":10497,"magFilter":9729}],"extensionsUsed":["KHR_lights_punctual"],
        "cameras":[{"name":"eye","type":"perspective","perspective":{"yfov":0.7,"aspectRatio":2,"znear":1}},
        {"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"znear":0,"zfar":1}}],
        "extensions":{"KHR_lights_punctual":{"lights":[{"name":"sun","type":"spot","intensity":60,"range":3,"color":[1,0.5,0],"spot":{"innerConeAngle":0.1,"outerConeAngle":0.5}}]}},
        "animations":[{"name":"hop","samplers":[{"input":6,"output":9,"interpolation":"CUBICSPLINE"},{"input":6,"output":8}],
        "channels":[{"sampler":0,"target":{"node":0,"path":"translation"}},{"sampler":1,"target":{"node":0,"path":"weights"}}]}])";
    std::ofstream(folder + "/white.png") << "decoded by the test's reader";
    std::ifstream in(write_gltf(folder, parts));
    const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    Json json = Json::parse(text);
    json["accessors"][0]["byteOffset"] = 0;
    json["accessors"][0]["normalized"] = false;
    json["accessors"][2]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", 1}, {"byteOffset", 0}, {"componentType", 5123}}},
        {"values", {{"bufferView", 2}, {"byteOffset", 0}}}};
    json["asset"]["minVersion"] = "2.0";
    return json;
}

/// What loading it ends in, where the key at `place` has this value.
std::string error_with(const Json& good, const std::string& folder, const std::string& place,
                       const Json& value) {
    Json changed = good;
    changed[Json::json_pointer(place)] = value;
    std::ofstream(folder + "/room.gltf") << changed.dump();
    return load_error(folder + "/room.gltf");
}

}  // namespace

TEST_CASE("law: a glTF key of a wrong type is refused with its place", "[scene][bad-input][law]") {
    const std::string folder = scratch_dir("scene_gltf_key_types");
    const Json good = full_gltf(folder);
    REQUIRE(error_with(good, folder, "/scene", 0) == "");
    int keys = 0;
    const Json flat = good.flatten();
    for (const auto& [place, value] : flat.items()) {
        if (place.ends_with("/znear") || place.ends_with("/zfar")) continue;  // read by nobody
        ++keys;
        const Json of_another_type = value.is_string() ? Json(true) : Json("4");
        for (const Json& wrong : {of_another_type, Json(), Json::array({}), Json::object()}) {
            INFO(place << " " << wrong.dump());
            CHECK(begins_with(error_with(good, folder, place, wrong), ": " + place + ": expected "));
        }
        // What holds keys and entries.
        for (std::string part = place.substr(0, place.rfind('/')); !part.empty();
             part = part.substr(0, part.rfind('/'))) {
            INFO(part);
            const Json wrong =
                good.at(Json::json_pointer(part)).is_array() ? Json::object() : Json::array({});
            CHECK(begins_with(error_with(good, folder, part, wrong), ": " + part + ": expected "));
        }
    }
    CHECK(keys > 100);
}

TEST_CASE("law: a glTF index that is no entry's is refused with its place", "[scene][bad-input][law]") {
    const std::string folder = scratch_dir("scene_gltf_indices");
    const Json good = full_gltf(folder);
    const std::string primitive = "/meshes/0/primitives/0";
    const std::vector<std::pair<std::string, std::string>> indices = {
        {"/scene", "1 scenes"},
        {"/scenes/0/nodes/1", "3 nodes"},
        {"/nodes/0/mesh", "1 meshes"},
        {"/nodes/0/skin", "1 skins"},
        {"/nodes/1/camera", "2 cameras"},
        {"/nodes/1/children/0", "3 nodes"},
        {"/nodes/2/extensions/KHR_lights_punctual/light", "1 lights"},
        {primitive + "/indices", "11 accessors"},
        {primitive + "/material", "1 materials"},
        {primitive + "/attributes/POSITION", "11 accessors"},
        {primitive + "/targets/0/POSITION", "11 accessors"},
        {"/materials/0/pbrMetallicRoughness/baseColorTexture/index", "1 textures"},
        {"/materials/0/normalTexture/index", "1 textures"},
        {"/materials/0/emissiveTexture/index", "1 textures"},
        {"/textures/0/source", "1 images"},
        {"/textures/0/sampler", "1 samplers"},
        {"/textures/0/extensions/EXT_texture_webp/source", "1 images"},
        {"/accessors/0/bufferView", "11 bufferViews"},
        {"/accessors/2/sparse/values/bufferView", "11 bufferViews"},
        {"/bufferViews/0/buffer", "1 buffers"},
        {"/skins/0/joints/0", "3 nodes"},
        {"/skins/0/inverseBindMatrices", "11 accessors"},
        {"/animations/0/channels/0/target/node", "3 nodes"},
        {"/animations/0/samplers/0/input", "11 accessors"},
        {"/animations/0/samplers/0/output", "11 accessors"}};
    for (const auto& [place, count] : indices) {
        INFO(place);
        for (const Json& wrong : {Json(-1), Json(99), Json(-9999999999), Json(4294967296)})
            CHECK(error_with(good, folder, place, wrong) ==
                  ": " + place + ": " + wrong.dump() + " is out of range: there are " + count);
        for (const Json& wrong : {Json(0.0), Json(1e10)})
            CHECK(error_with(good, folder, place, wrong) ==
                  ": " + place + ": is written " + wrong.dump() +
                      ": must be a whole number without a fraction");
        CHECK(error_with(good, folder, place, 0.5) ==
              ": " + place + ": is written 0.5: must be a whole number without a fraction");
    }
}

TEST_CASE("glTF values out of range are refused with their places", "[scene][bad-input]") {
    const std::string folder = scratch_dir("scene_gltf_ranges");
    const Json good = full_gltf(folder);
    const auto error = [&](const std::string& place, const Json& value) {
        return error_with(good, folder, place, value);
    };
    const std::string base = "/materials/0/pbrMetallicRoughness";
    CHECK(error(base + "/baseColorFactor", {1, 0}) ==
          ": " + base + "/baseColorFactor: has 2 entries, must have 4");
    CHECK(error(base + "/baseColorFactor/0", 2) ==
          ": " + base + "/baseColorFactor/0: 2 is out of range: must be at most 1");
    CHECK(error(base + "/baseColorFactor/0", 1.0000001192) == "");  // a 1 of single precision
    CHECK(error("/materials/0/emissiveFactor/2", 4) == "");         // as many exporters write it
    CHECK(error("/materials/0/emissiveFactor/2", 1e300) ==
          ": /materials/0/emissiveFactor/2: 1e+300 is out of range: must be at most 1e+30");
    CHECK(error(base + "/metallicFactor", -3) ==
          ": " + base + "/metallicFactor: -3 is out of range: must be at least 0");
    CHECK(error("/materials/0/emissiveFactor/2", -1) ==
          ": /materials/0/emissiveFactor/2: -1 is out of range: must be at least 0");
    CHECK(error("/samplers/0/wrapS", 5) ==
          ": /samplers/0/wrapS: expected 33071, 33648 or 10497, found the number 5");
    CHECK(error("/accessors/0/byteOffset", -8) ==
          ": /accessors/0/byteOffset: -8 is out of range: must be at least 0");
    CHECK(error("/bufferViews/0/byteOffset", -1) ==
          ": /bufferViews/0/byteOffset: -1 is out of range: must be at least 0");
    CHECK(error("/meshes/0/primitives/0/mode", 9) ==
          ": /meshes/0/primitives/0/mode: 9 is out of range: must be at most 6");
    CHECK(error("/asset/minVersion", "2.5") ==
          ": /asset/minVersion: glTF '2.5' is needed, which is not supported: 2.0 is");
    CHECK(error("/asset/version", "") == ": /asset/version: glTF '' is not supported, 2.0 is");
    CHECK(error("/asset", Json::object()) == ": /asset: has no 'version'");
    CHECK(error("/materials/0/normalTexture", {{"scale", 1}}) ==
          ": /materials/0/normalTexture: has no 'index'");
}

TEST_CASE("glTF factors that single precision rounds past 1 are 1, in the resolved scene too", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_rounded");
    Json rounded = full_gltf(folder);
    const double one = 1.0000001192;
    Json& base = rounded["materials"][0]["pbrMetallicRoughness"];
    base["baseColorFactor"] = {one, one, one, one};
    base["metallicFactor"] = base["roughnessFactor"] = one;
    std::ofstream(folder + "/room.gltf") << rounded.dump();
    const Scene scene = load(folder + "/room.gltf");
    const Scene again =
        load_scene_text(scene.resolved, SceneSource("again.json", folder), {}, white_textures());
    for (const Scene* read : {&scene, &again}) {
        CHECK(read->materials.at(0).base_color_factor == Vec3(1));
        CHECK(read->materials.at(0).metallic_factor == 1);
        CHECK(read->materials.at(0).roughness_factor == 1);
    }
}
