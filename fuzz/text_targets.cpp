// Fuzz targets of what is read as text: scenes, keyframes, points, pairs, wishes, OBJ, MTL, VTK, NRRD
// and lens files.
#include <algorithm>
#include <cmath>

#include "fuzz/target.h"
#include "scene/data/scene_digest.h"
#include "scene/formats/lens_file.h"
#include "scene/formats/obj.h"
#include "scene/samples/point_cloud.h"
#include "scene/samples/volume_file.h"
#include "trilens/animation.h"
#include "trilens/design.h"
#include "trilens/fit.h"
#include "trilens/project.h"
#include "trilens/scene.h"
#include "trilens/surface.h"

using namespace trilens;

namespace trilens_fuzz {
namespace {

Scene parsed(std::string_view bytes) {
    return parse_scene(std::string(bytes), fuzz_folder(), {}, "fuzzed.json");
}

/// What load_scene promises of what it returns: check_scene says so, and the scene as a document is the same
/// scene.
void require_whole(const Scene& scene) {
    try {
        check_scene(scene);
    } catch (const Error& error) {
        throw Defect(std::string("a scene that was read is none: ") + error.what());
    }
    std::string document, digest;
    try {
        document = scene_document(scene, fuzz_folder());
        digest = scene_digest(parsed(document));
    } catch (const Error& error) {
        throw Defect(std::string("a scene's own document is refused: ") + error.what());
    }
    require(digest == scene_digest(scene), "a scene's own document is another scene");
}

}  // namespace

Answer scene_text(std::string_view bytes) {
    return answer([&] { require_whole(parsed(bytes)); });
}

Answer scene_animation(std::string_view bytes) {
    if (bytes.empty()) return Answer::kRefused;
    const double frame = static_cast<unsigned char>(bytes.front()) / 8.0 - 4;
    return answer([&] {
        const Scene scene = parsed(bytes.substr(1));
        require_whole(scene_at_frame(scene, frame));
    });
}

Answer points_text(std::string_view bytes) {
    return answer([&] {
        const std::string name = bytes.starts_with("ply") ? "fuzzed.ply" : "fuzzed.txt";
        const ColoredPoints cloud = parse_cloud(std::string(bytes), name);
        require(!cloud.points.empty(), "no point, and no word of it");
        require(cloud.colors.empty() || cloud.colors.size() == cloud.points.size(), "colours of some points");
        for (const Vec3& point : cloud.points)
            for (int axis = 0; axis < 3; ++axis)
                require(std::abs(point[axis]) <= kLargestCoordinate, "a point beyond the largest coordinate");
    });
}

Answer pairs_text(std::string_view bytes) {
    return answer([&] {
        const std::vector<Correspondence> pairs = parse_correspondences(std::string(bytes), "fuzzed.csv");
        for (const Correspondence& pair : pairs) {
            require(std::isfinite(pair.pixel.x + pair.pixel.y), "a pixel that is not finite");
            require(std::isfinite(pair.point.x + pair.point.y + pair.point.z), "a point that is not finite");
            require(pair.sigma >= 0, "a negative deviation");
        }
    });
}

Answer wish_text(std::string_view bytes) {
    return answer([&] {
        const DesignWish wish = parse_wish(std::string(bytes), "fuzzed.json", fuzz_folder());
        check_wish(wish, "fuzzed.json");
    });
}

Answer obj_text(std::string_view bytes) {
    return answer([&] {
        const ObjFile file = parse_obj(std::string(bytes), "fuzzed.obj");
        const PolygonMesh& mesh = file.mesh;
        std::size_t corners = 0;
        for (const auto count : mesh.cage.face_vertex_counts) corners += static_cast<std::size_t>(count);
        require(corners == mesh.cage.face_vertex_indices.size(), "corners of faces that are none");
        for (const auto vertex : mesh.cage.face_vertex_indices)
            require(static_cast<std::size_t>(vertex) < mesh.cage.points.size(), "a corner that is no point");
    });
}

namespace {

/// Cells that are drawn: of positive volume, their corners points with a number each.
void require_cells(const TetMesh& mesh) {
    require(mesh.scalars.size() == mesh.points.size(),
            "a point without a scalar, or a scalar without a point");
    for (const double scalar : mesh.scalars) require(std::isfinite(scalar), "a scalar that is not finite");
    for (const Tetrahedron& cell : mesh.cells) {
        for (const Id corner : cell) require(corner < mesh.points.size(), "a corner that is no point");
        const Vec3& a = mesh.points[cell[0]];
        require(dot(cross(mesh.points[cell[1]] - a, mesh.points[cell[2]] - a), mesh.points[cell[3]] - a) > 0,
                "a cell without a volume");
    }
}

}  // namespace

namespace {

/// As if nothing were packed: what a stream should fill is its bytes.
bool copied(std::string_view packed, std::span<char> to) {
    if (packed.size() < to.size()) return false;
    std::copy_n(packed.begin(), to.size(), to.begin());
    return true;
}

}  // namespace

/// XML where it begins as such.
Answer vtk_text(std::string_view bytes) {
    return answer([&] {
        VolumeFile file = bytes.starts_with("<") ? parse_vtu(std::string(bytes), "fuzzed.vtu", "", copied)
                                                 : parse_vtk(std::string(bytes), "fuzzed.vtk", "");
        if (auto* soup = std::get_if<CellSoup>(&file.cells)) require_cells(make_tet_mesh(std::move(*soup)));
    });
}

Answer nrrd_text(std::string_view bytes) {
    return answer([&] {
        const RegularGrid grid = parse_nrrd(
            std::string(bytes), "fuzzed.nrrd", [](const std::string&) { return std::string(64, 'x'); },
            copied);
        require(grid.scalars.size() == grid.size[0] * grid.size[1] * grid.size[2],
                "samples that are missing");
    });
}

/// Of the format that its first word says.
Answer lens_text(std::string_view bytes) {
    return answer([&] {
        const bool is_sequence = bytes.starts_with("RDM") || bytes.starts_with("LEN");
        const LensPrescription lens = is_sequence ? parse_code_v(std::string(bytes), "fuzzed.seq")
                                                  : parse_zemax(std::string(bytes), "fuzzed.zmx");
        require(!lens.rows.empty(), "a lens without surfaces");
        require(std::fabs(first_order(lens).focal_length) > 0, "a focal length that is none");
        for (const LensElement& element : lens_elements(lens))
            require(element.shape.thickness > 0 && element.medium.glass.index >= 1, "a body that is none");
    });
}

Answer mtl_text(std::string_view bytes) {
    return answer([&] {
        for (const MtlMaterial& material : parse_mtl(std::string(bytes), "fuzzed.mtl").materials)
            for (int c = 0; c < 3; ++c) require(material.diffuse[c] >= 0, "a colour that is none");
    });
}

}  // namespace trilens_fuzz
