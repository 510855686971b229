// Materials of OBJ files: THE door to tinyobjloader.
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#ifndef TINYOBJLOADER_USE_DOUBLE  // some packages define it for their users
#define TINYOBJLOADER_USE_DOUBLE
#endif
#include <tiny_obj_loader.h>

#include "base/error.h"
#include "scene/obj.h"
#include "scene/words.h"

namespace trilens {
namespace {

/// An MTL text whose materials are called 0, 1, 2, ...: tinyobjloader's versions read names with spaces
/// differently.
struct NumberedMtl {
    std::string text;
    std::vector<std::string> names;
};

NumberedMtl number_materials(const std::string& text) {
    NumberedMtl numbered;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        const std::vector<std::string_view> words = split_words(line);
        if (!words.empty() && words[0] == "newmtl") {
            const std::string name = rest_of_line(line, words[0]);
            line = "newmtl " + std::to_string(numbered.names.size());
            numbered.names.push_back(name);
        }
        numbered.text += line + "\n";
    }
    return numbered;
}

}  // namespace

std::vector<MtlMaterial> parse_mtl(const std::string& text, const std::string& file) {
    std::map<std::string, int> index_of_name;
    std::vector<tinyobj::material_t> parsed;
    const NumberedMtl numbered = number_materials(text);
    std::istringstream stream(numbered.text);
    std::string warnings, errors;
    tinyobj::LoadMtl(&index_of_name, &parsed, &stream, &warnings, &errors);

    std::vector<MtlMaterial> materials;
    for (const tinyobj::material_t& material : parsed) {
        const std::string& name = numbered.names.at(std::stoul(material.name));
        const Vec3 diffuse(material.diffuse[0], material.diffuse[1], material.diffuse[2]);
        for (int k = 0; k < 3; ++k)
            if (!(diffuse[k] >= 0 && diffuse[k] <= kLargestCoordinate))
                throw InputError(file, "", "the Kd of material '" + name + "' is no colour");
        materials.push_back({name, diffuse, material.diffuse_texname});
    }
    return materials;
}

}  // namespace trilens
