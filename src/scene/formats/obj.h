// Wavefront OBJ with subdivision tags, read strictly and without loss of topology.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/data/polygons.h"

namespace trilens {

/// An OBJ file. mesh.face_material indexes material_names; mesh.materials is empty.
struct ObjFile {
    PolygonMesh mesh;
    std::vector<std::string> material_libraries;  // mtllib, as written
    std::vector<std::string> material_names;      // usemtl, in order of first use
    std::vector<std::string> warnings;
};

/// Parses an OBJ, UTF-8 with or without its byte order mark: v (with a colour after its coordinates, sRGB),
/// vt, vn, f (3..255 corners; negative indices count back from the last one so far), usemtl, mtllib, and the
/// tags `t crease 2/1/0 a b sharpness`, `t corner 1/1/0 v sharpness`, `t hole 1/0/0 face` and `t
/// interpolateboundary 1/0/0 k` (0 none, 1 edge and corner, 2 edge only), whose indices count from 0 over the
/// whole file. A backslash joins lines; lines and points are skipped; other keywords are ignored. Throws
/// InputError(file, "line n") for numbers, indices, counts or tags that are malformed or out of range, and
/// InputError(file) for a file without faces.
ObjFile parse_obj(const std::string& bytes, const std::string& file);

/// What trilens takes from a material of an MTL file.
struct MtlMaterial {
    std::string name;
    Vec3 diffuse{0};           // Kd, taken as linear; 0.6 where map_Kd stands without Kd
    std::string texture;       // map_Kd, as written; may be empty
    Vec3 specular{0};          // Ks; 0 where illum says that there is no highlight
    double exponent = 0;       // Ns, of the highlight
    std::string bump;          // map_Bump or bump, heights, or norm, normals; as written; may be empty
    bool is_normals = false;   // `bump` is norm's
    double bump_scale = 1;     // its -bm
    std::string displacement;  // disp, heights, as written; may be empty
    double displacement_base = 0, displacement_gain = 1;  // its -mm: base + gain times the picture
};

/// An MTL file; without a newmtl line it has no materials.
struct MtlFile {
    std::vector<MtlMaterial> materials;
    std::vector<std::string> warnings;
};

/// Parses an MTL file, UTF-8 with or without its byte order mark: newmtl, Kd with 3 numbers (or one for all
/// three), map_Kd, Ks, Ns, map_Bump (or bump, or norm) with -bm, disp with -mm, and illum 0 to 2 (below 2: no
/// highlight). One warning names every other key, and every other option of a map, with the line where it
/// stands first; d 1 and Tr 0 say what is drawn anyway and are not named. Throws InputError(file, "line n")
/// for colours and numbers that are none and for an option of a map without its value.
MtlFile parse_mtl(const std::string& bytes, const std::string& file);

}  // namespace trilens
