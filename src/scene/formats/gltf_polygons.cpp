// Walks the nodes of a glTF and gathers their triangles in the world, posed: morph targets, then linear blend
// skinning.
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "base/util/check.h"
#include "base/util/error.h"
#include "scene/formats/gltf.h"

namespace trilens {
namespace {

/// Decodes each used material's picture once.
class Materials {
  public:
    Materials(const GltfModel& model, const TextureReader* textures) : model_(model), textures_(textures) {}

    /// The index in `gathered` of a material of the model.
    Id gather(int index, std::vector<Material>& gathered) {
        if (index < 0) return kNone;
        const auto [found, is_new] = gathered_.try_emplace(index, static_cast<Id>(gathered.size()));
        if (!is_new) return found->second;
        const GltfMaterial& material = model_.materials[static_cast<std::size_t>(index)];
        gathered.push_back(material.material);
        if (material.image >= 0) gathered.back().base_color_texture = picture(material.image);
        return found->second;
    }

  private:
    std::shared_ptr<const Texture> picture(int index) {
        const auto found = pictures_.find(index);
        if (found != pictures_.end()) return found->second;
        const GltfImage& image = model_.images[static_cast<std::size_t>(index)];
        std::shared_ptr<const Texture> texture;
        if (!image.file.empty()) {
            std::error_code ignored;
            if (!std::filesystem::exists(image.file, ignored))
                throw InputError(image.name, "", "the picture '" + image.file + "' does not exist");
            TRILENS_CHECK(textures_->from_file, "a scene with pictures needs a texture reader");
            texture = textures_->from_file(image.file);
        } else {
            if (image.encoded.empty()) throw InputError(image.name, "", "the picture holds no data");
            TRILENS_CHECK(textures_->from_memory, "a scene with pictures needs a texture reader");
            texture = textures_->from_memory(image.encoded, image.name);
        }
        return pictures_[index] = texture;
    }

    const GltfModel& model_;
    const TextureReader* textures_;
    std::map<int, Id> gathered_;
    std::map<int, std::shared_ptr<const Texture>> pictures_;
};

/// What a primitive's vertices have that moves.
struct Vertices {
    std::vector<Vec3> positions, normals;
    std::vector<Vec4> tangents;
    std::vector<Vec2> uvs, second_uvs;
    std::vector<Vec4> colors;
};

/// What `values` has none of stays.
template <typename T>
void move_by(double weight, const std::vector<T>& steps, std::vector<T>& values) {
    for (std::size_t i = 0; i < steps.size() && i < values.size(); ++i) values[i] += weight * steps[i];
}

/// Moved by morph targets.
void morph(const GltfPrimitive& primitive, const std::vector<double>& weights, Vertices& vertices) {
    for (std::size_t k = 0; k < primitive.targets.size() && k < weights.size(); ++k) {
        if (weights[k] == 0) continue;
        const GltfMorphTarget& target = primitive.targets[k];
        move_by(weights[k], target.positions, vertices.positions);
        move_by(weights[k], target.normals, vertices.normals);
        for (std::size_t i = 0; i < target.tangents.size() && i < vertices.tangents.size(); ++i)
            vertices.tangents[i] += Vec4(weights[k] * target.tangents[i], 0);
        move_by(weights[k], target.uvs, vertices.uvs);
        move_by(weights[k], target.second_uvs, vertices.second_uvs);
        move_by(weights[k], target.colors, vertices.colors);
    }
    for (Vec4& color : vertices.colors)
        color = glm::clamp(color, Vec4(0), Vec4(1));  // glTF 2.0, section 3.7.2.2
}

/// Linear blend skinning: per joint what carries the mesh's points into the world.
Transform blended(const GltfPrimitive& primitive, std::size_t vertex,
                  const std::vector<Transform>& of_joint) {
    Transform sum;
    sum.linear = Mat3(0);
    double all = 0;
    for (std::size_t k = vertex * primitive.influences; k < (vertex + 1) * primitive.influences; ++k) {
        const double weight = primitive.joint_weights[k];
        if (weight == 0) continue;
        const Transform& joint = of_joint[static_cast<std::size_t>(primitive.joints[k])];
        sum.linear += weight * joint.linear;
        sum.translation += weight * joint.translation;
        all += weight;
    }
    if (!(all > 0)) return of_joint.empty() ? Transform() : of_joint.front();
    sum.linear /= all;
    sum.translation /= all;
    return sum;
}

/// Appends triangles whose points and normals are in the world.
class Appender {
  public:
    Appender(const GltfModel& model, const GltfPose& pose, PolygonMesh& mesh)
        : model_(model), pose_(pose), mesh_(mesh) {}

    void append(int node, const GltfPrimitive& primitive, Id material) {
        place_vertices(node, primitive);
        const auto base = static_cast<int>(mesh_.cage.points.size());
        mesh_.cage.points.insert(mesh_.cage.points.end(), now_.positions.begin(), now_.positions.end());
        // What has no second set takes its first for it.
        const bool has_second = !now_.second_uvs.empty() || !mesh_.second_uvs.empty();
        if (has_second && mesh_.second_uvs.empty()) mesh_.second_uvs = mesh_.uvs;
        const bool has_colors = !now_.colors.empty() || !mesh_.colors.empty();
        if (has_colors) mesh_.colors.resize(mesh_.cage.face_vertex_indices.size(), Vec4(1));
        const bool has_tangents = !now_.tangents.empty() || !mesh_.tangents.empty();
        if (has_tangents) mesh_.tangents.resize(mesh_.cage.face_vertex_indices.size(), Vec4(0));
        for (const IdTriple& triangle : primitive.triangles) {
            IdTriple corners = triangle;
            if (mirrored_) std::swap(corners[1], corners[2]);
            mesh_.cage.face_vertex_counts.push_back(3);
            mesh_.face_material.push_back(material);
            for (const Id vertex : corners) {
                mesh_.cage.face_vertex_indices.push_back(base + static_cast<int>(vertex));
                const Vec2 uv = now_.uvs.empty() ? Vec2(0, 1) : now_.uvs[vertex];
                mesh_.uvs.push_back({uv.x, 1 - uv.y});
                if (has_second) {
                    const Vec2 second = now_.second_uvs.empty() ? uv : now_.second_uvs[vertex];
                    mesh_.second_uvs.push_back({second.x, 1 - second.y});
                }
                if (has_colors) mesh_.colors.push_back(now_.colors.empty() ? Vec4(1) : now_.colors[vertex]);
                mesh_.normals.push_back(now_.normals.empty() ? Vec3(0) : now_.normals[vertex]);
                if (has_tangents)
                    mesh_.tangents.push_back(now_.tangents.empty() ? Vec4(0) : now_.tangents[vertex]);
            }
        }
    }

  private:
    void place_vertices(int node, const GltfPrimitive& primitive) {
        const auto index = static_cast<std::size_t>(node);
        now_ = {primitive.positions, primitive.normals,    primitive.tangents,
                primitive.uvs,       primitive.second_uvs, primitive.colors};
        morph(primitive, pose_.weights[index], now_);
        const int skin = model_.nodes[index].skin;
        if (skin >= 0 && primitive.influences > 0)
            return bend(model_.skins[static_cast<std::size_t>(skin)], primitive);
        const Transform& world = pose_.world_from_node[index];
        mirrored_ = mirrors(world);
        const Mat3 turn = normal_map(world);
        for (Vec3& position : now_.positions) position = map_point(world, position);
        for (Vec3& normal : now_.normals) normal = normalize_or_zero(turn * normalize_or_zero(normal));
        for (Vec4& tangent : now_.tangents) tangent = map_tangent(world, tangent);
    }

    /// A skinned mesh stands where its joints are, wherever its node is (glTF 2.0, section 3.7.3.3).
    void bend(const GltfSkin& skin, const GltfPrimitive& primitive) {
        std::vector<Transform> of_joint;
        for (std::size_t j = 0; j < skin.joints.size(); ++j)
            of_joint.push_back(compose(pose_.world_from_node[static_cast<std::size_t>(skin.joints[j])],
                                       skin.joint_from_mesh[j]));
        mirrored_ = !of_joint.empty() && mirrors(of_joint.front());
        std::vector<Vec3>&positions = now_.positions, &normals = now_.normals;
        std::vector<Vec4>& tangents = now_.tangents;
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const Transform at = blended(primitive, i, of_joint);
            positions[i] = map_point(at, positions[i]);
            if (i < normals.size())
                normals[i] = normalize_or_zero(normal_map(at) * normalize_or_zero(normals[i]));
            if (i < tangents.size()) tangents[i] = map_tangent(at, tangents[i]);
        }
    }

    const GltfModel& model_;
    const GltfPose& pose_;
    PolygonMesh& mesh_;
    Vertices now_;
    bool mirrored_ = false;
};

/// The default scene's nodes that have a mesh, depth first.
std::vector<int> nodes_with_meshes(const GltfModel& model) {
    std::vector<int> found, stack(model.roots.rbegin(), model.roots.rend());
    while (!stack.empty()) {
        const int node = stack.back();
        stack.pop_back();
        const GltfNode& here = model.nodes[static_cast<std::size_t>(node)];
        if (here.mesh >= 0) found.push_back(node);
        stack.insert(stack.end(), here.children.rbegin(), here.children.rend());
    }
    return found;
}

}  // namespace

PolygonMesh polygons_of_gltf(const GltfModel& model, const std::string& file, const TextureReader* textures,
                             const GltfPart& part) {
    PolygonMesh mesh;
    mesh.is_triangle_soup = true;
    Materials materials(model, textures);
    const GltfPose pose = pose_gltf(model, part.moment);
    Appender appender(model, pose, mesh);
    const auto is_asked = [&](std::size_t primitive) {
        return part.parts.empty() || std::find(part.parts.begin(), part.parts.end(),
                                               static_cast<int>(primitive)) != part.parts.end();
    };
    for (const int node : part.node < 0 ? nodes_with_meshes(model) : std::vector<int>{part.node}) {
        const int index = model.nodes[static_cast<std::size_t>(node)].mesh;
        if (index < 0) continue;
        const std::vector<GltfPrimitive>& all = model.meshes[static_cast<std::size_t>(index)].primitives;
        for (std::size_t k = 0; k < all.size(); ++k)
            if (is_asked(k))
                appender.append(node, all[k],
                                textures ? materials.gather(all[k].material, mesh.materials) : kNone);
    }
    if (mesh.cage.face_vertex_counts.empty())
        throw InputError(
            file, part.node < 0 ? "" : "/nodes/" + std::to_string(part.node),
            part.node < 0 ? "no triangles in the default scene of this glTF" : "has no triangles");
    return mesh;
}

PolygonMesh polygons_of_gltf(const GltfModel& model, const std::string& file, const TextureReader* textures) {
    return polygons_of_gltf(model, file, textures, GltfPart());
}

}  // namespace trilens
