// Which extensions of glTF are known.
#include <set>
#include <string>

#include <tiny_gltf.h>

#include "scene/formats/gltf_parts.h"

namespace trilens {

void check_gltf_extensions(GltfSource& source) {
    static const std::set<std::string> known = {"KHR_materials_unlit",
                                                "KHR_mesh_quantization",
                                                "KHR_texture_transform",
                                                "KHR_lights_punctual",
                                                "KHR_materials_ior",
                                                "KHR_materials_transmission",
                                                "KHR_materials_volume",
                                                "KHR_materials_specular",
                                                "KHR_materials_dispersion",
                                                "EXT_texture_webp",
                                                "KHR_materials_emissive_strength"};
    for (const std::string& name : source.model.extensionsRequired)
        if (known.count(name) == 0)
            source.fail("/extensionsRequired", "the extension '" + name + "' is required but not supported");
    for (const std::string& name : source.model.extensionsUsed)
        if (known.count(name) == 0) source.warn("the extension '" + name + "' is ignored");
}

}  // namespace trilens
