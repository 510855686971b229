// A glTF as a scene: what its nodes, materials, cameras, lights, skins and animations become, and what is
// refused.
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "scene/animation.h"
#include "scene/formats/gltf.h"
#include "scene/info.h"
#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Numbers of a glTF's buffer, and the accessors that name them.
struct Buffer {
    std::string bytes, views, accessors;
    int count = 0;

    int add(const std::vector<double>& numbers, const std::string& type, int width, int component = 5126) {
        const std::size_t start = bytes.size();
        for (const double number : numbers) {
            const auto real = static_cast<float>(number);
            const auto whole = static_cast<std::uint16_t>(number);
            component == 5126 ? bytes.append(reinterpret_cast<const char*>(&real), 4)
                              : bytes.append(reinterpret_cast<const char*>(&whole), 2);
        }
        const std::string comma = count == 0 ? "" : ",";
        views += comma + R"({"buffer":0,"byteOffset":)" + std::to_string(start) + R"(,"byteLength":)" +
                 std::to_string(bytes.size() - start) + "}";
        accessors += comma + R"({"bufferView":)" + std::to_string(count) + R"(,"componentType":)" +
                     std::to_string(component) + R"(,"count":)" +
                     std::to_string(numbers.size() / static_cast<std::size_t>(width)) + R"(,"type":")" +
                     type + "\"}";
        while (bytes.size() % 4 != 0) bytes += '\0';
        return count++;
    }
};

/// A unit square (0), its indices (1), a morph target's steps (2), joints (3) and weights (4) of two bones,
/// their inverse bind matrices (5), times 0 and 2 (6), translations (7), weights of the target (8), a cubic
/// spline of translations (9), rotations of a quarter turn (10).
Buffer make_buffer() {
    Buffer buffer;
    buffer.add({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3", 3);
    buffer.add({0, 1, 2, 2, 1, 3}, "SCALAR", 1, 5123);
    buffer.add({0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 2}, "VEC3", 3);
    buffer.add({0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, "VEC4", 4, 5123);
    buffer.add({1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
    buffer.add(
        {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1},
        "MAT4", 16);
    buffer.add({0, 2}, "SCALAR", 1);
    buffer.add({0, 0, 0, 4, 0, 0}, "VEC3", 3);
    buffer.add({0, 1}, "SCALAR", 1);
    buffer.add({0, 0, 0, 0, 0, 0, 3, 0, 0, -3, 0, 0, 1, 0, 0, 0, 0, 0}, "VEC3", 3);
    buffer.add({0, 0, 0, 1, 0, 0, std::sqrt(0.5), std::sqrt(0.5)}, "VEC4", 4);
    return buffer;
}

/// The parts of a glTF that a test may say otherwise.
struct Parts {
    std::string nodes = R"([{"name":"square","mesh":0}])", roots = "[0]";
    std::string primitive = R"({"attributes":{"POSITION":0},"indices":1,"material":0})";
    std::string materials = R"([{"name":"paint","pbrMetallicRoughness":{"metallicFactor":0}}])";
    std::string more;  // top-level members, each after a comma
};

std::string write_gltf(const std::string& folder, const Parts& parts, const Buffer& buffer = make_buffer()) {
    std::ofstream(folder + "/room.bin", std::ios::binary) << buffer.bytes;
    std::ofstream(folder + "/room.gltf")
        << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":)" + parts.roots + R"(}],"nodes":)" +
               parts.nodes + R"(,"meshes":[{"name":"shape","primitives":[)" + parts.primitive +
               R"(]}],"materials":)" + parts.materials + R"(,"accessors":[)" + buffer.accessors +
               R"(],"bufferViews":[)" + buffer.views + R"(],"buffers":[{"uri":"room.bin","byteLength":)" +
               std::to_string(buffer.bytes.size()) + "}]" + parts.more + "}";
    return folder + "/room.gltf";
}

Scene load(const std::string& file, const ImportOptions& import = {},
           const std::vector<SceneOverride>& overrides = {}) {
    return load_scene(file, overrides, white_textures(), import);
}

/// What follows the file's name in the message.
std::string load_error(const std::string& file, const ImportOptions& import = {}) {
    try {
        load(file, import);
        return "";
    } catch (const InputError& error) {
        REQUIRE(begins_with(error.what(), file));
        return std::string(error.what()).substr(file.size());
    }
}

bool warns(const Scene& scene, const std::string& part) {
    for (const std::string& warning : scene.warnings)
        if (contains(warning, part)) return true;
    return false;
}

}  // namespace

TEST_CASE("a glTF is a scene: instances through the hierarchy, its camera and its lights", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_whole");
    Parts parts;
    // A rig a quarter turn about Y: what looks along -Z looks along -X.
    parts.nodes = R"([{"name":"a","mesh":0},{"name":"a","mesh":0,"translation":[5,0,0]},
        {"name":"rig","rotation":[0,0.7071067811865476,0,0.7071067811865476],"translation":[0,2,0],"children":[3,4,5]},
        {"name":"eye","camera":0,"translation":[0,0,3]},
        {"name":"lamp","extensions":{"KHR_lights_punctual":{"light":0}},"translation":[0,0,1]},
        {"extensions":{"KHR_lights_punctual":{"light":1}}}])";
    parts.roots = "[0,1,2]";
    parts.more =
        R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.7853981633974483,"aspectRatio":2,"znear":1}}],
        "extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[
        {"type":"point","intensity":60,"color":[1,0.5,0]},{"name":"sun","type":"directional","intensity":3}]}})";
    const Scene scene = load(write_gltf(folder, parts));
    REQUIRE(scene.meshes.size() == 2);
    CHECK(scene.meshes[0].name == "a");
    CHECK(scene.meshes[1].name == "a.2");
    CHECK(scene.meshes[0].role == Role::kObject);
    CHECK(scene.meshes[1].object.points[0] == Vec3(5, 0, 0));
    REQUIRE(scene.cameras.size() == 1);
    CHECK(scene.cameras[0].name == "eye");
    CHECK(scene.film.width == 960);
    CHECK(scene.film.height == 480);
    // What follows is read from the JSON, so that it stands whatever a camera is made of.
    const Json json = Json::parse(scene.resolved);
    const Json& camera = json.at("cameras").at(0);
    CHECK(camera.at("yfov").get<double>() == Approx(45));
    CHECK(length(to_vec3(camera.at("lookAt").at("eye")) - Vec3(3, 2, 0)) < 1e-12);
    const Vec3 ahead = to_vec3(camera.at("lookAt").at("at")) - to_vec3(camera.at("lookAt").at("eye"));
    CHECK(length(normalize_or_zero(ahead) - Vec3(-1, 0, 0)) < 1e-12);
    REQUIRE(scene.lights.size() == 2);
    const Json &lamp = json.at("lights").at(0), &sun = json.at("lights").at(1);
    CHECK(length(to_vec3(lamp.at("position")) - Vec3(1, 2, 0)) < 1e-12);
    CHECK(scene.lights[0].intensity == 60);
    CHECK(scene.lights[0].color == Vec3(1, 0.5, 0));
    CHECK(length(to_vec3(sun.at("direction")) - Vec3(-1, 0, 0)) < 1e-12);
    CHECK(scene.lights[1].intensity == 3);
    CHECK(sun.at("name") == "sun");
    // The scene says all that was read, so that it is read again as it is.
    const Scene again =
        load_scene_text(scene.resolved, SceneSource("again.json", folder), {}, white_textures());
    CHECK(again.meshes[1].object.points == scene.meshes[1].object.points);
    CHECK(again.warnings.empty());
}

TEST_CASE("a glTF without camera and lights gets some, and says so", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_studio");
    const Scene scene = load(write_gltf(folder, Parts()));
    CHECK(warns(scene, "has no camera: one that shows all of it is added"));
    CHECK(warns(scene, "has no lights: 'key' and 'fill' are added"));
    CHECK(scene.cameras.size() == 1);
    CHECK(scene.lights.size() == 2);
}

TEST_CASE("optics of a glTF: by name, by extras, by material", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_optics");
    Parts parts;
    parts.materials =
        R"([{"name":"chrome","pbrMetallicRoughness":{"metallicFactor":1,"roughnessFactor":0}}])";
    Scene scene = load(write_gltf(folder, parts));
    REQUIRE(scene.meshes.size() == 1);
    CHECK(scene.meshes[0].role == Role::kOptic);
    CHECK(scene.meshes[0].cage.scheme == SubdivisionScheme::kUnsubdivided);
    CHECK(scene.meshes[0].cage.face_vertex_counts.size() == 2);

    parts.materials =
        R"([{"name":"pane","pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0},"extensions":{
        "KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_ior":{"ior":1.33},
        "KHR_materials_volume":{"attenuationColor":[0.5,1,1],"attenuationDistance":2}}}])";
    scene = load(write_gltf(folder, parts));
    CHECK(scene.meshes[0].role == Role::kOptic);
    CHECK(scene.materials[0].transmission_factor == 1);
    CHECK(scene.materials[0].ior == 1.33);
    CHECK(scene.materials[0].attenuation_color == Vec3(0.5, 1, 1));
    CHECK(scene.materials[0].attenuation_distance == 2);

    // Named, whatever it is made of; and what it is made of then.
    parts = Parts();
    for (const char* pattern : {"squ*", "sh?pe", "paint"}) {
        scene = load(write_gltf(folder, parts), {{pattern}, {}, ""});
        CHECK(scene.meshes[0].role == Role::kOptic);
        CHECK(scene.materials[scene.meshes[0].material].metallic_factor == 1);
        CHECK(warns(scene, "material 'paint' is drawn as a perfect mirror on an optic"));
    }
    CHECK_THROWS_AS(load(write_gltf(folder, parts), {{"sqare"}, {}, ""}), UsageError);

    // Extras say more than the material, and more than the name.
    parts.materials =
        R"([{"name":"chrome","pbrMetallicRoughness":{"metallicFactor":1,"roughnessFactor":0}}])";
    parts.nodes = R"([{"name":"square","mesh":0,"extras":{"trilens":false}}])";
    CHECK(load(write_gltf(folder, parts), {{"square"}, {}, ""}).meshes[0].role == Role::kObject);
    parts.nodes =
        R"([{"name":"square","mesh":0,"extras":{"trilens":{"subdivision":"catmull-clark","resolution":5}}}])";
    scene = load(write_gltf(folder, parts));
    CHECK(scene.meshes[0].cage.scheme == SubdivisionScheme::kCatmullClark);
    CHECK(scene.meshes[0].cage.face_vertex_counts == std::vector<int>{4});  // the quad is whole again
    CHECK(scene.meshes[0].resolution == 5);
    parts.nodes = R"([{"name":"square","mesh":0,"extras":{"trilens":{"subdivision":"loop"}}}])";
    CHECK(load(write_gltf(folder, parts)).meshes[0].cage.face_vertex_counts == std::vector<int>{3, 3});
}

TEST_CASE("a scene imports a glTF, and changes it by name", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_import");
    Parts parts;
    parts.nodes = R"([{"name":"square","mesh":0},{"name":"other","mesh":0,"translation":[0,0,-3]}])";
    parts.roots = "[0,1]";
    write_gltf(folder, parts);
    const auto read = [&](const std::string& text) {
        return load_scene_text(text, SceneSource(folder + "/own.json", folder), {}, white_textures());
    };
    const std::string cameras =
        R"("cameras":[{"name":"mine","yfov":40,"lookAt":{"eye":[0,0,5],"at":[0,0,0]}}],
        "lights":[{"name":"all","type":"ambient"}])";
    const Scene scene = read(R"({"version":1,"import":"room.gltf",)" + cameras + R"(,
        "materials":[{"name":"paint","baseColorFactor":[1,0,0]},
                     {"name":"chrome","metallicFactor":1,"roughnessFactor":0}],
        "meshes":[{"name":"square","role":"optic","material":"chrome","subdivisionScheme":"none"},
                  {"name":"ball","role":"optic","material":"chrome","primitive":{"type":"sphere"}},
                  {"name":"other","transform":{"translate":[0,1,0]}}]})");
    REQUIRE(scene.meshes.size() == 3);
    CHECK(scene.meshes[0].role == Role::kOptic);
    CHECK(scene.meshes[1].name == "other");
    CHECK(scene.meshes[1].object.points[0] == Vec3(0, 1, -3));
    CHECK(scene.meshes[2].name == "ball");
    CHECK(scene.materials[0].base_color_factor == Vec3(1, 0, 0));
    CHECK(scene.cameras.size() == 1);
    CHECK(scene.lights.size() == 1);
    // Two glTF files: names of the second give way.
    const Scene two = read(R"({"version":1,"import":["room.gltf",{"file":"room.gltf","optics":["other"]}],)" +
                           cameras + "}");
    REQUIRE(two.meshes.size() == 4);
    CHECK(two.meshes[2].name == "room/square");
    CHECK(two.meshes[3].role == Role::kOptic);

    const auto error = [&](const std::string& import) {
        return error_of(R"({"version":1,"import":)" + import + "," + cameras + "}", {}, folder + "/own.json");
    };
    CHECK(contains(error("3"), "/import: expected"));
    CHECK(contains(error(R"({"file":"room.gltf","optic":["x"]})"), "/import/optic: unknown key 'optic'"));
    CHECK(contains(error(R"("no.glb")"), "/import: " + folder + "/no.glb"));
    CHECK(contains(error(R"("own.obj")"), "is no glTF"));
}

TEST_CASE("morph targets and skins are posed", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_pose");
    Parts parts;
    parts.primitive = R"({"attributes":{"POSITION":0},"indices":1,"material":0,"targets":[{"POSITION":2}]})";
    parts.nodes = R"([{"name":"square","mesh":0,"weights":[0.5],"translation":[0,0,1]}])";
    CHECK(load(write_gltf(folder, parts)).meshes[0].object.points[1] == Vec3(1, 0, 2));

    // Two bones, the second at x = 1 and moved up by 3; the mesh's own node counts for nothing.
    parts.primitive = R"({"attributes":{"POSITION":0,"JOINTS_0":3,"WEIGHTS_0":4},"indices":1,"material":0})";
    parts.nodes =
        R"([{"name":"square","mesh":0,"skin":0,"translation":[100,0,0]},{"name":"root","children":[2]},
        {"name":"tip","translation":[1,3,0]}])";
    parts.roots = "[0,1]";
    parts.more = R"(,"skins":[{"joints":[1,2],"inverseBindMatrices":5}])";
    const Scene scene = load(write_gltf(folder, parts));
    CHECK(scene.meshes[0].object.points[0] == Vec3(0, 0, 0));
    CHECK(scene.meshes[0].object.points[1] == Vec3(1, 3, 0));
    CHECK(scene.meshes[0].object.points[2] == Vec3(0, 2.5, 0));  // half of each
}

TEST_CASE("animations: at a time, and as the scene's frames", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_animation");
    Parts parts;
    parts.nodes = R"([{"name":"square","mesh":0},{"name":"eye","camera":0,"translation":[0,0,9]}])";
    parts.roots = "[0,1]";
    parts.more =
        R"(,"cameras":[{"type":"orthographic","orthographic":{"xmag":2,"ymag":1,"znear":0,"zfar":10}}],
        "animations":[{"name":"slide","samplers":[{"input":6,"output":7}],"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}},
                       {"sampler":0,"target":{"node":1,"path":"translation"}}]},
                      {"name":"jump","samplers":[{"input":6,"output":7,"interpolation":"STEP"}],"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}]},
                      {"name":"spline","samplers":[{"input":6,"output":9,"interpolation":"CUBICSPLINE"}],"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}]},
                      {"name":"turn","samplers":[{"input":6,"output":10}],"channels":[{"sampler":0,"target":{"node":0,"path":"rotation"}}]}])";
    const std::string file = write_gltf(folder, parts);
    const auto x_at = [&](const std::string& animation, double time) {
        return load(file, {{}, time, animation}).meshes[0].object.points[0].x;
    };
    CHECK(x_at("", 0.5) == 1);
    CHECK(x_at("", 7) == 4);
    CHECK(x_at("jump", 1.99) == 0);
    CHECK(x_at("jump", 2) == 4);
    // Hermite: x(s) = (s^3 - 2 s^2 + s) 2 * 3 + (3 s^2 - 2 s^3) 1 + (s^3 - s^2) 2 * -3 at s = 1/2.
    CHECK(x_at("spline", 1) == Approx(0.75 + 0.5 + 0.75));
    const Vec3 turned = load(file, {{}, 1.0, "turn"}).meshes[0].object.points[1];
    CHECK(length(turned - Vec3(std::sqrt(0.5), std::sqrt(0.5), 0)) < 1e-6);
    CHECK_THROWS_AS(load(file, {{}, {}, "slip"}), UsageError);

    const Scene scene = load(file);
    const auto info = find_animation(scene);
    REQUIRE(info);
    CHECK(info->last == 48);
    CHECK(scene.film.width == 960);
    const Scene later = load_frame(scene, 12, {}, white_textures());
    CHECK(later.meshes[0].object.points[0].x == Approx(1));
    const Json camera = Json::parse(later.resolved).at("cameras").at(0);
    CHECK(camera.at("lookAt").at("eye").at(0).get<double>() == Approx(1));
    CHECK(camera.at("ymag") == 1);
}

TEST_CASE("what a glTF has that scenes lack is told of", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_left");
    Parts parts;
    parts.more = R"(,"extensionsUsed":["KHR_materials_sheen","KHR_node_visibility"])";
    const Scene scene = load(write_gltf(folder, parts));
    CHECK(warns(scene, "the extension 'KHR_materials_sheen' is ignored"));
    CHECK(warns(scene, "the extension 'KHR_node_visibility' is ignored"));
}

TEST_CASE("bad glTF scenes: the file, the place and one message", "[scene][bad-input]") {
    const std::string folder = scratch_dir("scene_gltf_bad");
    struct Bad {
        Parts parts;
        std::string message;
    };
    const auto with = [](auto change) {
        Parts parts;
        change(parts);
        return parts;
    };
    const std::string animated =
        R"(,"animations":[{"samplers":[{"input":IN,"output":OUT}],"channels":[{"sampler":SAMPLER,"target":{"node":NODE,"path":"translation"}}]}])";
    const auto animation = [&](std::string in, std::string out, std::string sampler, std::string node) {
        return with([&](Parts& p) {
            p.more =
                replaced(replaced(replaced(replaced(animated, "IN", in), "OUT", out), "SAMPLER", sampler),
                         "NODE", node);
        });
    };
    const std::vector<Bad> all = {
        {with([](Parts& p) { p.nodes = R"([{"children":[1]},{"children":[0]}])"; }),
         ": /nodes/0: is its own ancestor: nodes must form a tree"},
        {with([](Parts& p) { p.nodes = R"([{"children":[0]}])"; }),
         ": /nodes/0: is its own ancestor: nodes must form a tree"},
        {with([](Parts& p) { p.nodes = R"([{"children":[2]},{"children":[2]},{"mesh":0}])"; }),
         ": /nodes/2: is a child of node 0 and of node 1: nodes must form a tree"},
        {with([](Parts& p) { p.roots = "[0,0]"; }),
         ": /scenes/0: node 0 is reached twice: nodes must form a tree"},
        {with([](Parts& p) { p.roots = "[5]"; }), ": /scenes/0: node 5 is out of range: there are 1"},
        {with([](Parts& p) { p.nodes = R"([{"mesh":0,"skin":0}])"; }),
         ": /nodes/0: skin 0 is out of range: there are 0"},
        {with([](Parts& p) { p.nodes = R"([{"camera":3}])"; }),
         ": /nodes/0: camera 3 is out of range: there are 0"},
        {with([](Parts& p) { p.nodes = R"([{"mesh":0,"extensions":{"KHR_lights_punctual":{"light":2}}}])"; }),
         ": /nodes/0: light 2 is out of range: there are 0"},
        {with([](Parts& p) { p.nodes = R"([{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2]}])"; }),
         ": /nodes/0: the last row of matrix must be 0 0 0 1"},
        {with([](Parts& p) { p.nodes = R"([{"mesh":0,"translation":[1e31,0,0]}])"; }),
         ": /nodes/0: translation holds a number beyond 1e30"},
        {with([](Parts& p) {
             p.materials = R"([{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
             p.more = R"(,"textures":[{"source":0}],"images":[{"uri":"none.png"}])";
         }),
         ": /images/0/uri: the picture '" + folder + "/none.png' does not exist"},
        {with([](Parts& p) {
             p.materials = R"([{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
             p.more = R"(,"textures":[{"source":0}],"images":[{"bufferView":99,"mimeType":"image/png"}])";
         }),
         ": not a readable glTF file: image[0] bufferView \"99\" not found in the scene."},
        {with([](Parts& p) { p.materials = R"([{"extensions":{"KHR_materials_ior":{"ior":-1}}}])"; }),
         ": /materials/0/extensions/KHR_materials_ior/ior: the number -1 is no number in 0..1e+30"},
        {with([](Parts& p) { p.materials = R"([{"alphaMode":"SOFT"}])"; }),
         ": /materials/0/alphaMode: is neither OPAQUE, MASK nor BLEND"},
        {with([](Parts& p) { p.nodes = R"([{"mesh":0,"extras":{"trilens":3}}])"; }),
         ": /nodes/0/extras/trilens: is neither true, false nor an object of a mesh's keys, but the number "
         "3"},
        {with([](Parts& p) { p.more = R"(,"extensionsRequired":["EXT_of_tomorrow"])"; }),
         ": /extensionsRequired: the extension 'EXT_of_tomorrow' is required but not supported"},
        {with([](Parts& p) {
             p.more = R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0,"znear":1}}])";
         }),
         ": /cameras/0/perspective/yfov: is not above 0, or far too large"},
        {animation("6", "7", "1", "0"),
         ": /animations/0/channels/0/sampler: sampler 1 is out of range: there are 1"},
        {animation("6", "7", "0", "9"),
         ": /animations/0/channels/0/target: node 9 is out of range: there are 1"},
        {animation("7", "7", "0", "0"), ": /accessors/7: must have entries of 1 components"},
        {animation("6", "0", "0", "0"),
         ": /animations/0/samplers/0/output: has 12 numbers, but its times need 6"},
        {animation("8", "99", "0", "0"), ": /accessors/99: is out of range: there are 11 accessors"},
    };
    for (const Bad& bad : all) {
        INFO(bad.message);
        CHECK(load_error(write_gltf(folder, bad.parts)) == bad.message);
    }
    // Numbers of the buffer that are none, or that lie about how many there are.
    Buffer buffer = make_buffer();
    const float none = NAN;
    std::memcpy(buffer.bytes.data() + buffer.bytes.size() - 4, &none, 4);
    CHECK(
        load_error(write_gltf(
            folder, with([](Parts& p) {
                p.more =
                    R"(,"animations":[{"samplers":[{"input":6,"output":10}],"channels":[{"sampler":0,"target":{"node":0,"path":"rotation"}}]}])";
            }),
            buffer)) == ": /accessors/10: entry 1 holds a number that is not finite or beyond 1e30");
    buffer = make_buffer();
    buffer.bytes.resize(40);
    const std::string short_one = write_gltf(folder, Parts(), buffer);
    CHECK(contains(load_error(short_one), "reaches beyond its buffer"));
    // A picture in a buffer view that reaches beyond its buffer.
    buffer = make_buffer();
    buffer.views += R"(,{"buffer":0,"byteOffset":16,"byteLength":100000})";
    const Parts pictured = with([](Parts& p) {
        p.materials = R"([{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
        p.more = R"(,"textures":[{"source":0}],"images":[{"bufferView":11,"mimeType":"image/png"}])";
    });
    CHECK(load_error(write_gltf(folder, pictured, buffer)) ==
          ": /images/0: its buffer view reaches beyond its buffer");
}

TEST_CASE("law: a broken glTF scene loads or says why not", "[scene][bad-input][law]") {
    const std::string folder = scratch_dir("scene_gltf_scene_fuzz");
    Parts parts;
    parts.primitive =
        R"({"attributes":{"POSITION":0,"JOINTS_0":3,"WEIGHTS_0":4},"indices":1,"material":0,"targets":[{"POSITION":2}]})";
    parts.nodes = R"([{"name":"square","mesh":0,"skin":0,"weights":[0.5]},{"children":[2],"camera":0},
        {"translation":[1,3,0],"extensions":{"KHR_lights_punctual":{"light":0}}}])";
    parts.roots = "[0,1]";
    parts.materials =
        R"([{"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0},"alphaMode":"MASK","alphaCutoff":0.5,
        "emissiveFactor":[1,0,0],"extensions":{"KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_ior":{"ior":1.33},
        "KHR_materials_volume":{"attenuationColor":[0.5,1,1],"attenuationDistance":2},"KHR_materials_specular":{"specularFactor":0.5}}}])";
    parts.more =
        R"(,"skins":[{"joints":[1,2],"inverseBindMatrices":5}],"cameras":[{"type":"perspective","perspective":{"yfov":0.7,"aspectRatio":2,"znear":1}}],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","intensity":60,"range":3,"color":[1,0.5,0],"spot":{"innerConeAngle":0.1,"outerConeAngle":0.5}}]}},
        "animations":[{"samplers":[{"input":6,"output":9,"interpolation":"CUBICSPLINE"},{"input":6,"output":8}],
        "channels":[{"sampler":0,"target":{"node":1,"path":"translation"}},{"sampler":1,"target":{"node":0,"path":"weights"}}]}])";
    const std::string file = write_gltf(folder, parts);
    std::ifstream in(file);
    const std::string good{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    REQUIRE(load_error(file) == "");
    const std::vector<std::string> tokens = {"-1",  "0",     "1",    "2",  "4294967296", "1e300",
                                             "0.5", "\"x\"", "null", "[]", "{}",         "999"};
    std::mt19937 random(11);
    int loaded = 0, refused = 0;
    for (int i = 0; i < 700; ++i) {
        std::string text = good;
        std::size_t at = text.find_first_of("0123456789", random() % text.size());
        if (at == std::string::npos) continue;
        const std::size_t end = text.find_first_not_of("0123456789.", at);
        text.replace(at, end - at, tokens[random() % tokens.size()]);
        std::ofstream(file) << text;
        INFO(text);
        const std::string error = load_error(file);
        CHECK(error.find('\n') == std::string::npos);
        ++(error.empty() ? loaded : refused);
    }
    CHECK(loaded > 100);
    CHECK(refused > 100);
}

TEST_CASE("every glTF of assimp's test models is a scene or says why not", "[scene]") {
    const std::string models = "/usr/share/assimp/models";
    if (!std::filesystem::exists(models)) TRILENS_SKIP("needs assimp's test models");
    int loaded = 0, refused = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(models)) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".gltf" && extension != ".glb") continue;
        const std::string error = load_error(entry.path().string());
        INFO(entry.path().string() << " -> " << error);
        CHECK(error.find('\n') == std::string::npos);
        ++(error.empty() ? loaded : refused);
    }
    INFO(loaded << " loaded, " << refused << " refused");
    CHECK(loaded >= 25);
}
