// Walks the nodes of a glTF and gathers their triangles in the frame of the file.
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

void append_primitive(const GltfPrimitive& primitive, const Transform& transform, Id material,
                      PolygonMesh& mesh) {
    const auto base = static_cast<int>(mesh.cage.points.size());
    const Mat3 normals = normal_map(transform);
    for (const Vec3& position : primitive.positions)
        mesh.cage.points.push_back(map_point(transform, position));
    for (const IdTriple& triangle : primitive.triangles) {
        IdTriple corners = triangle;
        if (mirrors(transform)) std::swap(corners[1], corners[2]);
        mesh.cage.face_vertex_counts.push_back(3);
        mesh.face_material.push_back(material);
        for (const Id vertex : corners) {
            mesh.cage.face_vertex_indices.push_back(base + static_cast<int>(vertex));
            const Vec2 uv = primitive.uvs.empty() ? Vec2(0, 1) : primitive.uvs[vertex];
            mesh.uvs.push_back({uv.x, 1 - uv.y});
            mesh.normals.push_back(
                primitive.normals.empty()
                    ? Vec3(0)
                    : normalize_or_zero(normals * normalize_or_zero(primitive.normals[vertex])));
        }
    }
}

}  // namespace

PolygonMesh polygons_of_gltf(const GltfModel& model, const std::string& file, const TextureReader* textures) {
    struct Visit {
        int node;
        Transform parent;
    };
    PolygonMesh mesh;
    Materials materials(model, textures);
    std::vector<char> visited(model.nodes.size(), 0);
    std::vector<Visit> stack;
    for (auto root = model.roots.rbegin(); root != model.roots.rend(); ++root)
        stack.push_back({*root, Transform()});
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        const auto index = static_cast<std::size_t>(visit.node);
        if (visited[index])
            throw InputError(file, "/nodes/" + std::to_string(index),
                             "is reached twice: nodes must form a tree");
        visited[index] = 1;
        const GltfNode& node = model.nodes[index];
        const Transform transform = compose(visit.parent, node.parent_from_node);
        if (node.mesh >= 0)
            for (const GltfPrimitive& primitive : model.meshes[static_cast<std::size_t>(node.mesh)])
                append_primitive(primitive, transform,
                                 textures ? materials.gather(primitive.material, mesh.materials) : kNone,
                                 mesh);
        for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
            stack.push_back({*child, transform});
    }
    if (mesh.cage.face_vertex_counts.empty())
        throw InputError(file, "", "no triangles in the default scene of this glTF");
    return mesh;
}

}  // namespace trilens
