// What materials of a glTF become on optics and objects, and what is told of where scenes lack something.
#include "gltf_scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::string kMirror = R"("pbrMetallicRoughness":{"metallicFactor":1,"roughnessFactor":0)";
const std::string kPicture =
    R"(,"textures":[{"source":0,"sampler":0}],"images":[{"uri":"data:image/png;base64,iVBO"}])";
const std::string kLinear = R"(,"samplers":[{"magFilter":9729}])",
                  kNearest = R"(,"samplers":[{"magFilter":9728}])";

/// A square of one material named "opt", of which `fields` stand in the file.
Scene square_of(const std::string& fields, const ImportOptions& import = {},
                const std::string& more = kPicture + kLinear) {
    GltfParts parts;
    parts.primitive = R"({"attributes":{"POSITION":0},"indices":1,"material":0})";
    parts.materials = R"([{"name":"opt",)" + fields + "}]";
    parts.more = more;
    return load(write_gltf(scratch_dir("scene_gltf_materials"), parts), import);
}

std::string glass(const std::string& transmission, const std::string& more = "") {
    return R"("pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0},"extensions":{
        "KHR_materials_transmission":{"transmissionFactor":)" +
           transmission + "}" + more + "}";
}

Role role_of(const Scene& scene) {
    return scene.meshes.at(0).role;
}

}  // namespace

TEST_CASE("a mirror or glass of a glTF is an optic unless its alpha opens it", "[scene]") {
    for (const char* alpha : {R"("alphaMode":"OPAQUE")", R"("alphaMode":"MASK")", R"("alphaMode":"BLEND")"}) {
        INFO(alpha);
        for (const std::string& fields : {kMirror + "},", glass("1") + ","}) {
            const Scene scene = square_of(fields + alpha);
            CHECK(role_of(scene) == Role::kOptic);
            CHECK(scene.materials[0].name == "opt");
            CHECK(!warns(scene, "alphaMode"));
        }
    }
    // By a factor below 1, or below the cutoff, and by any picture.
    const std::string half = R"(,"baseColorFactor":[1,1,1,0.5]},)",
                      picture = R"(,"baseColorTexture":{"index":0}},)";
    CHECK(role_of(square_of(kMirror + half + R"("alphaMode":"MASK")")) == Role::kOptic);
    for (const std::string& open :
         {half + R"("alphaMode":"BLEND")", half + R"("alphaMode":"MASK","alphaCutoff":0.6)",
          picture + R"("alphaMode":"MASK")", picture + R"("alphaMode":"BLEND")"}) {
        INFO(open);
        const Scene scene = square_of(kMirror + open);
        CHECK(role_of(scene) == Role::kObject);
        CHECK(warns(scene, "what a mirror with alphaMode reflects is not drawn (of 'opt')"));
        // Named, it is an optic without its alpha.
        const Scene named = square_of(kMirror + open, {{"opt"}, {}, ""});
        CHECK(role_of(named) == Role::kOptic);
        CHECK(warns(named, "alphaMode of an optic is not drawn (of 'opt')"));
        CHECK(!warns(named, "what a mirror with alphaMode"));
    }
    CHECK(role_of(square_of(kMirror + picture + R"("alphaMode":"MASK","alphaCutoff":0)")) == Role::kOptic);
}

TEST_CASE("what a glTF's glass has that scenes lack is told of", "[scene]") {
    const std::string part = "transmissionFactor below 1 is not drawn (of 'opt')";
    CHECK(warns(square_of(glass("0.5")), part));
    CHECK(!warns(square_of(glass("1")), part));
    CHECK(!warns(square_of(glass("0")), part));
    CHECK(!warns(square_of(glass("0.5"), {{"opt"}, {}, ""}), part));  // drawn as perfect glass, with a word

    const std::string ior = R"(,"KHR_materials_ior":{"ior":0})";
    Scene scene = square_of(glass("1", ior));
    CHECK(scene.materials[0].ior == 1.5);
    CHECK(warns(scene, "an ior of 0 (all reflects) is not drawn (of 'opt')"));

    const std::string specular =
        R"(,"KHR_materials_specular":{"specularFactor":0,"specularColorFactor":[1,0,0]})";
    CHECK(warns(square_of(glass("1", specular)),
                "of an optic: not drawn there: specularFactor, specularColorFactor"));
    CHECK(!warns(square_of(glass("1", R"(,"KHR_materials_specular":{})")), "not drawn there"));
}

TEST_CASE("thin glass of a glTF does not absorb, and is told of", "[scene]") {
    const std::string tint = R"("attenuationColor":[0.5,0.25,1],"attenuationDistance":2})",
                      thin = "a thin wall (a volume's thicknessFactor 0) is not drawn (of 'opt')";
    const auto volume = [&](const std::string& thickness) {
        return square_of(glass("1", R"(,"KHR_materials_volume":{)" + thickness + tint));
    };
    for (const char* none : {"", R"("thicknessFactor":0,)"}) {
        const Scene scene = volume(none);
        CHECK(scene.materials[0].attenuation_distance == 0);
        CHECK(warns(scene, thin));
    }
    const Scene scene = volume(R"("thicknessFactor":0.1,)");
    CHECK(scene.materials[0].attenuation_distance == 2);
    CHECK(!warns(scene, thin));
    GltfParts parts;
    parts.materials = "[{" + glass("1", R"(,"KHR_materials_volume":{"thicknessFactor":-1})") + "}]";
    CHECK(contains(load_error(write_gltf(scratch_dir("scene_gltf_materials"), parts)),
                   "/extensions/KHR_materials_volume/thicknessFactor"));
}

TEST_CASE("a glTF's pictures that are to be shown in squares are told of", "[scene]") {
    const std::string fields = R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0}})";
    const std::string told = "baseColorTexture/magFilter NEAREST is not drawn (of 'opt')";
    CHECK(warns(square_of(fields, {}, kPicture + kNearest), told));
    CHECK(!warns(square_of(fields), told));
}
