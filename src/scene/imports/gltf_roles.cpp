#include "scene/imports/gltf_roles.h"

#include <fnmatch.h>

#include <algorithm>

#include "base/util/error.h"
#include "base/util/names.h"

namespace trilens {
namespace {

/// The material of a perfect mirror, or of clear glass.
bool is_optical(const Json& material) {
    if (material.value("roughnessFactor", 0.0) != 0 || material.contains("metallicRoughnessTexture") ||
        material.contains("transmissionTexture") || material.value("unlit", false))
        return false;
    const double metallic = material.value("metallicFactor", 0.0),
                 transmission = material.value("transmissionFactor", 0.0);
    return (metallic == 1) != (transmission == 1) && (metallic == 1 || metallic == 0);
}

/// extras.trilens of a part of the file; null where there is none.
Json hints_of(const Json& extras, const std::string& file, const std::string& place) {
    if (!extras.is_object() || !extras.contains("trilens")) return nullptr;
    Json hints = extras.at("trilens");
    if (hints.is_boolean()) return {{"role", hints.get<bool>() ? "optic" : "object"}};
    if (!hints.is_object())
        throw InputError(file, place + "/extras/trilens",
                         "is neither true, false nor an object of a mesh's keys, but " + describe(hints));
    // A word of its own, since glTF's users know the schemes by these names.
    if (hints.contains("subdivision")) {
        const Json& scheme = hints.at("subdivision");
        hints["subdivisionScheme"] = scheme == "catmull-clark" ? Json("catmullClark") : scheme;
        hints.erase("subdivision");
    }
    if (hints.contains("subdivisionScheme")) {
        const Json& scheme = hints.at("subdivisionScheme");
        if (scheme != "catmullClark" && scheme != "loop" && scheme != "bilinear" && scheme != "none")
            throw InputError(file, place + "/extras/trilens/subdivision",
                             describe(scheme) + " is neither catmull-clark, loop, bilinear nor none");
    }
    return hints;
}

}  // namespace

bool is_open(const Json& material) {
    if (!material.contains("alphaMode")) return false;
    const bool has_picture = material.contains("baseColorTexture");
    const double factor = material.value("alphaFactor", 1.0);
    if (material.at("alphaMode") == "blend") return has_picture || factor < 1;
    const double cutoff = material.value("alphaCutoff", 0.5);
    return cutoff > 0 && (has_picture || factor < cutoff);
}

GltfRoles::GltfRoles(const GltfModel& model, const std::string& file,
                     const std::vector<std::string>& patterns)
    : model_(model), file_(file), patterns_(patterns), matched_(patterns.size(), 0) {}

std::string GltfRoles::node_name(int index) const {
    const GltfNode& node = model_.nodes[static_cast<std::size_t>(index)];
    if (!node.name.empty()) return node.name;
    const std::string& mesh = model_.meshes[static_cast<std::size_t>(node.mesh)].name;
    return mesh.empty() ? "node" + std::to_string(index) : mesh;
}

GltfRole GltfRoles::role_of(const GltfUse& use, const std::string& material_name) {
    GltfRole role;
    const GltfNode& node = model_.nodes[static_cast<std::size_t>(use.node)];
    const std::string& mesh_name = model_.meshes[static_cast<std::size_t>(node.mesh)].name;
    names_.push_back(use.name);
    const Json* material =
        use.material < 0 ? nullptr : &model_.materials[static_cast<std::size_t>(use.material)].written;
    const bool is_clear = material && is_optical(*material),
               is_mirror = is_clear && material->value("metallicFactor", 0.0) == 1;
    role.is_optic = is_clear && !is_open(*material);
    for (std::size_t k = 0; k < patterns_.size(); ++k)
        for (const std::string& name : {use.name, node_name(use.node), mesh_name, material_name})
            if (!name.empty() && fnmatch(patterns_[k].c_str(), name.c_str(), 0) == 0)
                role.is_optic = (matched_[k] = 1) != 0;
    // From what many share to what is its own.
    const auto add = [&](const Json& extras, const char* kind, int index) {
        const Json hints = hints_of(extras, file_, std::string(kind) + std::to_string(index));
        if (hints.is_object()) role.changes.merge_patch(hints);
    };
    if (use.material >= 0)
        add(model_.materials[static_cast<std::size_t>(use.material)].extras, "/materials/", use.material);
    add(model_.meshes[static_cast<std::size_t>(node.mesh)].extras, "/meshes/", node.mesh);
    add(node.extras, "/nodes/", use.node);
    if (role.changes.contains("role")) {
        role.is_optic = role.changes.at("role") == "optic";
    } else if (role.changes.contains("subdivisionScheme")) {
        role.is_optic = true;  // only optics are subdivided
    }
    role.is_open_mirror = is_mirror && !role.is_optic && !role.changes.contains("role");
    // Cages have few faces, on which facets lie well.
    if (role.changes.value("subdivisionScheme", Json("none")) != "none") {
        Json usual{{"grid", "surface"}, {"resolution", 8}};
        usual.merge_patch(role.changes);
        role.changes = std::move(usual);
    }
    return role;
}

std::vector<std::string> GltfRoles::unmatched() const {
    std::vector<std::string> left;
    for (std::size_t k = 0; k < patterns_.size(); ++k)
        if (!matched_[k]) left.push_back(patterns_[k]);
    return left;
}

std::vector<int> reached_nodes(const GltfModel& model) {
    std::vector<int> reached, stack(model.roots.rbegin(), model.roots.rend());
    while (!stack.empty()) {
        const int node = stack.back();
        stack.pop_back();
        reached.push_back(node);
        const std::vector<int>& children = model.nodes[static_cast<std::size_t>(node)].children;
        stack.insert(stack.end(), children.rbegin(), children.rend());
    }
    return reached;
}

GltfMoment moment_of(const GltfModel& model, const ImportOptions& options, const std::string& file) {
    GltfMoment moment;
    if (options.animation.empty()) {
        if (options.time && model.animations.empty())
            throw UsageError("--time: " + file + " has no animation");
        moment.animation = model.animations.empty() ? -1 : 0;
    } else {
        std::vector<std::string> names;
        for (std::size_t k = 0; k < model.animations.size(); ++k) {
            names.push_back(model.animations[k].name);
            if (names.back() == options.animation) moment.animation = static_cast<int>(k);
        }
        if (moment.animation < 0)
            throw UsageError("there is no animation \"" + options.animation + "\" in " + file +
                             suggestion(options.animation, names));
    }
    if (moment.animation >= 0) moment.time = options.time.value_or(0);
    return moment;
}

}  // namespace trilens
