#include "scene/imports/gltf_scene_materials.h"

#include <filesystem>
#include <system_error>

#include "base/description/material.h"
#include "base/util/error.h"
#include "base/util/names.h"
#include "scene/imports/gltf_roles.h"

namespace trilens {

std::string GltfSceneMaterials::name_of(int material) const {
    return material < 0 ? "default" : model_.materials[static_cast<std::size_t>(material)].material.name;
}

std::string GltfSceneMaterials::write(int index, bool of_optic) {
    std::string& name = name_of_use_[{index, of_optic}];
    if (!name.empty()) return name;
    Json material{{"name", "default"}, {"metallicFactor", 1}, {"roughnessFactor", 1}};
    if (index >= 0) material = model_.materials[static_cast<std::size_t>(index)].written;
    if (of_optic && make_optical(material)) material["name"] = name_of(index) + " (optic)";
    const double transmission = material.value("transmissionFactor", 0.0);
    if (!of_optic && transmission > 0 && transmission < 1)
        left_out_.note("transmissionFactor below 1", name_of(index));
    // An object's roughness of 0 is a glTF's polished surface, but a scene's matt one.
    if (!of_optic && !material.contains("unlit") && material.value("roughnessFactor", 1.0) == 0)
        material["brdf"] = trilens::name_of(Brdf::kMetallicRoughness);
    finish(material);
    std::string& known = name_of_[{index, material.dump()}];
    if (known.empty()) {
        // Those of the file have distinct names already, but not from those made here.
        material["name"] = known = distinct_.take(material.at("name").get<std::string>());
        written_.push_back(std::move(material));
    }
    return name = known;
}

/// An optic is a mirror or clear glass, rough to 0.3 at most, else perfect. Returns whether the material
/// was not.
bool GltfSceneMaterials::make_optical(Json& material) {
    const std::string name = material.at("name").get<std::string>();
    const bool glass = material.value("transmissionFactor", 0.0) > 0;
    const auto close = [&] {
        for (const char* key : {"alphaMode", "alphaFactor", "alphaCutoff", "doubleSided"})
            material.erase(key);
    };
    if (is_open(material))
        left_out_.note("alphaMode of an optic", name);
    else
        close();
    const Json before = material;
    close();
    material.erase("unlit");
    material["metallicFactor"] = glass ? 0 : 1;
    if (glass) material["transmissionFactor"] = 1;
    const double rough = before.value("roughnessFactor", 0.0);
    if (rough > kMostRoughness) material["roughnessFactor"] = 0;
    for (const char* key :
         {"baseColorTexture", "metallicRoughnessTexture", "transmissionTexture", "occlusionTexture"})
        if (material.erase(key) > 0) left_out_.note(std::string(key) + " of an optic", name);
    if (material == before) return false;
    const double metallic = before.value("metallicFactor", 0.0);
    if ((!glass && metallic != 1) || (glass && before.value("transmissionFactor", 0.0) != 1) ||
        rough > kMostRoughness)
        warnings_.push_back("material '" + name + "' is drawn as a perfect " + (glass ? "glass" : "mirror") +
                            " on an optic");
    return true;
}

/// Leaves what scenes know, and names its pictures as they do.
void GltfSceneMaterials::finish(Json& material) {
    const std::string name = material.at("name").get<std::string>();
    const Json before = material;
    for (const auto& [key, value] : before.items()) {
        if (params_.known.material.count(key) == 0) {
            left_out_.note(key, name);
            material.erase(key);
        } else if (material.at(key).is_object() && material.at(key).contains("image")) {
            material[key] = finish_texture(material.at(key), key, name);
        }
    }
}

Json GltfSceneMaterials::finish_texture(Json texture, const std::string& key, const std::string& material) {
    const GltfImage& image = model_.images[texture.at("image").get<std::size_t>()];
    check_picture(image, texture.at("image").get<std::size_t>());
    Json written{{"file", params_.written}};
    if (!image.file.empty()) {
        written["file"] = (std::filesystem::path(params_.written).parent_path() / image.uri).string();
        texture.erase("image");
    }
    written.update(texture);
    const Json before = written;
    for (const auto& [part, value] : before.items()) {
        if (params_.known.texture.count(part) > 0) continue;
        if (value != Json(1.0)) left_out_.note(key + "/" + part, material);
        written.erase(part);
    }
    return written.size() == 1 ? written.at("file") : written;
}

void GltfSceneMaterials::check_picture(const GltfImage& image, std::size_t index) const {
    const std::string place = "/images/" + std::to_string(index);
    std::error_code ignored;
    if (!image.file.empty() && !std::filesystem::exists(image.file, ignored))
        throw InputError(params_.file, place + "/uri", "the picture '" + image.file + "' does not exist");
    if (image.file.empty() && image.encoded.empty())
        throw InputError(params_.file, place, "the picture holds no data");
}

}  // namespace trilens
