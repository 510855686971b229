// Materials of OBJ files: THE door to tinyobjloader.
#include <map>
#include <sstream>

#ifndef TINYOBJLOADER_USE_DOUBLE  // some packages define it for their users
#define TINYOBJLOADER_USE_DOUBLE
#endif
#include <tiny_obj_loader.h>

#include "base/error.h"
#include "scene/obj.h"

namespace trilens {

std::vector<MtlMaterial> parse_mtl(const std::string& text, const std::string& file) {
    std::map<std::string, int> index_of_name;
    std::vector<tinyobj::material_t> parsed;
    std::istringstream stream(text);
    std::string warnings, errors;
    tinyobj::LoadMtl(&index_of_name, &parsed, &stream, &warnings, &errors);

    std::vector<MtlMaterial> materials;
    for (const tinyobj::material_t& material : parsed) {
        const Vec3 diffuse(material.diffuse[0], material.diffuse[1], material.diffuse[2]);
        for (int k = 0; k < 3; ++k)
            if (!(diffuse[k] >= 0 && diffuse[k] <= kLargestCoordinate))
                throw InputError(file, "", "the Kd of material '" + material.name + "' is no colour");
        materials.push_back({material.name, diffuse, material.diffuse_texname});
    }
    return materials;
}

}  // namespace trilens
