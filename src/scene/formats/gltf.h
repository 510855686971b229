// A glTF or GLB file as plain data: meshes, materials, nodes, cameras, lights, skins and animations; its
// poses, and the polygons of its nodes.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "json/json.h"
#include "scene/data/polygons.h"
#include "scene/data/scene_inputs.h"

namespace trilens {

/// glTF has radians, scenes have degrees.
inline constexpr double kDegreesPerRadian = 180 / 3.14159265358979323846;

/// What trilens takes from a glTF material.
struct GltfMaterial {
    Material material;  // without its texture
    int image = -1;     // base colour picture: index into GltfModel::images, or -1
    /// As a scene's material, with every key that glTF has for it, those too that scenes do not know, and
    /// keys that say what else scenes lack; its pictures are {"image": index into GltfModel::images, "wrapS",
    /// "wrapT", "texCoord", "transform"}, and such keys.
    Json written;
    Json extras;  // null: none
};

/// A picture named by a glTF: a file, or its encoded bytes.
struct GltfImage {
    std::string file;  // resolved path; empty: `encoded` holds
    std::string uri;   // of a file: as a path from the glTF's folder
    std::vector<unsigned char> encoded;
    std::string name;  // for messages
};

/// How far a morph target moves a primitive's vertices; empty: not at all.
struct GltfMorphTarget {
    std::vector<Vec3> positions, normals, tangents;
    std::vector<Vec2> uvs, second_uvs;
    std::vector<Vec4> colors;
};

/// One primitive of a mesh with triangles, attributes per vertex.
struct GltfPrimitive {
    std::vector<Vec3> positions;
    std::vector<Vec3> normals;     // empty, or one per position
    std::vector<Vec4> tangents;    // empty, or one per position: along growing u, w 1 or -1
    std::vector<Vec2> uvs;         // empty, or one per position; v downward as in glTF
    std::vector<Vec2> second_uvs;  // TEXCOORD_1, likewise
    std::vector<Vec4> colors;      // empty, or one per position: linear, red, green, blue, alpha
    std::vector<IdTriple> triangles;
    int material = -1;
    std::vector<GltfMorphTarget> targets;
    // Of a skin: `influences` joints with their weights per position; the joints are places in the skin's
    // list.
    std::size_t influences = 0;
    std::vector<int> joints;
    std::vector<double> joint_weights;
};

struct GltfMesh {
    std::string name;
    std::vector<GltfPrimitive> primitives;
    std::vector<int>
        primitive_of;             // per entry of `primitives`: its index in the file, where some are skipped
    std::vector<double> weights;  // of its morph targets
    Json extras;
};

struct GltfNode {
    std::string name;
    // Either a matrix, or scale, then rotation (a quaternion of any length but 0), then translation.
    std::optional<Transform> matrix;
    Vec3 translation{0};
    Vec4 rotation{0, 0, 0, 1};
    Vec3 scale{1};
    int mesh = -1, skin = -1, camera = -1, light = -1;
    int parent = -1;
    std::vector<int> children;
    std::vector<double> weights;  // of its mesh's morph targets; empty: the mesh's own
    Json extras;
};

/// Per joint the node, and what carries the mesh's points into the joint's frame at rest.
struct GltfSkin {
    std::vector<int> joints;
    std::vector<Transform> joint_from_mesh;
};

struct GltfCamera {
    std::string name;
    bool perspective = true;
    double yfov = 0.8;             // perspective: radians
    double ymag = 1;               // orthographic
    std::optional<double> aspect;  // width by height
};

/// KHR_lights_punctual: shines along -Z of its node, from its origin.
struct GltfLight {
    std::string name, type;  // "directional", "point", "spot"
    Vec3 color{1};
    double intensity = 1;                   // lux of a directional one; else candela
    double inner_cone = 0, outer_cone = 0;  // spot: radians from the axis
    double range = 0;                       // 0: it reaches everywhere
};

/// One animated property of a node.
struct GltfChannel {
    enum class Property { kTranslation, kRotation, kScale, kWeights };
    enum class Interpolation { kLinear, kStep, kCubicSpline };
    int node = -1;
    Property property = Property::kTranslation;
    Interpolation interpolation = Interpolation::kLinear;
    std::vector<double> times;   // seconds, ascending; at least one
    std::vector<double> values;  // `width` numbers per time; of a cubic spline three times as many
    std::size_t width = 3;
};

struct GltfAnimation {
    std::string name;
    std::vector<GltfChannel> channels;
};

/// A glTF file as plain data; indices are in range, and the nodes are trees.
struct GltfModel {
    std::vector<GltfMaterial> materials;
    std::vector<GltfImage> images;
    std::vector<std::string> buffer_files;  // resolved paths of the buffers that are files of their own
    std::vector<GltfMesh> meshes;
    std::vector<GltfNode> nodes;
    std::vector<GltfSkin> skins;
    std::vector<GltfCamera> cameras;
    std::vector<GltfLight> lights;
    std::vector<GltfAnimation> animations;
    std::vector<int> roots;  // nodes of the default scene
    std::vector<std::string> warnings;
    std::vector<std::string> material_warnings;  // for whoever takes its materials
};

/// A moment of one of its animations; none: the nodes as they stand in the file.
struct GltfMoment {
    int animation = -1;
    double time = 0;  // seconds; held before the first key and after the last
};

/// Where its nodes are, and their morph targets' weights.
struct GltfPose {
    std::vector<Transform> world_from_node;
    std::vector<std::vector<double>> weights;  // per node; empty: none
};

/// Linear, step and cubic spline keys; rotations by the shorter great arc (glTF 2.0, appendix C).
GltfPose pose_gltf(const GltfModel& model, const GltfMoment& moment);

/// Whether the animation moves the node, the mesh's shape there, or anything that it hangs on.
bool is_animated(const GltfModel& model, int animation, int node);

/// What of a glTF becomes polygons: the default scene with all its nodes, or one node's mesh, and of that all
/// primitives or some.
struct GltfPart {
    int node = -1;           // -1: all of the default scene
    std::vector<int> parts;  // entries of GltfMesh::primitives; empty: all
    GltfMoment moment;
};

/// The mesh's points, normals, tangents, uvs and colours as morph targets and skin have them, in the world.
PolygonMesh polygons_of_gltf(const GltfModel& model, const std::string& file, const TextureReader* textures,
                             const GltfPart& part);

/// Reads a .gltf or .glb file (tinygltf). Lists, strips and fans of triangles; indexed or not; sparse
/// accessors; skins, morph targets, animations, cameras, KHR_lights_punctual, KHR_mesh_quantization,
/// EXT_mesh_gpu_instancing, KHR_texture_transform, EXT_texture_webp and the extensions of materials that
/// scenes have. What is left out (points, lines, further extensions) is in `warnings`. Throws
/// InputError(file, place in the glTF) for anything malformed, for nodes that form no trees, and for required
/// extensions that are not known (KHR_draco_mesh_compression among them).
GltfModel read_gltf(const std::string& file);

/// The default scene as one mesh in the frame of the file: nodes depth first, each mesh's primitives in
/// order, v turned upward; mirrored nodes keep their fronts. With `with_materials`, the pictures are decoded.
/// Throws InputError(file) for nodes that form no tree, and where there is no triangle.
PolygonMesh polygons_of_gltf(const GltfModel& model, const std::string& file, const TextureReader* textures);

}  // namespace trilens
