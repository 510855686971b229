#include "scene/imports/gltf_scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "base/description/material.h"
#include "base/math/box.h"
#include "base/util/error.h"
#include "base/util/names.h"
#include "scene/imports/gltf_roles.h"

namespace trilens {
namespace {

constexpr double kFramesPerSecond = 24;

Json array_of(const Vec3& v) {
    return {v.x, v.y, v.z};
}

/// Distinct names: the second "a" becomes "a.2".
class DistinctNames {
  public:
    std::string take(const std::string& wanted) {
        std::string name = wanted;
        for (int k = 2; !names_.insert(name).second; ++k) name = wanted + "." + std::to_string(k);
        return name;
    }

  private:
    std::set<std::string> names_;
};

/// The keys that scenes lack, told once each.
class LeftOut {
  public:
    void note(const std::string& what, const std::string& whose) {
        auto& [first, count] = found_[what];
        if (count++ == 0) first = whose;
    }
    void tell(std::vector<std::string>& warnings) const {
        for (const auto& [what, who] : found_)
            warnings.push_back(what + " is not drawn (of '" + who.first + "'" +
                               (who.second > 1 ? " and " + std::to_string(who.second - 1) + " more" : "") +
                               ")");
    }

  private:
    std::map<std::string, std::pair<std::string, int>> found_;
};

class SceneWriter {
  public:
    SceneWriter(const GltfModel& model, const GltfSceneParams& params)
        : model_(model), params_(params), roles_(model, params.file, params.options.optics) {
        moment_ = moment_of(model, params.options, params.file);
        pose_ = pose_gltf(model, moment_);
    }

    GltfScene write() {
        nodes_ = reached_nodes(model_);
        bounds_ = bounds_of();
        for (const int node : nodes_) write_meshes(node);
        for (const int node : nodes_) write_camera(node);
        for (const int node : nodes_) write_light(node);
        for (const std::string& pattern : roles_.unmatched())
            throw UsageError("--optic " + pattern + ": no mesh of " + params_.file + " has such a name" +
                             suggestion(pattern, roles_.names()));
        if (!tracks_.empty()) out_.scene["animation"] = {{"fps", kFramesPerSecond}, {"tracks", tracks_}};
        left_out_.tell(out_.warnings);
        return std::move(out_);
    }

  private:
    const GltfNode& node_at(int node) const { return model_.nodes[static_cast<std::size_t>(node)]; }
    bool moves(int node) const { return is_animated(model_, moment_.animation, node); }

    Box bounds_of() const {
        Box box;
        for (const int node : nodes_) {
            if (node_at(node).mesh < 0) continue;
            for (const auto& primitive :
                 model_.meshes[static_cast<std::size_t>(node_at(node).mesh)].primitives)
                for (const Vec3& point : primitive.positions)
                    box.include(map_point(pose_.world_from_node[static_cast<std::size_t>(node)], point));
        }
        return box;
    }

    /// One mesh per node and material, so that each has a name of its own to change it by.
    void write_meshes(int node) {
        const int index = node_at(node).mesh;
        if (index < 0) return;
        const GltfMesh& mesh = model_.meshes[static_cast<std::size_t>(index)];
        std::vector<std::pair<int, std::vector<int>>> groups;  // material, primitives
        for (std::size_t k = 0; k < mesh.primitives.size(); ++k) {
            const int material = mesh.primitives[k].material;
            auto group = std::find_if(groups.begin(), groups.end(),
                                      [&](const auto& one) { return one.first == material; });
            if (group == groups.end()) group = groups.insert(groups.end(), {material, {}});
            if (!mesh.primitives[k].triangles.empty()) group->second.push_back(static_cast<int>(k));
        }
        std::erase_if(groups, [](const auto& group) { return group.second.empty(); });
        for (const auto& [material, parts] : groups) {
            const std::string own = roles_.node_name(node);
            const std::string name =
                mesh_names_.take(groups.size() == 1 ? own : own + "." + material_name(material));
            write_mesh({node, material, name}, parts, parts.size() == mesh.primitives.size());
        }
    }

    void write_mesh(const GltfUse& use, const std::vector<int>& parts, bool is_all) {
        Json mesh{{"name", use.name}};
        const GltfRole role = roles_.role_of(use, material_name(use.material));
        mesh["role"] = role.is_optic ? "optic" : "object";
        mesh["material"] = write_material(use.material, role.is_optic);
        mesh["file"] = params_.written;
        mesh["node"] = use.node;
        if (!is_all) mesh["parts"] = parts;
        if (moves(use.node)) {
            mesh["clip"] = moment_.animation;
            mesh["time"] = moment_.time;
            add_track("/meshes/" + std::to_string(out_.scene["meshes"].size()) + "/time", time_keys());
        }
        if (role.is_optic) {
            mesh["subdivisionScheme"] = "none";
            mesh["resolution"] = resolution_for(use, parts);
        }
        mesh.merge_patch(role.changes);
        out_.scene["meshes"].push_back(std::move(mesh));
    }

    /// Facets per triangle: one, where there are many, and more where there are few.
    int resolution_for(const GltfUse& use, const std::vector<int>& parts) const {
        const int mesh = node_at(use.node).mesh;
        std::size_t triangles = 0;
        for (const int part : parts)
            triangles += model_.meshes[static_cast<std::size_t>(mesh)]
                             .primitives[static_cast<std::size_t>(part)]
                             .triangles.size();
        const double facets = kUsualFacets / static_cast<double>(std::max<std::size_t>(triangles, 1));
        return std::clamp(static_cast<int>(std::lround(std::sqrt(facets))), 1, 32);
    }

    std::string material_name(int material) const {
        return material < 0 ? "default" : model_.materials[static_cast<std::size_t>(material)].material.name;
    }

    /// Writes the material once as it is, and once as an optic needs it where that is another. Returns its
    /// name.
    std::string write_material(int index, bool of_optic) {
        Json material{{"name", "default"}, {"metallicFactor", 1}, {"roughnessFactor", 1}};
        if (index >= 0) material = model_.materials[static_cast<std::size_t>(index)].written;
        if (of_optic && make_optical(material)) material["name"] = material_name(index) + " (optic)";
        const std::pair<int, std::string> key{index, material.at("name").get<std::string>()};
        const auto known = material_names_.find(key);
        if (known != material_names_.end()) return known->second;
        // Those of the file have distinct names already, but not from those made here.
        const std::string name = distinct_materials_.take(key.second);
        material["name"] = name;
        // An object's roughness of 0 is a glTF's polished surface, but a scene's matt one.
        if (!of_optic && !material.contains("unlit") && material.value("roughnessFactor", 1.0) == 0)
            material["brdf"] = name_of(Brdf::kMetallicRoughness);
        finish_material(material);
        out_.scene["materials"].push_back(std::move(material));
        return material_names_[key] = name;
    }

    /// An optic is a mirror or clear glass, rough to 0.3 at most, else perfect. Returns whether the material
    /// was not.
    bool make_optical(Json& material) {
        const std::string name = material.at("name").get<std::string>();
        const bool glass = material.value("transmissionFactor", 0.0) > 0;
        const Json before = material;
        material.erase("unlit");
        material["metallicFactor"] = glass ? 0 : 1;
        if (glass) material["transmissionFactor"] = 1;
        const double rough = before.value("roughnessFactor", 0.0);
        if (rough > kMostRoughness) material["roughnessFactor"] = 0;
        for (const char* key :
             {"baseColorTexture", "metallicRoughnessTexture", "transmissionTexture", "occlusionTexture"})
            if (material.erase(key) > 0) left_out_.note(std::string(key) + " of an optic", name);
        for (const char* key : {"alphaMode", "alphaFactor", "alphaCutoff", "doubleSided"})
            material.erase(key);
        if (material == before) return false;
        const double metallic = before.value("metallicFactor", 0.0);
        if ((!glass && metallic != 1) || (glass && before.value("transmissionFactor", 0.0) != 1) ||
            rough > kMostRoughness)
            out_.warnings.push_back("material '" + name + "' is drawn as a perfect " +
                                    (glass ? "glass" : "mirror") + " on an optic");
        return true;
    }

    /// Leaves what scenes know, and names its pictures as they do.
    void finish_material(Json& material) {
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

    Json finish_texture(Json texture, const std::string& key, const std::string& material) {
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

    void check_picture(const GltfImage& image, std::size_t index) const {
        const std::string place = "/images/" + std::to_string(index);
        std::error_code ignored;
        if (!image.file.empty() && !std::filesystem::exists(image.file, ignored))
            throw InputError(params_.file, place + "/uri", "the picture '" + image.file + "' does not exist");
        if (image.file.empty() && image.encoded.empty())
            throw InputError(params_.file, place, "the picture holds no data");
    }

    // Cameras and lights: all that knows of their fields.

    Json look_at(const Transform& world) const {
        const Vec3 eye = world.translation, ahead = -normalize_or_zero(world.linear[2]);
        // As far as the middle of what there is, which a turntable turns about.
        const double to_middle = bounds_.empty() ? 1 : dot(0.5 * (bounds_.low + bounds_.high) - eye, ahead);
        const double distance = to_middle > 1e-6 ? to_middle : 1;
        return {{"eye", array_of(eye)},
                {"at", array_of(eye + distance * ahead)},
                {"up", array_of(normalize_or_zero(world.linear[1]))}};
    }

    void write_camera(int node) {
        if (node_at(node).camera < 0) return;
        const GltfCamera& camera = model_.cameras[static_cast<std::size_t>(node_at(node).camera)];
        const std::string wanted = !node_at(node).name.empty() ? node_at(node).name
                                   : !camera.name.empty()      ? camera.name
                                                          : "camera" + std::to_string(node_at(node).camera);
        Json written{{"name", camera_names_.take(wanted)},
                     {"type", camera.perspective ? "perspective" : "orthographic"}};
        if (camera.perspective)
            written["yfov"] = std::min(camera.yfov * kDegreesPerRadian, 179.0);
        else
            written["ymag"] = camera.ymag;
        written["lookAt"] = look_at(pose_.world_from_node[static_cast<std::size_t>(node)]);
        if (out_.scene["cameras"].empty() && camera.aspect && *camera.aspect > 0.05 && *camera.aspect < 20)
            out_.scene["film"] = {{"width", static_cast<int>(std::lround(480 * *camera.aspect))},
                                  {"height", 480}};
        const std::string place = "/cameras/" + std::to_string(out_.scene["cameras"].size()) + "/lookAt";
        out_.scene["cameras"].push_back(std::move(written));
        if (moves(node))
            add_tracks(node, place, {"/eye", "/at", "/up"}, [&](const Transform& world, Json& values) {
                const Json now = look_at(world);
                for (const char* key : {"eye", "at", "up"}) values.push_back(now.at(key));
            });
    }

    void write_light(int node) {
        if (node_at(node).light < 0) return;
        const GltfLight& light = model_.lights[static_cast<std::size_t>(node_at(node).light)];
        const std::string wanted = node_at(node).name.empty() ? light.name : node_at(node).name;
        std::string type = light.type;
        if (params_.known.light_types.count(type) == 0) {
            left_out_.note("the cone of a spot light", wanted);
            type = "point";
        }
        Json written{{"name", light_names_.take(wanted)},
                     {"type", type},
                     {"color", array_of(light.color)},
                     {"intensity", light.intensity}};
        if (light.range > 0) left_out_.note("the end of a light's range", wanted);
        const Transform& world = pose_.world_from_node[static_cast<std::size_t>(node)];
        const bool has_place = type != "directional", has_direction = type != "point";
        if (has_place) written["position"] = array_of(world.translation);
        if (has_direction) written["direction"] = array_of(direction_of(world));
        if (type == "spot") {
            written["innerConeAngle"] = light.inner_cone * kDegreesPerRadian;
            written["outerConeAngle"] = std::min(light.outer_cone * kDegreesPerRadian, 90.0);
        }
        written["shadows"] = true;
        const std::string place = "/lights/" + std::to_string(out_.scene["lights"].size());
        out_.scene["lights"].push_back(std::move(written));
        if (!moves(node)) return;
        std::vector<std::string> targets;
        if (has_place) targets.push_back("/position");
        if (has_direction) targets.push_back("/direction");
        add_tracks(node, place, targets, [&](const Transform& at, Json& values) {
            if (has_place) values.push_back(array_of(at.translation));
            if (has_direction) values.push_back(array_of(direction_of(at)));
        });
    }

    static Vec3 direction_of(const Transform& world) {
        const Vec3 along = -normalize_or_zero(world.linear[2]);
        return along == Vec3(0) ? Vec3(0, 0, -1) : along;
    }

    // Animation.

    struct Span {
        double first = 0, last = 0;  // seconds
    };
    Span span() const {
        Span span{1e300, -1e300};
        for (const GltfChannel& channel :
             model_.animations[static_cast<std::size_t>(moment_.animation)].channels) {
            span.first = std::min(span.first, channel.times.front());
            span.last = std::max(span.last, channel.times.back());
        }
        return span.first <= span.last ? span : Span();
    }

    static Json key(double time, Json value) {
        return {{"frame", time * kFramesPerSecond}, {"value", std::move(value)}};
    }

    void add_track(const std::string& target, Json keys) {
        tracks_.push_back({{"target", target}, {"keys", std::move(keys)}});
    }

    /// A mesh is posed by its file at any time, so that time itself is what its track has.
    Json time_keys() const {
        const Span whole = span();
        Json keys = Json::array({key(whole.first, whole.first)});
        if (whole.last > whole.first) keys.push_back(key(whole.last, whole.last));
        return keys;
    }

    /// Cameras and lights are sampled at each frame.
    template <class Values>
    void add_tracks(int node, const std::string& place, const std::vector<std::string>& targets,
                    const Values& values) {
        const Span whole = span();
        std::vector<Json> keys(targets.size(), Json::array());
        const double first = whole.first * kFramesPerSecond, last = whole.last * kFramesPerSecond;
        std::vector<double> frames{first};
        for (double frame = std::floor(first) + 1; frame < last && frames.size() < kMostKeys; ++frame)
            frames.push_back(frame);
        if (last > first) frames.push_back(last);
        for (const double frame : frames) {
            const GltfPose pose = pose_gltf(model_, {moment_.animation, frame / kFramesPerSecond});
            Json now = Json::array();
            values(pose.world_from_node[static_cast<std::size_t>(node)], now);
            for (std::size_t k = 0; k < targets.size(); ++k)
                keys[k].push_back({{"frame", frame}, {"value", now.at(k)}});
        }
        for (std::size_t k = 0; k < targets.size(); ++k) add_track(place + targets[k], std::move(keys[k]));
    }

    static constexpr std::size_t kMostKeys = 20'000;
    static constexpr double kUsualFacets = 4000;

    const GltfModel& model_;
    const GltfSceneParams& params_;
    GltfRoles roles_;
    GltfMoment moment_;
    GltfPose pose_;
    std::vector<int> nodes_;
    Box bounds_;
    GltfScene out_{{{"cameras", Json::array()},
                    {"materials", Json::array()},
                    {"meshes", Json::array()},
                    {"lights", Json::array()}},
                   {}};
    Json tracks_ = Json::array();
    DistinctNames mesh_names_, camera_names_, light_names_, distinct_materials_;
    std::map<std::pair<int, std::string>, std::string> material_names_;
    LeftOut left_out_;
};

}  // namespace

GltfScene scene_of_gltf(const GltfModel& model, const GltfSceneParams& params) {
    return SceneWriter(model, params).write();
}

}  // namespace trilens
