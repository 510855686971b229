#include "laws/worlds.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "base/math/box.h"
#include "base/util/error.h"
#include "image/image_io.h"
#include "support/test.h"

using namespace trilens;
namespace fs = std::filesystem;

namespace trilens_test {
namespace {

std::unique_ptr<World> finish(Scene scene, int n) {
    for (Mesh& mesh : scene.meshes)
        if (mesh.role == Role::kOptic) mesh.resolution = n;
    return make_world(std::move(scene), ignore);
}

/// Bounds of an OBJ's vertices.
Box obj_bounds(const std::string& file) {
    std::ifstream in(file);
    Box box;
    std::string word;
    while (in >> word) {
        if (word == "v") {
            Vec3 p;
            in >> p.x >> p.y >> p.z;
            box.include(p);
        }
        in.ignore(1 << 20, '\n');
    }
    return box;
}

std::string number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
}

/// The transform that brings a box to `size` around `centre`, as JSON.
std::string fit(const Box& box, double size, const Vec3& centre) {
    const Vec3 extent = box.high - box.low;
    const double scale = size / std::max({extent.x, extent.y, extent.z});
    const Vec3 move = centre - scale * 0.5 * (box.low + box.high);
    return "{\"translate\":[" + number(move.x) + "," + number(move.y) + "," + number(move.z) +
           "],\"scale\":[" + number(scale) + "," + number(scale) + "," + number(scale) + "]}";
}

std::string wall(const std::string& name, const std::string& points) {
    return "{\"name\":\"" + name + "\",\"role\":\"object\",\"material\":\"" + name +
           "\",\"points\":" + points + ",\"faceVertexCounts\":[4],\"faceVertexIndices\":[0,1,2,3]}";
}

/// A coloured room with a camera, an optic first among its meshes and a model. `optic`: the fields that give
/// its shape.
std::string room_json(const std::string& optic, const std::string& model_file, int width, int height) {
    return "{\"version\":1,\"film\":{\"width\":" + std::to_string(width) +
           ",\"height\":" + std::to_string(height) +
           "},\"cameras\":[{\"name\":\"main\",\"type\":\"perspective\",\"yfov\":40,\"lookAt\":{\"eye\":[0.4,"
           "0.9,4.4],\"at\":[0,0,0],\"up\":[0,1,0]}}],"
           "\"materials\":[{\"name\":\"chrome\",\"metallicFactor\":1,\"roughnessFactor\":0},{\"name\":"
           "\"floor\"},{\"name\":\"back\"},{\"name\":\"left\"},"
           "{\"name\":\"right\"},{\"name\":\"ceiling\"},{\"name\":\"front\"},{\"name\":\"model\"}],"
           "\"meshes\":"
           "[{\"name\":\"cage\",\"role\":\"optic\",\"material\":\"chrome\"," +
           optic + "},{\"name\":\"model\",\"role\":\"object\",\"material\":\"model\",\"file\":\"" +
           model_file + "\",\"transform\":" + fit(obj_bounds(model_file), 1.6, Vec3(1.7, -0.6, 1.2)) + "}," +
           wall("floor", "[[-3,-1.5,5],[3,-1.5,5],[3,-1.5,-3],[-3,-1.5,-3]]") + "," +
           wall("back", "[[-3,-1.5,-3],[3,-1.5,-3],[3,2.8,-3],[-3,2.8,-3]]") + "," +
           wall("left", "[[-3,-1.5,5],[-3,-1.5,-3],[-3,2.8,-3],[-3,2.8,5]]") + "," +
           wall("right", "[[3,-1.5,-3],[3,-1.5,5],[3,2.8,5],[3,2.8,-3]]") + "," +
           wall("ceiling", "[[-3,2.8,-3],[3,2.8,-3],[3,2.8,5],[-3,2.8,5]]") + "," +
           wall("front", "[[3,-1.5,5],[-3,-1.5,5],[-3,2.8,5],[3,2.8,5]]") +
           "],\"lights\":[{\"type\":\"ambient\"}]}";
}

}  // namespace

const std::vector<std::string>& shipped_scenes() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> found;
        for (const auto& entry : fs::directory_iterator(source_dir() + "/scenes"))
            if (entry.path().extension() == ".json") found.push_back(entry.path().stem().string());
        std::sort(found.begin(), found.end());
        return found;
    }();
    return names;
}

std::unique_ptr<World> shipped_world(const std::string& name, int n, int width, int height,
                                     std::string* missing) {
    // One sample a pixel, whatever the scene has: laws are of rays.
    const std::vector<SceneOverride> film{
        {"/film/width", std::to_string(width)}, {"/film/height", std::to_string(height)}, {"/film/spp", "1"}};
    try {
        return finish(load_scene(source_dir() + "/scenes/" + name + ".json", film,
                                 {read_texture, decode_texture, read_heights}),
                      n);
    } catch (const InputError& error) {
        // Only a model that Debian packages and this machine lacks may be missing.
        if (!missing || fs::exists("/usr/share/assimp/models") ||
            std::string(error.what()).find("/usr/share/assimp") == std::string::npos)
            throw;
        *missing = error.what();
        return nullptr;
    }
}

std::vector<std::string> data_cages() {
    std::vector<std::string> found;
    if (data_missing("cages")) return found;
    for (const auto& entry : fs::directory_iterator(data_dir() + "/cages"))
        if (entry.path().extension() == ".obj") found.push_back(entry.path().filename().string());
    std::sort(found.begin(), found.end());
    return found;
}

std::unique_ptr<World> data_world(const std::string& name) {
    std::ifstream in(data_dir() + "/scenes/" + name + ".json");
    std::stringstream text;
    text << in.rdbuf();
    // Their files are named by where they lay when the scenes were written.
    const std::regex cage("\"[^\"]*/(cages/[^\"]*)\""), texture("\"[^\"]*/(textures/[^\"]*)\"");
    const std::string cages = std::regex_replace(text.str(), cage, "\"" + data_dir() + "/$1\"");
    const std::string json = std::regex_replace(cages, texture, "\"" + source_dir() + "/scenes/$1\"");
    return make_world(
        load_scene_text(json, SceneSource(name, ""), {}, {read_texture, decode_texture, read_heights}),
        ignore);
}

std::unique_ptr<World> world_from(const std::string& name, const std::string& json, int n) {
    const std::string file = scratch_dir("worlds_" + name) + "/" + name + ".json";
    std::ofstream(file) << json;
    return finish(load_scene(file, {}, {read_texture, decode_texture, read_heights}), n);
}

std::unique_ptr<World> cage_world(const std::string& cage, int n, int width, int height) {
    const std::string cage_file = data_dir() + "/cages/" + cage, model_file = data_dir() + "/models/spot.obj";
    const std::string scheme = cage.rfind("loop_", 0) == 0 ? "loop" : "catmullClark";
    const std::string optic = "\"file\":\"" + cage_file + "\",\"subdivisionScheme\":\"" + scheme +
                              "\",\"transform\":" + fit(obj_bounds(cage_file), 2.2, Vec3(0));
    return world_from("cage_" + cage, room_json(optic, model_file, width, height), n);
}

std::unique_ptr<World> cage_world(const Cage& cage, int n, int width, int height) {
    const std::string model_file = source_dir() + "/scenes/models/balloon.obj";
    const std::string file = scratch_dir("worlds_made") + "/made.json";
    std::ofstream(file) << room_json("\"primitive\":{\"type\":\"sphere\"}", model_file, width, height);
    Scene scene = load_scene(file, {}, {read_texture, decode_texture, read_heights});

    Mesh& mesh = scene.meshes[0];
    mesh.primitive.reset();
    mesh.cage = cage;
    Box box;
    for (const Vec3& p : cage.points) box.include(p);
    const Vec3 extent = box.size();
    const double scale = 2.2 / std::max({extent.x, extent.y, extent.z});
    for (Vec3& p : mesh.cage.points) p = scale * (p - 0.5 * (box.low + box.high));
    return finish(std::move(scene), n);
}

void write_heights(const std::string& file, const HeightGrid& heights) {
    Image image;
    image.width = image.data_width = heights.columns;
    image.height = image.data_height = heights.rows;
    image.channels.push_back({"Y", heights.values});
    write_exr(file, image);
}

}  // namespace trilens_test
