// Meshes made of spline patches: their keys, and what becomes of them as optics and as objects.
#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "scene/data/patches.h"
#include "scene/read/reading.h"

namespace trilens {

const std::vector<Field<WrittenPatch>>& patch_fields() {
    static const std::vector<Field<WrittenPatch>> fields{
        choice("type", &WrittenPatch::kind).without_default(),
        part<WrittenPatch>("points", list_of(ref("vec3"), 16),
                           "bezier: 16 control points, row by row. bspline: rows of a uniform bicubic "
                           "B-spline, at least 4 x 4.")
            .of({"bezier!", "bspline!"}),
        setting("columns", &WrittenPatch::columns, whole_in(4, kMostSplineColumns), "Points of a row.")
            .of({"bspline"}),
        part<WrittenPatch>("curves", several(4, several(4, ref("vec3"))),
                           "Cubic Bezier curves: two along u, at v = 0 and 1, and two along v, at u = 0 and "
                           "1. Their ends agree.")
            .of({"coons!"}),
    };
    return fields;
}

Json patch_schema() {
    return object_schema({.title = "a patch",
                          .description = "A bicubic surface over (u, v), front where du x dv points.",
                          .required = {"type"},
                          .kind_title = "a # patch"},
                         patch_fields());
}

namespace {

/// Control points as they are written, of either basis.
struct Patches {
    std::vector<SplineGrid> grids;
    std::vector<bool> are_splines;  // otherwise one Bezier patch

    static BezierPatch bezier_of(const SplineGrid& grid) {
        BezierPatch patch;
        std::copy_n(grid.points.begin(), 16, patch.begin());
        return patch;
    }
    std::vector<BezierPatch> beziers() const {
        std::vector<BezierPatch> patches;
        for (std::size_t i = 0; i < grids.size(); ++i) {
            if (!are_splines[i]) {
                patches.push_back(bezier_of(grids[i]));
                continue;
            }
            for (const BezierPatch& patch : beziers_of(grids[i])) patches.push_back(patch);
        }
        return patches;
    }
    std::vector<SplineGrid> splines() const {
        std::vector<SplineGrid> all;
        for (std::size_t i = 0; i < grids.size(); ++i)
            all.push_back(are_splines[i] ? grids[i] : spline_of(bezier_of(grids[i])));
        return all;
    }
};

std::vector<Vec3> read_controls(const Node& node) {
    std::vector<Vec3> points;
    for (const Json& point : node.json) points.push_back(to_vec3(point));
    return points;
}

std::array<BezierCurve, 4> read_curves(const Node& node) {
    std::array<BezierCurve, 4> curves;
    double size = 0;
    for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t k = 0; k < 4; ++k) {
            curves[c][k] = to_vec3(node.json.at(c).at(k));
            size = std::max(size, length(curves[c][k] - curves[0][0]));
        }
    const auto& [low, high, left, right] = curves;
    const std::array<std::pair<Vec3, Vec3>, 4> ends{
        {{low[0], left[0]}, {low[3], right[0]}, {high[0], left[3]}, {high[3], right[3]}}};
    for (const auto& [one, other] : ends)
        if (length(one - other) > kSameControl * size)
            node.fail("the curves' ends do not agree: those along u end at " + to_json_value(one).dump() +
                      ", those along v at " + to_json_value(other).dump());
    return curves;
}

SplineGrid read_grid(const Node& node, PatchKind kind, int columns) {
    if (kind == PatchKind::kCoons) {
        const BezierPatch patch = coons_patch(read_curves(node["curves"]));
        return {4, {patch.begin(), patch.end()}};
    }
    SplineGrid grid{columns, read_controls(node["points"])};
    const std::size_t count = grid.points.size();
    if (kind == PatchKind::kBezier && count != 16)
        node["points"].fail("a Bezier patch has 16 points, not " + std::to_string(count));
    if (count % static_cast<std::size_t>(columns) != 0 || grid.rows() < 4)
        node["points"].fail(std::to_string(count) + " points are not at least 4 rows of " +
                            std::to_string(columns));
    return grid;
}

/// In the world.
Patches read_patches(const Node& mesh) {
    Patches patches;
    const Node list = mesh["patches"];
    PolygonMesh places;
    for (std::size_t i = 0; i < list.size(); ++i) {
        WrittenPatch written;
        read_fields(list[i], patch_fields(), written);
        patches.grids.push_back(read_grid(list[i], written.kind, written.columns));
        patches.are_splines.push_back(written.kind == PatchKind::kBspline);
        const std::vector<Vec3>& points = patches.grids.back().points;
        places.cage.points.insert(places.cage.points.end(), points.begin(), points.end());
    }
    place_mesh(places, mesh);
    auto placed = places.cage.points.begin();
    const bool turned = mirrors(read_transform(mesh));
    for (SplineGrid& grid : patches.grids) {
        std::copy_n(placed, grid.points.size(), grid.points.begin());
        placed += static_cast<std::ptrdiff_t>(grid.points.size());
        // u the other way round, so that fronts stay fronts.
        for (int row = 0; turned && row < grid.rows(); ++row)
            std::reverse(grid.points.begin() + row * grid.columns,
                         grid.points.begin() + (row + 1) * grid.columns);
    }
    return patches;
}

}  // namespace

void read_optic_patches(const Node& node, bool is_glass, Mesh& mesh, Reading& reading) {
    const Patches patches = read_patches(node);
    const std::vector<BezierPatch> beziers = patches.beziers();
    mesh.cage = spline_cage(patches.splines());
    mesh.of_patches = true;
    mesh.face_count = beziers.size();
    if (const std::size_t open = is_glass ? count_open_edges(beziers) : 0; open > 0)
        reading.warn(node.place,
                     std::to_string(open) +
                         " edges of patches have no other along them: this glass is one interface, "
                         "or a body with holes");
}

PolygonMesh read_object_patches(const Node& node, Mesh& mesh) {
    const std::vector<BezierPatch> beziers = read_patches(node).beziers();
    mesh.of_patches = true;
    mesh.face_count = beziers.size();
    return patch_polygons(beziers, mesh.resolution);
}

}  // namespace trilens
