// MTL files: what is drawn, what is named as ignored, and the same colours that tinyobjloader reads.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#ifndef TINYOBJLOADER_USE_DOUBLE
#define TINYOBJLOADER_USE_DOUBLE
#endif
#include <tiny_obj_loader.h>

#include "scene/formats/obj.h"
#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::string kMark = "\xEF\xBB\xBF";

std::string mtl_error(const std::string& text) {
    try {
        parse_mtl(text, "a.mtl");
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

std::vector<std::string> warnings_of(const std::string& text) {
    return parse_mtl(text, "a.mtl").warnings;
}

}  // namespace

TEST_CASE("an MTL without materials has none, with and without a byte order mark", "[scene]") {
    for (const std::string& mark : {std::string(), kMark}) {
        for (const char* text : {"", "\n", "# Blender MTL File: 'None'\n# Material Count: 0\n", " \t\r\n#"}) {
            const MtlFile mtl = parse_mtl(mark + text, "a.mtl");
            CHECK(mtl.materials.empty());
            CHECK(mtl.warnings.empty());
        }
        const MtlFile mtl = parse_mtl(mark + "newmtl red\nKd 1 0 0\n", "a.mtl");
        REQUIRE(mtl.materials.size() == 1);
        CHECK(mtl.materials[0].name == "red");
        CHECK(mtl.materials[0].diffuse == Vec3(1, 0, 0));
        CHECK(mtl.warnings.empty());
    }
    CHECK(mtl_error(std::string("\xFF\xFEn\0e\0", 6)) == "a.mtl: is UTF-16 or UTF-32 text: save it as UTF-8");
}

TEST_CASE("an OBJ whose library has no materials is drawn in the default colour", "[scene]") {
    const std::string folder = scratch_dir("scene_mtl_empty");
    std::ofstream(folder + "/a.obj") << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl None\nf 1 2 3\n";
    const std::vector<SceneOverride> mesh = {{"/meshes/2", R"({"role":"object","file":"a.obj"})"}};
    for (const std::string& text : {std::string(), kMark, std::string("Kd 1 1 1\n")}) {
        std::ofstream(folder + "/a.mtl") << text;
        const Scene scene = load_text(kRoom, mesh, folder + "/room.json");
        CHECK(scene.materials.back().name == "mesh2/default");
        CHECK(contains(scene.warnings.back(), "the material 'None' is in no library") !=
              contains(scene.warnings.back(), "the material 'red' is not used"));
    }
}

TEST_CASE("what an MTL says in vain is named once", "[scene]") {
    CHECK(warnings_of("newmtl a\nKd 1 1 1\nd 1\nTr 0.0\n").empty());
    CHECK(warnings_of("newmtl a\nNs 250\nKd 1 1 1\nd 0.5\nillum 2\nnewmtl b\nd 0.2\nNs 3\nTr 1\n") ==
          std::vector<std::string>{"ignored: Ns (line 2), d (line 4), illum (line 5), Tr (line 9)"});
    CHECK(warnings_of("Ka 1 1 1\nnewmtl a\nd -halo 1\nbump b.png\nmap_Ks c.png\n") ==
          std::vector<std::string>{
              "ignored: Ka before the first newmtl (line 1), d (line 3), bump (line 4), map_Ks (line 5)"});
    const MtlFile mtl = parse_mtl(
        "newmtl a\nmap_Kd -s 2 2 2 -o 0.5 0 -bm 3 -clamp on my brick.png\nnewmtl b\nmap_Kd -s 4 2.png\n"
        "newmtl c\nmap_Kd -mm 0 1 \tc.png\r\nnewmtl d\nmap_Kd\nnewmtl e\nmap_Kd -x.png\n",
        "a.mtl");
    REQUIRE(mtl.materials.size() == 5);
    CHECK(mtl.materials[0].texture == "my brick.png");
    CHECK(mtl.materials[1].texture == "2.png");
    CHECK(mtl.materials[2].texture == "c.png");
    CHECK(mtl.materials[3].texture.empty());
    CHECK(mtl.materials[4].texture == "-x.png");
    CHECK(mtl.warnings == std::vector<std::string>{
                              "ignored: map_Kd -s (line 2), map_Kd -o (line 2), map_Kd -bm (line 2), map_Kd "
                              "-clamp (line 2), map_Kd -mm (line 6), map_Kd without a picture (line 8)"});
}

TEST_CASE("what an MTL leaves out reaches the scene's warnings", "[scene]") {
    const std::string folder = scratch_dir("scene_mtl_warnings"), file = folder + "/room.json";
    std::ofstream(folder + "/a.obj") << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
    std::ofstream(folder + "/a.mtl") << "newmtl a\nd 0.5\n";
    const Scene scene = load_text(kRoom, {{"/meshes/2", R"({"role":"object","file":"a.obj"})"}}, file);
    const std::string wanted = file + ": /meshes/2/file: " + folder + "/a.mtl: ignored: d (line 2)";
    CHECK(std::count(scene.warnings.begin(), scene.warnings.end(), wanted) == 1);
}

TEST_CASE("what is wrong in an MTL comes with its line", "[scene][bad-input]") {
    CHECK(mtl_error("newmtl a\nKd 1 1\n") == "a.mtl: line 2: 'Kd' needs 3 numbers, found 2");
    CHECK(mtl_error("newmtl a\nKd\n") == "a.mtl: line 2: 'Kd' needs 3 numbers, found 0");
    CHECK(mtl_error("newmtl a\n\nKd 1 1 red\n") ==
          "a.mtl: line 3: the Kd of material 'a': 'red' is no number");
    CHECK(mtl_error("newmtl a\nKd xyz 1 1 1\n") ==
          "a.mtl: line 2: the Kd of material 'a': 'xyz' is no number");
    for (const char* value : {"nan", "-1", "inf", "1e31"})
        CHECK(mtl_error(std::string("newmtl a b\nKd 0 0 ") + value + "\n") ==
              "a.mtl: line 2: the Kd of material 'a b' is no colour");
    CHECK(mtl_error("newmtl a\nmap_Kd -s\n") == "a.mtl: line 2: '-s' of map_Kd needs a value");
}

TEST_CASE("two readers agree on random materials", "[scene][oracle][law]") {
    std::mt19937 random(31);
    std::uniform_real_distribution<double> share(0, 1);
    std::size_t textures = 0;
    for (int round = 0; round < 300; ++round) {
        std::string all;
        std::vector<tinyobj::material_t> expected;
        for (unsigned i = random() % 5; i > 0; --i) {
            std::ostringstream text;
            text << "newmtl m" << i << "\nNs 3\n";
            if (random() % 4 != 0)
                text << "Kd " << share(random) << " " << std::pow(10, -9 * share(random)) << " 1\n";
            if (random() % 3 == 0) text << "illum 2\n";
            if (random() % 2 == 0)
                text << "map_Kd " << (random() % 2 == 0 ? "-s 1 2 3 -clamp on " : "") << "p" << i << ".png\n";
            all += text.str();
            // One at a time: it takes a Kd for that of all later materials too.
            std::map<std::string, int> index_of_name;
            std::istringstream stream(text.str());
            std::string warnings, errors;
            tinyobj::LoadMtl(&index_of_name, &expected, &stream, &warnings, &errors);
        }
        const MtlFile mtl = parse_mtl(all, "a.mtl");
        REQUIRE(mtl.materials.size() == expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) {
            CHECK(mtl.materials[i].name == expected[i].name);
            CHECK(mtl.materials[i].texture == expected[i].diffuse_texname);
            textures += mtl.materials[i].texture.empty() ? 0 : 1;
            for (int k = 0; k < 3; ++k)
                CHECK(std::abs(mtl.materials[i].diffuse[k] - expected[i].diffuse[k]) < 1e-12);
        }
    }
    CHECK(textures > 100);
}
