// What a scene holds, counted: the answer of `trilens scene info`.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/math/box.h"
#include "scene/data/scene.h"

namespace trilens {

/// Of an object that was made of heights.
struct TerrainInfo {
    int columns = 0, rows = 0;                 // samples
    std::size_t missing_heights = 0;           // samples around which there are holes
    std::size_t whole_triangles = 0;           // that the whole grid has, without holes
    double greatest_error = 0, rms_error = 0;  // of its triangles along its y, in its own frame
};

struct MeshInfo {
    std::string name;
    Role role = Role::kObject;
    std::string shape;     // "polygons", "terrain", "patches", "catmullClark", "loop", "bilinear", "sphere",
                           // "paraboloid", "cylinder", "cone", "plane"
    std::string material;  // its name; "inherit" where the triangles carry their own
    std::size_t points = 0;                           // 0 for a primitive
    std::size_t faces = 0;                            // 0 for a primitive
    std::size_t triangles = 0;                        // of an object
    std::size_t creases = 0, corners = 0, holes = 0;  // of a cage: crease edges, corner points, hole faces
    int resolution = 0;                               // of an optic
    Box bounds;  // an optic's: of its cage, or its patches' Bezier points, which hold its limit surface; of a
                 // primitive: exact or a little larger
    std::optional<TerrainInfo> terrain;
};

struct MaterialInfo {
    std::string name;
    std::string kind;  // "mirror", "glass", "unlit", "plain"
    bool has_texture = false;
    std::size_t meshes = 0;  // that name it or have a triangle of it
};

struct VolumeInfo {
    std::string name;
    std::string field;           // of its file; empty: it has no name
    std::size_t cells = 0;       // as the file has them
    std::size_t tetrahedra = 0;  // that they are cut into
    std::size_t points = 0;
    double least = 0, most = 0;  // of the scalar
    Box bounds;
};

struct CloudInfo {
    std::string name;
    std::size_t points = 0;
    bool has_colors = false;  // a colour for each
    Box bounds;
};

struct SceneInfo {
    std::vector<std::string> cameras;       // names
    std::vector<std::string> camera_types;  // "perspective", "fisheye", ...
    std::vector<MeshInfo> meshes;
    std::vector<MaterialInfo> materials;
    std::vector<VolumeInfo> volumes;
    std::vector<CloudInfo> points;
    std::vector<std::string> labels;  // texts
    std::size_t lights = 0;
    std::size_t objects = 0, optics = 0, triangles = 0;
    Box bounds;
};

/// Throws InputError as check_scene does.
SceneInfo make_scene_info(const Scene& scene);

}  // namespace trilens
