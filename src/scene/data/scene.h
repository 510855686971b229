// The scene as plain data: what a scene file says, resolved, checked, and with nothing left to load.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/description/camera_description.h"
#include "base/description/light.h"
#include "base/description/marks.h"
#include "base/description/material.h"
#include "base/description/optic_description.h"
#include "base/image/height_grid.h"
#include "base/math/vec.h"
#include "base/raymesh/rational_patch.h"
#include "base/raymesh/triangle_scene.h"
#include "volume/volume_data.h"

namespace trilens {

/// What a scene may ask for at most.
inline constexpr long long kMostPixels = 1LL << 28;  // of a film
inline constexpr int kMostFilmSide = 32768;          // pixels
/// Coordinates beyond this are taken for mistakes: products of four still fit in a double.
inline constexpr double kLargestCoordinate = 1e30;
inline constexpr int kMaxSpp = 64;
inline constexpr int kMaxResolution = 1024;
inline constexpr int kMostDepth = 64;  // optic hits after the first
inline constexpr int kMostLightSamples = 4096;
inline constexpr int kMostRoughSamples = 65536;
inline constexpr double kMostRoughness = 0.3;  // of an optic
inline constexpr double kMostMaxError = 1000;  // pixels

/// How samples make a pixel's colour: see make_pixel_filter.
enum class FilterKind { kBox, kMitchell, kGaussian };

template <>
struct EnumNames<FilterKind> {
    static constexpr std::array kTable{NamedValue<FilterKind>{FilterKind::kBox, "box"},
                                       NamedValue<FilterKind>{FilterKind::kMitchell, "mitchell"},
                                       NamedValue<FilterKind>{FilterKind::kGaussian, "gaussian"}};
};

struct Film {
    int width = 640, height = 480;
    int spp = 1;  // S: S x S samples per pixel
    FilterKind filter = FilterKind::kBox;
};

enum class Role { kObject, kOptic };

template <>
struct EnumNames<Role> {
    static constexpr std::array kTable{NamedValue<Role>{Role::kObject, "object"},
                                       NamedValue<Role>{Role::kOptic, "optic"}};
};

/// How an optic's normals are overridden (thesis chapter 7: planes with perturbed or spherical normals).
struct NormalOverride {
    enum class Type { kSmooth, kSphere, kNoise };
    Type type = Type::kSmooth;
    Vec3 center{0};  // kSphere: normals point away from it
    int seed = 0;    // kNoise
    double amplitude = 0, scale = 1;
};

template <>
struct EnumNames<NormalOverride::Type> {
    static constexpr std::array kTable{
        NamedValue<NormalOverride::Type>{NormalOverride::Type::kSmooth, "smooth"},
        NamedValue<NormalOverride::Type>{NormalOverride::Type::kSphere, "sphere"},
        NamedValue<NormalOverride::Type>{NormalOverride::Type::kNoise, "noise"}};
};

/// The triangles of an object, ready to draw: world frame, polygons already cut into triangles, in face
/// order.
struct ObjectMesh {
    std::vector<Vec3> points;
    std::vector<IdTriple> triangles;
    // Per triangle and corner; either empty or one entry per triangle.
    std::vector<std::array<Vec2, 3>>
        uvs;  // v upward from the picture's bottom, as OBJ; glTF's is turned on reading
    std::vector<std::array<Vec2, 3>> second_uvs;  // of textures that ask for the second set
    std::vector<std::array<Vec4, 3>> colors;      // factors of the base colour and its alpha
    std::vector<std::array<Vec3, 3>> normals;     // unit
    // Of normal maps: xyz along growing u, v grows along w cross(normal, xyz); zero: the triangle's own.
    std::vector<std::array<Vec4, 3>> tangents;
    std::vector<Id> material;       // per triangle: index into Scene::materials
    std::vector<BakedLight> baked;  // either empty or one entry per triangle
};

/// What an object's triangles were made of, where heights are.
struct Terrain {
    std::string file;  // as it was opened
    std::shared_ptr<const HeightGrid> heights;
    std::size_t missing_heights = 0;  // samples around which there are holes
    std::size_t whole_triangles = 0;  // that the whole grid has, without holes
    // How far its triangles are, along its y and in its own frame, from those of the whole grid.
    double greatest_error = 0, rms_error = 0;
};

/// One entry of the file's `meshes`. Its index is the object id in images.
struct Mesh {
    std::string name;
    Role role = Role::kObject;
    Id material = kNone;  // index into Scene::materials; kNone where the triangles carry their own
    int resolution = 8;   // optic: N x N facets per quad face
    GridKind grid = GridKind::kSurface;     // optic
    CornerRays rays = CornerRays::kFitted;  // optic
    bool layered = true;                    // optic: those seen in it are layers by history
    std::size_t face_count = 0;             // polygons of the file, holes among them; 0 for a primitive
    NormalOverride normals;                 // optic
    int priority = 0;  // optic of glass: where bodies overlap the one of higher priority is inside

    // An object has `object`; an optic has `primitive`, `patches` or `cage` (world frame, transform applied).
    ObjectMesh object;
    std::optional<Primitive> primitive;
    Cage cage;
    std::vector<Vec2> cage_uvs;          // where normals are mapped: per entry of cage.face_vertex_indices
    std::vector<Vec4> cage_tangents;     // likewise, or empty: as ObjectMesh has them; zero: by cage_uvs
    bool maps_normals = false;           // optic: its material's normal map turns its normals
    bool of_patches = false;             // face_count patches
    std::vector<RationalPatch> patches;  // of an optic
    std::shared_ptr<const Terrain> terrain;  // object: how it was made, where of heights
};

/// Whether the optic's normals are those that the derivatives of its surface have.
inline bool has_own_normals(const Mesh& optic) {
    return optic.normals.type == NormalOverride::Type::kSmooth && !optic.maps_normals &&
           (optic.primitive || optic.cage.scheme != SubdivisionScheme::kUnsubdivided);
}

/// One entry of the file's `volumes`: what shines and absorbs within cells.
struct Volume {
    std::string name;
    std::string field;                     // the scalars' name in the file; empty: they have none
    std::shared_ptr<const TetMesh> cells;  // world frame, transform applied
    TransferFunction transfer;
};

struct RenderSettings {
    int max_depth = 8;  // optic hits after the first
    bool direct = true, reflect = true, refract = true;
    bool fresnel = true;
    double max_error = 0;    // pixels of displacement that facets are divided for; 0: only where they lie
    int rough_samples = 16;  // ways of light over rough optics: of each fragment that is projected
    int rough_truth_samples = 128;  // of each pixel that is traced
    bool certify = false;           // optics' facets are held to max_error by proof, which is then above 0
};

/// A file as it was when it was read.
struct FileRead {
    std::string path;  // absolute, otherwise as named: symbolic links and '..' still stand in it
    std::string hash;  // of its bytes: hash_text
};

struct Scene {
    std::string file;      // where it came from; empty: from memory
    std::string folder;    // absolute: where its relative paths start
    std::string label;     // what messages call it where it has no file; may be empty
    std::string resolved;  // the scene as JSON after --set, one line: goes into image headers
    Film film;
    std::vector<CameraDescription> cameras;  // at least one
    std::size_t own_camera = 0;              // used where none is asked for
    Background background;
    std::vector<Material> materials;
    std::vector<Mesh> meshes;
    std::vector<Light> lights;
    std::vector<Volume> volumes;
    std::vector<PointCloud> points;
    std::vector<Label> labels;
    RenderSettings render;
    std::vector<FileRead> files;  // every file that the scene was made of, each once, in order of reading
    std::vector<std::string> warnings;
};

/// What messages call a scene that has neither file nor label.
inline constexpr const char* kSceneLabel = "scene";

/// What messages call the scene: its file, else its label.
inline std::string scene_title(const Scene& scene) {
    return !scene.file.empty() ? scene.file : !scene.label.empty() ? scene.label : kSceneLabel;
}

}  // namespace trilens
