#include "scene/data/patches.h"

#include <algorithm>
#include <utility>

#include "base/math/point_tree.h"
#include "base/util/check.h"

namespace trilens {

BezierPatch coons_patch(const std::array<BezierCurve, 4>& curves) {
    const auto& [low, high, left, right] = curves;
    BezierPatch patch;
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 4; ++i) {
            // Lines as cubics have their points at thirds.
            const double a = static_cast<double>(i) / 3, b = static_cast<double>(j) / 3;
            const Vec3 corners =
                (1 - b) * ((1 - a) * low[0] + a * low[3]) + b * ((1 - a) * high[0] + a * high[3]);
            patch[4 * j + i] = (1 - b) * low[i] + b * high[i] + (1 - a) * left[j] + a * right[j] - corners;
        }
    return patch;
}

namespace {

std::vector<double> uniform_knots(int points) {
    std::vector<double> knots;
    for (int k = 0; k < points + 4; ++k) knots.push_back(k);
    return knots;
}

}  // namespace

SplineGrid uniform_spline(int columns, std::vector<Vec3> points) {
    SplineGrid grid;
    grid.columns = columns;
    grid.points = std::move(points);
    grid.knots = {uniform_knots(columns), uniform_knots(grid.rows())};
    return grid;
}

SplineGrid spline_of(const BezierPatch& patch) {
    const std::vector<double> knots{0, 0, 0, 0, 1, 1, 1, 1};
    SplineGrid grid;
    grid.points.assign(patch.begin(), patch.end());
    grid.knots = {knots, knots};
    return grid;
}

std::string knot_fault(const std::vector<double>& knots, int degree, int points) {
    const auto many = static_cast<std::size_t>(points + degree + 1);
    if (points < degree + 1)
        return std::to_string(points) + " points are fewer than a degree of " + std::to_string(degree) +
               " needs, which is " + std::to_string(degree + 1);
    if (knots.size() != many)
        return std::to_string(knots.size()) + " knots, not " + std::to_string(many) +
               ": as many as points (" + std::to_string(points) + ") and the degree (" +
               std::to_string(degree) + ") and one";
    const auto first = static_cast<std::size_t>(degree), last = static_cast<std::size_t>(points);
    std::size_t alike = 1;
    for (std::size_t k = 1; k < many; ++k) {
        if (!(knots[k] >= knots[k - 1])) return "knots fall at number " + std::to_string(k + 1);
        alike = knots[k] == knots[k - 1] ? alike + 1 : 1;
        const bool is_end = knots[k] == knots[first] || knots[k] == knots[last];
        if (alike > first + (is_end ? 1 : 0))
            return "more than " + std::to_string(first + (is_end ? 1 : 0)) +
                   " knots stand at one place, at number " + std::to_string(k + 1);
    }
    return knots[first] < knots[last] ? "" : "all knots between the ends stand at one place";
}

namespace {

/// The Bezier points between knots[k] and the next one of the degree + 1 controls that matter there: blossoms
/// by de Boor's algorithm (Ramshaw, Blossoms are polar forms, 1989), all of them means of controls.
std::vector<Vec4> bezier_row(const std::vector<Vec4>& controls, const std::vector<double>& knots,
                             std::size_t k) {
    const std::size_t degree = controls.size() - 1;
    std::vector<Vec4> row;
    for (std::size_t i = 0; i <= degree; ++i) {
        std::vector<Vec4> d = controls;
        for (std::size_t r = 1; r <= degree; ++r) {
            const double at = knots[r <= i ? k + 1 : k];
            for (std::size_t j = degree; j >= r; --j) {
                const double low = knots[k - degree + j], high = knots[k + j - r + 1];
                const double share = (at - low) / (high - low);
                d[j] = (1 - share) * d[j - 1] + share * d[j];
            }
        }
        row.push_back(d[degree]);
    }
    return row;
}

/// The numbers of knots that a patch begins at.
std::vector<std::size_t> spans_of(const std::vector<double>& knots, int degree) {
    std::vector<std::size_t> spans;
    const auto p = static_cast<std::size_t>(degree);
    for (std::size_t k = p; k + p + 1 < knots.size(); ++k)
        if (knots[k] < knots[k + 1]) spans.push_back(k);
    return spans;
}

/// The patch that begins at knot (u, v).
RationalPatch patch_at(const SplineGrid& spline, std::size_t u, std::size_t v) {
    const auto p = static_cast<std::size_t>(spline.degree[0]), q = static_cast<std::size_t>(spline.degree[1]);
    const auto columns = static_cast<std::size_t>(spline.columns);
    RationalPatch patch{spline.degree[0], spline.degree[1], spline.points[(v - q) * columns + u - p], {}};
    std::vector<std::vector<Vec4>> rows;
    for (std::size_t j = v - q; j <= v; ++j) {
        std::vector<Vec4> controls;
        for (std::size_t i = u - p; i <= u; ++i) {
            const std::size_t at = j * columns + i;
            const double w = spline.weights.empty() ? 1 : spline.weights[at];
            controls.emplace_back(w * (spline.points[at] - patch.origin), w);
        }
        rows.push_back(bezier_row(controls, spline.knots[0], u));
    }
    patch.points.resize((p + 1) * (q + 1));
    for (std::size_t i = 0; i <= p; ++i) {
        std::vector<Vec4> column;
        for (const std::vector<Vec4>& row : rows) column.push_back(row[i]);
        column = bezier_row(column, spline.knots[1], v);
        for (std::size_t j = 0; j <= q; ++j) patch.points[j * (p + 1) + i] = column[j];
    }
    return patch;
}

}  // namespace

std::vector<RationalPatch> beziers_of(const SplineGrid& spline) {
    std::vector<RationalPatch> patches;
    for (const std::size_t v : spans_of(spline.knots[1], spline.degree[1]))
        for (const std::size_t u : spans_of(spline.knots[0], spline.degree[0]))
            patches.push_back(patch_at(spline, u, v));
    return patches;
}

void turn_around(SplineGrid& spline) {
    for (int row = 0; row < spline.rows(); ++row) {
        std::reverse(spline.points.begin() + row * spline.columns,
                     spline.points.begin() + (row + 1) * spline.columns);
        if (!spline.weights.empty())
            std::reverse(spline.weights.begin() + row * spline.columns,
                         spline.weights.begin() + (row + 1) * spline.columns);
    }
    std::vector<double>& knots = spline.knots[0];
    std::reverse(knots.begin(), knots.end());
    for (double& knot : knots) knot = -knot;
}

namespace {

/// A place of a patch's lattice.
struct PatchCorner {
    int point = 0;  // of the mesh
    Vec3 normal{0};
    Vec2 uv{0};
};

/// The quad; a triangle where two neighbours are one place; nothing where less is left.
void add_quad(const std::array<PatchCorner, 4>& ring, double tolerance, PolygonMesh& mesh) {
    const auto place = [&](std::size_t k) {
        return mesh.cage.points[static_cast<std::size_t>(ring[k].point)];
    };
    std::vector<PatchCorner> face;
    for (std::size_t k = 0; k < 4; ++k)
        if (length(place(k) - place((k + 1) % 4)) > tolerance) face.push_back(ring[k]);
    if (face.size() < 3) return;
    mesh.cage.face_vertex_counts.push_back(static_cast<int>(face.size()));
    for (const PatchCorner& corner : face) {
        mesh.cage.face_vertex_indices.push_back(corner.point);
        mesh.normals.push_back(corner.normal);
        mesh.uvs.push_back(corner.uv);
    }
}

}  // namespace

PolygonMesh patch_polygons(const std::vector<RationalPatch>& patches, int n) {
    TRILENS_CHECK(n >= 1, "a patch has a quad");
    PolygonMesh mesh;
    Box box;
    for (const RationalPatch& patch : patches) box.include(bounds_of(patch));
    const double tolerance = joint_tolerance(box);
    for (const RationalPatch& patch : patches) {
        const double extent = extent_of(patch);
        std::vector<PatchCorner> lattice;
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i) {
                const Vec2 uv(static_cast<double>(i) / n, static_cast<double>(j) / n);
                const SurfacePoint point = evaluate_first_order(patch, uv, extent);
                lattice.push_back({static_cast<int>(mesh.cage.points.size()), point.normal, uv});
                mesh.cage.points.push_back(point.position);
            }
        const auto at = [&](int i, int j) { return lattice[static_cast<std::size_t>(j * (n + 1) + i)]; };
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i)
                add_quad({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, tolerance, mesh);
    }
    return mesh;
}

namespace {

/// A side that is joined to no other, by places on it.
struct OpenSide {
    std::size_t patch = 0;
    std::array<Vec3, 5> places{};  // at quarters

    const Vec3& middle() const { return places[2]; }
    double length_of() const { return length(middle() - places[0]) + length(places[4] - middle()); }
    /// By every place, or every second one, in either direction.
    bool lies_at(const OpenSide& other, double tolerance, std::size_t every) const {
        const auto agrees = [&](bool against) {
            for (std::size_t k = 0; k < 5; k += every)
                if (!(length(places[k] - other.places[against ? 4 - k : k]) <= tolerance)) return false;
            return true;
        };
        return agrees(false) || agrees(true);
    }
};

OpenSide side_of(const std::vector<RationalPatch>& patches, std::size_t p, std::size_t side) {
    constexpr std::array<Vec2, 4> kCorners{Vec2(0, 0), {1, 0}, {1, 1}, {0, 1}};
    const Vec2 from = kCorners[side], to = kCorners[(side + 1) % 4];
    const double extent = extent_of(patches[p]);
    const auto at = [&](double t) {
        return evaluate_first_order(patches[p], from + t * (to - from), extent).position;
    };
    return {p, {at(0), at(0.25), at(0.5), at(0.75), at(1)}};
}

std::vector<OpenSide> open_sides(std::vector<RationalPatch> patches) {
    const std::vector<FaceBorder> borders = join_patches(patches);
    std::vector<OpenSide> open;
    for (std::size_t p = 0; p < patches.size(); ++p)
        for (std::size_t side = 0; side < 4; ++side)
            if (borders[p].sides[side].edge == kNone && !is_collapsed(patches[p], side))
                open.push_back(side_of(patches, p, side));
    return open;
}

}  // namespace

OpenEdges find_open_edges(const std::vector<RationalPatch>& patches) {
    const std::vector<OpenSide> open = open_sides(patches);
    std::vector<Vec3> middles;
    for (const OpenSide& side : open) middles.push_back(side.middle());
    const PointTree tree(std::move(middles));
    Box box;
    for (const RationalPatch& patch : patches) box.include(bounds_of(patch));
    const double same = joint_tolerance(box);
    OpenEdges edges{open.size()};
    for (const OpenSide& side : open) {
        const auto has_another = [&](double tolerance, std::size_t every) {
            return tree.any_within(side.middle(), tolerance, [&](std::size_t other) {
                return open[other].patch != side.patch && side.lies_at(open[other], tolerance, every);
            });
        };
        if (has_another(same, 1))
            ++edges.coincident;
        else if (has_another(kNearEdge * side.length_of(), 2))
            ++edges.near;
    }
    return edges;
}

}  // namespace trilens
