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
        part<WrittenPatch>("points", list_of(ref("vec3"), 4),
                           "bezier: 16 control points, row by row. bspline: rows of a uniform bicubic "
                           "B-spline, at least 4 x 4. nurbs: rows of control points.")
            .of({"bezier!", "bspline!", "nurbs!"}),
        setting("columns", &WrittenPatch::columns, whole_in(2, kMostSplineColumns), "Points of a row.")
            .of({"bspline", "nurbs"}),
        part<WrittenPatch>("degree", several(2, whole_in(1, kHighestPatchDegree)),
                           "Along u and along v; 3 by default.")
            .of({"nurbs"}),
        part<WrittenPatch>("weights", list_of(ref("number"), 4),
                           "One per point, above 0; without them all are 1.")
            .of({"nurbs"}),
        part<WrittenPatch>("knots", several(2, list_of(ref("number"), 4)),
                           "Along u and along v: as many as points there and the degree and one; they do not "
                           "fall, and stand at one place as often as the degree at most, once more at the "
                           "ends.")
            .of({"nurbs!"}),
        part<WrittenPatch>("curves", several(4, several(4, ref("vec3"))),
                           "Cubic Bezier curves: two along u, at v = 0 and 1, and two along v, at u = 0 and "
                           "1. Their ends agree.")
            .of({"coons!"}),
    };
    return fields;
}

Json patch_schema() {
    return object_schema({.title = "a patch",
                          .description = "A spline surface over (u, v), front where du x dv points.",
                          .required = {"type"},
                          .kind_title = "a # patch"},
                         patch_fields());
}

namespace {

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

std::vector<Vec3> read_controls(const Node& node) {
    std::vector<Vec3> points;
    for (const Json& point : node.json) points.push_back(to_vec3(point));
    return points;
}

/// Greatest weight of a patch by its least: far more would leave nothing of the digits of what they weigh.
constexpr double kMostWeights = 1e9;

std::vector<double> read_weights(const Node& node, std::size_t points) {
    std::vector<double> weights;
    for (const Json& weight : node.json) weights.push_back(weight.get<double>());
    if (weights.size() != points)
        node.fail(std::to_string(weights.size()) + " weights of " + std::to_string(points) + " points");
    for (std::size_t k = 0; k < points; ++k)
        if (!(weights[k] > 0)) node[k].fail("a weight must be above 0");
    const auto [least, most] = std::minmax_element(weights.begin(), weights.end());
    if (!(*most <= kMostWeights * *least))
        node.fail("the greatest weight is more than " + describe(kMostWeights) + " times the least");
    return weights;
}

void read_nurbs(const Node& node, SplineGrid& grid) {
    if (node.has("degree"))
        for (std::size_t axis = 0; axis < 2; ++axis)
            grid.degree[axis] = node.json.at("degree").at(axis).get<int>();
    if (node.has("weights")) grid.weights = read_weights(node["weights"], grid.points.size());
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const Node knots = node["knots"][axis];
        grid.knots[axis] = knots.json.get<std::vector<double>>();
        const std::string fault =
            knot_fault(grid.knots[axis], grid.degree[axis], axis == 0 ? grid.columns : grid.rows());
        if (!fault.empty()) knots.fail(fault);
    }
}

SplineGrid read_grid(const Node& node, const WrittenPatch& written) {
    if (written.kind == PatchKind::kCoons) return spline_of(coons_patch(read_curves(node["curves"])));
    std::vector<Vec3> points = read_controls(node["points"]);
    const std::size_t count = points.size();
    if (written.kind == PatchKind::kBezier) {
        if (count != 16) node["points"].fail("a Bezier patch has 16 points, not " + std::to_string(count));
        BezierPatch patch;
        std::copy(points.begin(), points.end(), patch.begin());
        return spline_of(patch);
    }
    const auto columns = static_cast<std::size_t>(written.columns);
    if (written.kind == PatchKind::kNurbs) {
        if (count % columns != 0)
            node["points"].fail(std::to_string(count) + " points are not rows of " + std::to_string(columns));
        SplineGrid grid;
        grid.columns = written.columns;
        grid.points = std::move(points);
        read_nurbs(node, grid);
        return grid;
    }
    if (columns < 4) node["columns"].fail("a cubic B-spline has at least 4 points in a row");
    if (count % columns != 0 || count / columns < 4)
        node["points"].fail(std::to_string(count) + " points are not at least 4 rows of " +
                            std::to_string(columns));
    return uniform_spline(written.columns, std::move(points));
}

/// In the world.
std::vector<RationalPatch> read_patches(const Node& mesh) {
    std::vector<SplineGrid> grids;
    const Node list = mesh["patches"];
    PolygonMesh places;
    for (std::size_t i = 0; i < list.size(); ++i) {
        WrittenPatch written;
        read_fields(list[i], patch_fields(), written);
        grids.push_back(read_grid(list[i], written));
        const std::vector<Vec3>& points = grids.back().points;
        places.cage.points.insert(places.cage.points.end(), points.begin(), points.end());
    }
    place_mesh(places, mesh);
    auto placed = places.cage.points.begin();
    std::vector<RationalPatch> patches;
    for (SplineGrid& grid : grids) {
        std::copy_n(placed, grid.points.size(), grid.points.begin());
        placed += static_cast<std::ptrdiff_t>(grid.points.size());
        if (mirrors(read_transform(mesh))) turn_around(grid);  // so that fronts stay fronts
        for (RationalPatch& patch : beziers_of(grid)) patches.push_back(std::move(patch));
    }
    return patches;
}

void warn_of_gaps(const Node& node, const OpenEdges& edges, Reading& reading) {
    if (edges.near > 0)
        reading.warn(node.place, std::to_string(edges.near) +
                                     " edges of patches lie within a hundredth of their length of another's "
                                     "and are apart from it: there may be gaps");
}

}  // namespace

void read_optic_patches(const Node& node, bool is_glass, Mesh& mesh, Reading& reading) {
    mesh.patches = read_patches(node);
    mesh.of_patches = true;
    mesh.face_count = mesh.patches.size();
    const OpenEdges edges = find_open_edges(mesh.patches);
    warn_of_gaps(node, edges, reading);
    if (edges.coincident > 0)
        reading.warn(node.place, std::to_string(edges.coincident) +
                                     " edges of patches lie along another's and are not joined to it: their "
                                     "degrees, weights or control points are not the same");
    if (const std::size_t bare = edges.open - edges.coincident; is_glass && bare > 0)
        reading.warn(node.place,
                     std::to_string(bare) +
                         " edges of patches have no other along them: this glass is one interface, "
                         "or a body with holes");
    constexpr int kAsPolygons = 4;
    if (is_glass && edges.open == 0 && signed_volume(patch_polygons(mesh.patches, kAsPolygons).cage) < 0)
        warn_of_inside_out(node, reading);
}

PolygonMesh read_object_patches(const Node& node, Mesh& mesh, Reading& reading) {
    const std::vector<RationalPatch> patches = read_patches(node);
    warn_of_gaps(node, find_open_edges(patches), reading);
    mesh.of_patches = true;
    mesh.face_count = patches.size();
    return patch_polygons(patches, mesh.resolution);
}

}  // namespace trilens
