// A glTF as a scene: what its nodes, materials, cameras, lights, skins and animations become.
#include "gltf_scene_text.h"
#include "scene/animation.h"
#include "scene/formats/gltf.h"
#include "scene/info.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("a glTF is a scene: instances through the hierarchy, its camera and its lights", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_whole");
    GltfParts parts;
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

TEST_CASE("instances of a glTF's node are as many nodes within it", "[scene][law]") {
    const std::string folder = scratch_dir("scene_gltf_instances");
    GltfBuffer buffer = make_buffer();
    const int translations = buffer.add({0, 0, 0, 2, 0, 0, 0, 3, 1}, "VEC3", 3);
    const int rotations =
        buffer.add({0, 0, 0, 1, 0, 0, std::sqrt(0.5), std::sqrt(0.5), 0, 1, 0, 0}, "VEC4", 4);
    const int scales = buffer.add({1, 1, 1, 2, 1, 1, 1, -1, 3}, "VEC3", 3);
    const auto with = [&](const std::string& attributes) {
        GltfParts parts;
        parts.nodes = R"([{"name":"rig","translation":[0,0,5],"rotation":[0.6,0,0,0.8],"children":[1]},
            {"name":"tile","mesh":0,"scale":[1,2,1],"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{)" +
                      attributes + "}}}}]";
        parts.more =
            R"(,"extensionsUsed":["EXT_mesh_gpu_instancing"],"extensionsRequired":["EXT_mesh_gpu_instancing"])";
        return parts;
    };
    const std::string t = "\"TRANSLATION\":" + std::to_string(translations),
                      r = "\"ROTATION\":" + std::to_string(rotations),
                      s = "\"SCALE\":" + std::to_string(scales);
    const Scene scene = load(write_gltf(folder, with(t + "," + r + "," + s), buffer));
    // The same by nodes.
    GltfParts nodes = with("");
    nodes.more = "";
    nodes.nodes = R"([{"translation":[0,0,5],"rotation":[0.6,0,0,0.8],"children":[1]},
        {"scale":[1,2,1],"children":[2,3,4]},{"name":"tile","mesh":0},
        {"name":"tile","mesh":0,"translation":[2,0,0],"rotation":[0,0,0.7071067811865476,0.7071067811865476],"scale":[2,1,1]},
        {"name":"tile","mesh":0,"translation":[0,3,1],"rotation":[0,1,0,0],"scale":[1,-1,3]}])";
    const Scene same = load(write_gltf(folder, nodes));
    REQUIRE(scene.meshes.size() == 3);
    REQUIRE(same.meshes.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(scene.meshes[i].name == same.meshes[i].name);
        REQUIRE(scene.meshes[i].object.points.size() == same.meshes[i].object.points.size());
        for (std::size_t k = 0; k < same.meshes[i].object.points.size(); ++k)
            CHECK(length(scene.meshes[i].object.points[k] - same.meshes[i].object.points[k]) < 1e-6);
        CHECK(scene.meshes[i].object.triangles == same.meshes[i].object.triangles);
    }
    CHECK(!warns(scene, "EXT_mesh_gpu_instancing"));
    ImportOptions tiles;
    tiles.optics = {"tile"};
    CHECK(load(write_gltf(folder, with(t), buffer), tiles).meshes[2].role == Role::kOptic);
    CHECK(load(write_gltf(folder, with(""), buffer)).meshes.size() == 1);
    GltfParts posed = with(t);
    posed.primitive = R"({"attributes":{"POSITION":0},"indices":1,"material":0,"targets":[{"POSITION":2}]})";
    const Scene one = load(write_gltf(folder, posed, buffer));
    CHECK(one.meshes.size() == 1);
    CHECK(warns(one, "instances of a mesh with a skin or morph targets are one"));

    const std::string place = ": /nodes/1/extensions/EXT_mesh_gpu_instancing";
    CHECK(load_error(write_gltf(folder, with(t + ",\"SCALE\":7"), buffer)) ==
          place + ": its attributes have 3 entries and 2");
    CHECK(begins_with(load_error(write_gltf(folder, with("\"SCALE\":77"), buffer)),
                      place + "/attributes/SCALE: "));
    CHECK(begins_with(load_error(write_gltf(folder, with("\"SCALE\":1"), buffer)), ": /accessors/1: "));
}

TEST_CASE("a glTF without camera and lights gets some, and says so", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_studio");
    const Scene scene = load(write_gltf(folder, GltfParts()));
    CHECK(warns(scene, "has no camera: one that shows all of it is added"));
    CHECK(warns(scene, "has no lights: 'key' and 'fill' are added"));
    CHECK(scene.cameras.size() == 1);
    CHECK(scene.lights.size() == 2);
}

TEST_CASE("optics of a glTF: by name, by extras, by material", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_optics");
    GltfParts parts;
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
        "KHR_materials_volume":{"thicknessFactor":1,"attenuationColor":[0.5,1,1],"attenuationDistance":2}}}])";
    scene = load(write_gltf(folder, parts));
    CHECK(scene.meshes[0].role == Role::kOptic);
    CHECK(scene.materials[0].transmission_factor == 1);
    CHECK(scene.materials[0].ior == 1.33);
    CHECK(scene.materials[0].attenuation_color == Vec3(0.5, 1, 1));
    CHECK(scene.materials[0].attenuation_distance == 2);

    // Named, whatever it is made of; and what it is made of then.
    parts = GltfParts();
    for (const char* pattern : {"squ*", "sh?pe", "paint"}) {
        scene = load(write_gltf(folder, parts), {{pattern}, {}, ""});
        CHECK(scene.meshes[0].role == Role::kOptic);
        CHECK(scene.materials[scene.meshes[0].material].metallic_factor == 1);
        CHECK(warns(scene, "material 'paint' is drawn as a perfect mirror on an optic"));
    }
    CHECK_THROWS_AS(load(write_gltf(folder, parts), {{"sqare"}, {}, ""}), UsageError);
    // Up to 0.3 it stays as rough as it is.
    parts.materials =
        R"([{"name":"steel","pbrMetallicRoughness":{"metallicFactor":1,"roughnessFactor":0.25}}])";
    scene = load(write_gltf(folder, parts));
    CHECK(scene.meshes[0].role == Role::kObject);
    scene = load(write_gltf(folder, parts), {{"squ*"}, {}, ""});
    CHECK(scene.meshes[0].role == Role::kOptic);
    CHECK(scene.materials[scene.meshes[0].material].roughness_factor == 0.25);
    CHECK(!warns(scene, "is drawn as a perfect mirror"));

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
    GltfParts parts;
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
    GltfParts parts;
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
    GltfParts parts;
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
    GltfParts parts;
    parts.more = R"(,"extensionsUsed":["KHR_materials_sheen","KHR_node_visibility"])";
    const Scene scene = load(write_gltf(folder, parts));
    CHECK(warns(scene, "the extension 'KHR_materials_sheen' is ignored"));
    CHECK(warns(scene, "the extension 'KHR_node_visibility' is ignored"));
}

TEST_CASE("maps that an optic of a glTF does not show are told of", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_optic_maps");
    GltfParts parts;
    parts.materials = R"([{"name":"paint","emissiveFactor":[1,0,0],"occlusionTexture":{"index":0},
        "pbrMetallicRoughness":{"metallicFactor":1,"roughnessFactor":0,"baseColorTexture":{"index":0},
        "metallicRoughnessTexture":{"index":0}}}])";
    parts.more =
        std::string(
            R"(,"textures":[{"source":0}],"images":[{"mimeType":"image/png","uri":"data:image/png;base64,)") +
        "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC\"}]";
    const Scene scene = load(write_gltf(folder, parts), {{"squ*"}, {}, ""});
    REQUIRE(scene.meshes[0].role == Role::kOptic);
    for (const char* map : {"baseColorTexture", "metallicRoughnessTexture", "occlusionTexture"})
        CHECK(warns(scene, std::string(map) + " of an optic is not drawn (of 'paint')"));
    CHECK(warns(scene, "of an optic: not drawn there: emissiveFactor"));
}
