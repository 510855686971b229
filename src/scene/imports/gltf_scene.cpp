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
#include "scene/imports/gltf_scene_materials.h"
#include "scene/imports/gltf_words.h"

namespace trilens {
namespace {

constexpr double kFramesPerSecond = 24;

Json array_of(const Vec3& v) {
    return {v.x, v.y, v.z};
}

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
        out_.scene["materials"] = materials_.written();
        out_.warnings = materials_.warnings();
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
                mesh_names_.take(groups.size() == 1 ? own : own + "." + materials_.name_of(material));
            write_mesh({node, material, name}, parts, parts.size() == mesh.primitives.size());
        }
    }

    void write_mesh(const GltfUse& use, const std::vector<int>& parts, bool is_all) {
        Json mesh{{"name", use.name}};
        const GltfRole role = roles_.role_of(use, materials_.name_of(use.material));
        mesh["role"] = role.is_optic ? "optic" : "object";
        mesh["material"] = materials_.write(use.material, role.is_optic);
        if (role.is_open_mirror)
            left_out_.note("what a mirror with alphaMode reflects", materials_.name_of(use.material));
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
    GltfScene out_{{{"cameras", Json::array()}, {"meshes", Json::array()}, {"lights", Json::array()}}, {}};
    Json tracks_ = Json::array();
    DistinctNames mesh_names_, camera_names_, light_names_;
    LeftOut left_out_;
    GltfSceneMaterials materials_{model_, params_, left_out_};
};

}  // namespace

GltfScene scene_of_gltf(const GltfModel& model, const GltfSceneParams& params) {
    return SceneWriter(model, params).write();
}

}  // namespace trilens
