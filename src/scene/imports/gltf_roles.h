// What of a glTF becomes an optic: by name, by extras, or because its material is a perfect mirror or clear
// glass.
#pragma once

#include <string>
#include <vector>

#include "json/json.h"
#include "scene/data/scene_inputs.h"
#include "scene/formats/gltf.h"

namespace trilens {

/// Whether a material (GltfMaterial::written) may let through what lies behind: one that blends or is a mask,
/// and whose alpha is below 1, or the mask's cutoff; a picture of its base colour counts as one with such
/// alpha.
bool is_open(const Json& material);

/// One mesh of the scene: those primitives of a node that have one material.
struct GltfUse {
    int node = -1, material = -1;  // material: -1 for none
    std::string name;              // in the scene
};

/// `changes`: what extras.trilens says beside, as keys of a scene's mesh.
struct GltfRole {
    bool is_optic = false;
    bool is_open_mirror = false;  // an object for that alone that its material, a perfect mirror, is open
    Json changes = Json::object();
};

class GltfRoles {
  public:
    /// `patterns`: of names of meshes, nodes and materials, as shells have them: * and ? and [a-z].
    GltfRoles(const GltfModel& model, const std::string& file, const std::vector<std::string>& patterns);

    /// Extras say more than patterns, and these more than the material. Throws InputError for extras.trilens
    /// that are neither true, false nor an object.
    GltfRole role_of(const GltfUse& use, const std::string& material_name);

    /// The node's name; else its mesh's; else "node" and its number.
    std::string node_name(int node) const;

    /// Patterns that have matched nothing so far, and the names that there were.
    std::vector<std::string> unmatched() const;
    const std::vector<std::string>& names() const { return names_; }

  private:
    const GltfModel& model_;
    const std::string& file_;
    std::vector<std::string> patterns_, names_;
    std::vector<char> matched_;
};

/// The nodes of the default scene, parents first, children in order.
std::vector<int> reached_nodes(const GltfModel& model);

/// The moment that the options ask for; of a file with animations by default the start of the first, of one
/// without them the nodes as they stand. Throws UsageError for the name of an animation that there is not,
/// and for a time where there is none.
GltfMoment moment_of(const GltfModel& model, const ImportOptions& options, const std::string& file);

}  // namespace trilens
