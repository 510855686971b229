// What the readers of a scene file's parts share: objects by name, and the tables of settings that the JSON
// Schema and the readers are made of.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "json/fields.h"
#include "json/json.h"
#include "scene/data/patches.h"
#include "scene/data/polygons.h"
#include "scene/data/primitive_mesh.h"
#include "scene/data/scene.h"
#include "scene/data/scene_inputs.h"
#include "scene/formats/gltf.h"
#include "scene/meshes/vertex_normals.h"
#include "terrain/thinning.h"

namespace trilens {

FileRead make_file_read(const std::string& path, std::string_view bytes);

/// One scene being read.
struct Reading {
    Reading(const std::string& named, const std::string& paths_start_here, const TextureReader& pictures);
    Reading(const Reading&) = delete;  // its texture reader holds its address
    Reading& operator=(const Reading&) = delete;

    const std::string& file;
    const std::string& folder;  // where its relative paths start
    TextureReader textures;     // the caller's; files that it reads are noted
    Scene scene;
    std::map<std::string, std::shared_ptr<const Texture>> texture_of_path;
    std::map<std::string, std::shared_ptr<const GltfModel>> gltf_of_path;
    FilmMoves film_moves;  // once all but the terrains that ask for them are read
    std::size_t named_materials =
        0;  // the scene file's own come first in scene.materials; those of files follow

    /// A path as the scene file writes it, relative to that file.
    std::string resolve(const std::string& path) const {
        return (std::filesystem::path(folder) / path).string();
    }

    /// The bytes of a file, which stands in scene.files from then on. Throws what read_required_file throws.
    std::string read_file(const std::string& path);
    /// Notes a file that someone else reads.
    void note_file(const std::string& path) { read_file(path); }

    void warn(const std::string& place, const std::string& message) {
        scene.warnings.push_back(file + ": " + one_line((place.empty() ? "" : place + ": ") + message));
    }
};

/// The keys of a mesh that is a terrain.
struct TerrainSettings {
    std::string heights;
    Vec3 size{1};
    double no_data = 0;
    double height_error = 0, tolerance = 0;
    ThinningRule thinning = ThinningRule::kBound;
};

/// One entry of a mesh's `patches`, but for its points.
struct WrittenPatch {
    PatchKind kind = PatchKind::kBezier;
    int columns = 4;
};
inline constexpr int kMostSplineColumns = 10000;

/// A mesh's `displacement`, but for its map.
struct DisplacementSettings {
    double scale = 1, offset = 0;
    int subdivide = 1;
};

/// Reads each picture once. Throws what the texture reader throws.
std::shared_ptr<const Texture> read_picture(Reading& reading, const std::string& path);

/// The picture that a JSON string names. Throws InputError with the string's place.
std::shared_ptr<const Texture> read_picture(Reading& reading, const Node& path);

/// Reads each glTF once; its warnings and files are noted then. Throws what read_gltf throws.
const GltfModel& read_gltf_once(Reading& reading, const std::string& path);

/// The picture that a glTF holds, by its number there. Throws InputError with the file's place.
std::shared_ptr<const Texture> read_gltf_picture(Reading& reading, const Node& file, const Node& image);

/// A direction of any length but 0, made unit.
Vec3 read_direction(const Node& direction);

// Parts of a scene, all of a checked document.
CameraDescription read_camera(const Node& camera, std::size_t index, Reading& reading);
Film read_film(const Node& scene);
Background read_background(const Node& scene, Reading& reading);
/// Adds the volumes, in order.
void read_volumes(const Node& scene, Reading& reading);
/// Adds the points and the labels, in order.
void read_marks(const Node& scene, Reading& reading);
/// Adds the lights, in order.
void read_lights(const Node& scene, Reading& reading);
RenderSettings read_render(const Node& scene);
Material read_material(const Node& material, Reading& reading);
/// A texture of a material: `key` of it, colours linear; none where it has no such key.
PlacedTexture read_texture(const Node& material, const char* key, Reading& reading);
/// The picture itself where its colours are straight, else divided by alpha where there is any.
std::shared_ptr<const Texture> with_straight_colours(std::shared_ptr<const Texture> picture);
/// The same of a picture of numbers: as the file holds them.
PlacedTexture read_number_texture(const Node& material, const char* key, Reading& reading);
/// The picture of a file of numbers, as the file holds them. Throws InputError(path) as read_picture.
std::shared_ptr<const Texture> read_numbers(Reading& reading, const std::string& path);
/// The normal map (rgb: half of 1 + the normal) of a picture of heights, its luminances: a height of 1 is as
/// high as a texel is wide. Slopes are central differences.
std::shared_ptr<const Texture> normals_of_heights(const Texture& heights, const TextureSampler& wrap);
Mesh read_mesh(const Node& mesh, std::size_t index, Reading& reading);
Primitive read_primitive(const Node& primitive, const Transform& transform, const Node& mesh);
/// A side of a lens, of a checked object that check_lens_side has passed.
void from_json_value(const Json& json, LensSide& side);
/// Throws InputError with its place where the side's terms do not go together.
void check_lens_side(const Node& side);
/// The polygons of an object's primitive, in its own frame.
PolygonMesh read_object_primitive(const Node& primitive);
Transform read_transform(const Node& mesh);
/// Of a transform's `rotate`, as the schema has it: a quaternion of any length. Throws InputError where it is
/// zero.
Vec4 read_rotation(const Node& node);
/// Moves a mesh as its `transform` and `fit` say. Throws InputError where points leave the range.
void place_mesh(PolygonMesh& polygons, const Node& mesh);
/// Whether the triangles of a terrain depend on how it is seen, and that is not known yet.
bool waits_for_views(const Node& mesh, const Reading& reading);
/// The triangles of an object that has heights, without materials; warns of holes.
void read_terrain(const Node& node, Mesh& mesh, Reading& reading);
/// The patches of an optic as its cage; warns of gaps, and of glass whose patches do not close.
void read_optic_patches(const Node& node, bool is_glass, Mesh& mesh, Reading& reading);
/// The patches of an object as polygons, in the world; warns of gaps.
PolygonMesh read_object_patches(const Node& node, Mesh& mesh, Reading& reading);

/// Says of a body of glass that the fronts of its faces look into it.
void warn_of_inside_out(const Node& node, Reading& reading);
/// Divides an object's triangles as its `bakedLight` says, and gives them that light. Throws InputError where
/// it is of another mesh.
void read_baked_light(const Node& baked, ObjectMesh& object);
/// Divides a mesh and moves its points, in its own frame, as its `displacement` and the heights of its file's
/// materials say. Returns how many of its faces, cut into triangles for it, cross themselves. Throws
/// InputError where it has no uv, and where it would have too many triangles.
std::size_t read_displacement(const Node& mesh, PolygonMesh& polygons, Reading& reading);
/// What normals an object is lit by.
ObjectShading read_shading(const Node& mesh);

/// Inline points, faces and uvs of a mesh.
PolygonMesh read_inline_polygons(const Node& mesh);
/// Polygons of the file that a mesh names; with `inherit`, the file's materials are read too.
PolygonMesh read_mesh_file(const Node& mesh, bool inherit, Reading& reading);
/// Scheme, boundary, creases, corners and holes that the JSON gives; they replace those of a file.
void read_subdivision(const Node& mesh, Cage& cage);
/// Throws InputError where an optic's scheme does not fit its faces.
void check_scheme(const Node& mesh, const Cage& cage);

// The files that a scene names, with what was in them: how an image knows later that one has changed.

/// One line per file, "hash path", the path from the scene's folder; the scene file itself is left out.
std::string named_files_text(const Scene& scene);

/// The files that the scene names now whose hash was another one in `text`, which named_files_text wrote.
std::vector<std::string> changed_files(const Scene& scene, const std::string& text);

// The tables of a scene's settings: what its JSON Schema and its readers are made of.

const std::vector<Field<CameraDescription>>& camera_fields();
const std::vector<Field<Film>>& film_fields();
const std::vector<Field<Background>>& background_fields();
const std::vector<Field<Material>>& material_fields();
const std::vector<Field<Light>>& light_fields();
const std::vector<Field<RenderSettings>>& render_fields();
const std::vector<Field<Volume>>& volume_entry_fields();
const std::vector<Field<TransferPoint>>& transfer_point_fields();
const std::vector<Field<PointCloud>>& point_cloud_fields();
const std::vector<Field<Label>>& label_fields();
const std::vector<Field<Mesh>>& mesh_fields();
const std::vector<Field<Cage>>& subdivision_fields();         // keys of a mesh, too
const std::vector<Field<TerrainSettings>>& terrain_fields();  // keys of a mesh, too
const std::vector<Field<InterestRegion>>& region_fields();
const std::vector<Field<WrittenPatch>>& patch_fields();
const std::vector<Field<DisplacementSettings>>& displacement_fields();
const std::vector<Field<ObjectPrimitive>>& primitive_fields();
const std::vector<Field<NormalOverride>>& normal_fields();

/// scene_schema(), parsed; made once.
const Json& scene_schema_json();

// Their schemas, as definitions of the scene's.
Json camera_schema();
Json view_schema();  // of a multiPerspective camera
Json film_schema();
Json background_schema();
Json material_schema();
Json texture_schema();
Json light_schema();
Json render_schema();
Json volume_schema();
Json volume_grid_schema();  // of a volume
Json transfer_schema();     // of a volume
Json transfer_point_schema();
Json point_cloud_schema();
Json label_schema();
Json mesh_schema();
Json region_schema();        // of a terrain
Json patch_schema();         // of a mesh
Json baked_light_schema();   // of a mesh
Json displacement_schema();  // of a mesh
Json primitive_schema();
Json lens_side_schema();  // of a primitive
Json normals_schema();

}  // namespace trilens
