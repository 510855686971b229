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
          std::vector<std::string>{"ignored: d (line 4), Tr (line 9)"});
    CHECK(warnings_of("newmtl a\nillum 3\nbump -s 2 -bm 2 b.png\nmap_Kd -bm 1 c.png\n") ==
          std::vector<std::string>{"ignored: illum (line 2), bump -s (line 3), map_Kd -bm (line 4)"});
    CHECK(warnings_of("Ka 1 1 1\nnewmtl a\nd -halo 1\nbump\nmap_Ks c.png\n") ==
          std::vector<std::string>{
              "ignored: Ka before the first newmtl (line 1), d (line 3), bump without a picture (line 4), "
              "map_Ks (line 5)"});
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

TEST_CASE("an MTL's highlight and bumps become roughness, specular colour and normals", "[scene]") {
    const std::string folder = scratch_dir("scene_mtl_phong"), file = folder + "/room.json";
    std::ofstream(folder + "/a.obj") << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                                     << "usemtl shiny\nf 1 2 3\nusemtl dull\nf 1 2 3\nusemtl off\nf 1 2 3\n";
    std::ofstream(folder + "/a.mtl") << "newmtl shiny\nKs 0.5 0.25 1\nNs 30\nmap_Bump -bm 3 heights.png\n"
                                     << "newmtl dull\nNs 30\nnewmtl off\nKs 1 1 1\nillum 1\n";
    std::ofstream(folder + "/heights.png") << "a picture for the reader below";
    // Heights rise by 0.25 a texel to the right and by 0.5 a texel upward, but from edge to edge.
    const std::vector<SceneOverride> mesh = {{"/meshes/2", R"({"role":"object","file":"a.obj"})"}};
    TextureReader pictures;
    pictures.from_file = [](const std::string&) {
        auto texture = std::make_shared<Texture>();
        texture->width = texture->height = 3;
        for (int y = 0; y < 3; ++y)
            for (int x = 0; x < 3; ++x) {
                const double stored = 0.5 + 0.125 * x - 0.25 * y;  // of sRGB
                const double linear =
                    stored <= 0.04045 ? stored / 12.92 : std::pow((stored + 0.055) / 1.055, 2.4);
                for (int k = 0; k < 3; ++k) texture->rgb.push_back(static_cast<float>(linear));
            }
        return texture;
    };
    const Scene scene = load_scene_text(kRoom, file, mesh, pictures);
    const auto material = [&](const std::string& name) {
        for (const Material& one : scene.materials)
            if (one.name == "mesh2/" + name) return one;
        FAIL("no material " << name);
        return Material{};
    };
    const Material shiny = material("shiny");
    CHECK(!shiny.is_matt());
    CHECK(shiny.roughness_factor == Approx(0.5));  // (2 / 32)^(1/4)
    CHECK(shiny.specular_color_factor == Vec3(0.5, 0.25, 1));
    CHECK(shiny.normal_scale == 3);
    CHECK(material("dull").is_matt());
    CHECK(material("off").is_matt());
    const Texture& normals = *shiny.normal_texture.picture;
    REQUIRE(normals.rgb.size() == 27);
    const Vec3 middle = normalize(Vec3(-0.125, -0.25, 1));
    for (int k = 0; k < 3; ++k)
        CHECK(2 * normals.rgb[static_cast<std::size_t>(12 + k)] - 1 == Approx(middle[k]).margin(1e-5));
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
    CHECK(mtl_error("newmtl a\nKs 1 1\n") == "a.mtl: line 2: 'Ks' needs 3 numbers, found 2");
    for (const char* value : {"", " nan", " -1", " inf", " shiny"})
        CHECK(mtl_error(std::string("newmtl a\nNs") + value + "\n") ==
              "a.mtl: line 2: the Ns of material 'a' is no exponent");
    CHECK(mtl_error("newmtl a\nmap_Bump -bm deep b.png\n") ==
          "a.mtl: line 2: the -bm of material 'a': 'deep' is no number");
    CHECK(mtl_error("newmtl a\nbump -bm\n") == "a.mtl: line 2: '-bm' of bump needs a value");
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
            text << "newmtl m" << i << "\nNs " << 400 * share(random) << "\n";
            text << "Ks " << share(random) << " 0.5 " << share(random) << "\n";
            text << "bump -bm " << share(random) << " b" << i << ".png\n";
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
            for (int k = 0; k < 3; ++k) {
                CHECK(std::abs(mtl.materials[i].diffuse[k] - expected[i].diffuse[k]) < 1e-12);
                CHECK(std::abs(mtl.materials[i].specular[k] - expected[i].specular[k]) < 1e-12);
            }
            CHECK(std::abs(mtl.materials[i].exponent - expected[i].shininess) < 1e-9);
            CHECK(mtl.materials[i].bump == expected[i].bump_texname);
            CHECK(std::abs(mtl.materials[i].bump_scale - expected[i].bump_texopt.bump_multiplier) < 1e-9);
        }
    }
    CHECK(textures > 100);
}
