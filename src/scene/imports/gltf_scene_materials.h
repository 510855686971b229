// Materials of a glTF in the scene that stands for it: as they are, and as optics need them.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "json/json.h"
#include "scene/formats/gltf.h"
#include "scene/imports/gltf_scene.h"
#include "scene/imports/gltf_words.h"

namespace trilens {

class GltfSceneMaterials {
  public:
    /// All three must outlive it. What scenes lack is noted in `left_out`.
    GltfSceneMaterials(const GltfModel& model, const GltfSceneParams& params, LeftOut& left_out)
        : model_(model), params_(params), left_out_(left_out) {}

    /// The name of a material of the file, "default" of none (negative).
    std::string name_of(int material) const;

    /// Writes the material once as it is, and once as an optic needs it where that is another. Returns its
    /// name in the scene. Throws InputError where a picture is missing.
    std::string write(int material, bool of_optic);

    /// Those that were written, as an array, and what else is to be said of them.
    const Json& written() const { return written_; }
    const std::vector<std::string>& warnings() const { return warnings_; }

  private:
    bool make_optical(Json& material);
    void finish(Json& material);
    Json finish_texture(Json texture, const std::string& key, const std::string& material);
    void check_picture(const GltfImage& image, std::size_t index) const;

    const GltfModel& model_;
    const GltfSceneParams& params_;
    LeftOut& left_out_;
    Json written_ = Json::array();
    std::vector<std::string> warnings_;
    DistinctNames distinct_;
    std::map<std::pair<int, bool>, std::string> name_of_use_;     // by material, and whether of an optic
    std::map<std::pair<int, std::string>, std::string> name_of_;  // by material, and what it became
};

}  // namespace trilens
