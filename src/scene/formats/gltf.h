// The polygons of a glTF or GLB file.
#pragma once

#include <string>
#include <vector>

#include "scene/data/polygons.h"
#include "scene/data/scene_inputs.h"

namespace trilens {

/// What trilens takes from a glTF material.
struct GltfMaterial {
    Material material;  // without its texture
    int image = -1;     // base colour picture: index into GltfModel::images, or -1
    int uv_set = 0;     // TEXCOORD_n that goes with it
};

/// A picture named by a glTF: a file, or its encoded bytes.
struct GltfImage {
    std::string file;  // resolved path; empty: `encoded` holds
    std::vector<unsigned char> encoded;
    std::string name;  // for messages
};

/// One primitive of a mesh with triangles, attributes per vertex.
struct GltfPrimitive {
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;  // empty, or one per position
    std::vector<Vec2> uvs;      // empty, or one per position; v downward as in glTF
    std::vector<IdTriple> triangles;
    int material = -1;
};

struct GltfNode {
    Transform parent_from_node;
    int mesh = -1;
    std::vector<int> children;
};

/// A glTF file as plain data; indices are in range.
struct GltfModel {
    std::vector<GltfMaterial> materials;
    std::vector<GltfImage> images;
    std::vector<std::string> buffer_files;  // resolved paths of the buffers that are files of their own
    std::vector<std::vector<GltfPrimitive>> meshes;
    std::vector<GltfNode> nodes;
    std::vector<int> roots;  // nodes of the default scene
    std::vector<std::string> warnings;
    std::vector<std::string> material_warnings;  // for whoever takes its materials
};

/// Reads a .gltf or .glb file (tinygltf). Lists, strips and fans of triangles; indexed or not; sparse
/// accessors; matrices and TRS; KHR_materials_unlit, KHR_mesh_quantization. What is left out (points, lines,
/// skins, morph targets, animation, cameras, lights, vertex colours, further extensions) is in `warnings`.
/// Throws InputError(file, place in the glTF) for anything malformed and for required extensions that are not
/// known (KHR_draco_mesh_compression among them).
GltfModel read_gltf(const std::string& file);

/// The default scene as one mesh in the frame of the file: nodes depth first, each mesh's primitives in
/// order, v turned upward; mirrored nodes keep their fronts. With `with_materials`, the pictures are decoded.
/// Throws InputError(file) for nodes that form no tree, and where there is no triangle.
PolygonMesh polygons_of_gltf(const GltfModel& model, const std::string& file, const TextureReader* textures);

}  // namespace trilens
