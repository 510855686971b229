#include "scene/data/patches.h"

#include <algorithm>
#include <cmath>

#include "base/util/check.h"

namespace trilens {
namespace {

using Weights = std::array<double, 4>;

/// The four cubic Bernstein polynomials, their first or their second derivatives.
Weights bernstein(double t, int derivative) {
    const double s = 1 - t;
    if (derivative == 0) return {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
    if (derivative == 1) return {-3 * s * s, 3 * s * (s - 2 * t), 3 * t * (2 * s - t), 3 * t * t};
    return {6 * s, 6 * (t - 2 * s), 6 * (s - 2 * t), 6 * t};
}

/// Each row and then each column of 4 x 4 points by a matrix.
BezierPatch in_basis(const BezierPatch& points, const std::array<Weights, 4>& matrix) {
    BezierPatch along_u{}, both{};
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t k = 0; k < 4; ++k) along_u[4 * j + i] += matrix[i][k] * points[4 * j + k];
    for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t k = 0; k < 4; ++k) both[4 * j + i] += matrix[j][k] * along_u[4 * k + i];
    return both;
}

// Of points of the one basis those of the other, for the same cubic.
constexpr std::array<Weights, 4> kSplineOfBezier{
    {{6, -7, 2, 0}, {0, 2, -1, 0}, {0, -1, 2, 0}, {0, 2, -7, 6}}};
constexpr std::array<Weights, 4> kBezierOfSpline{{{1 / 6., 4 / 6., 1 / 6., 0},
                                                  {0, 4 / 6., 2 / 6., 0},
                                                  {0, 2 / 6., 4 / 6., 0},
                                                  {0, 1 / 6., 4 / 6., 1 / 6.}}};

/// Where the normal has no direction it is that of a place this share of the way to the patch's middle.
constexpr double kStepInward = 0x1p-20;

Vec3 normal_near(const BezierPatch& patch, const Vec2& uv) {
    const Vec3 here = evaluate(patch, uv).normal;
    if (here != Vec3(0)) return here;
    return evaluate(patch, uv + kStepInward * (Vec2(0.5) - uv)).normal;
}

/// The patch's edges, each from its lower to its upper parameter.
std::array<BezierCurve, 4> edges_of(const BezierPatch& p) {
    return {{{p[0], p[1], p[2], p[3]},
             {p[12], p[13], p[14], p[15]},
             {p[0], p[4], p[8], p[12]},
             {p[3], p[7], p[11], p[15]}}};
}

double size_of(const std::vector<BezierPatch>& patches) {
    Box box;
    for (const BezierPatch& patch : patches)
        for (const Vec3& point : patch) box.include(point);
    if (box.empty()) return 0;
    const Vec3 size = box.size();
    return std::max({size.x, size.y, size.z});
}

bool is_one_point(const BezierCurve& curve, double tolerance) {
    return std::all_of(curve.begin(), curve.end(),
                       [&](const Vec3& point) { return length(point - curve[0]) <= tolerance; });
}

bool agree(const BezierCurve& a, const BezierCurve& b, double tolerance) {
    const auto apart = [&](std::size_t i, std::size_t j) { return length(a[i] - b[j]) > tolerance; };
    bool along = true, against = true;
    for (std::size_t k = 0; k < 4; ++k) {
        along = along && !apart(k, k);
        against = against && !apart(k, 3 - k);
    }
    return along || against;
}

}  // namespace

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

SplineGrid spline_of(const BezierPatch& patch) {
    const BezierPatch points = in_basis(patch, kSplineOfBezier);
    return {4, {points.begin(), points.end()}};
}

std::vector<BezierPatch> beziers_of(const SplineGrid& spline) {
    std::vector<BezierPatch> patches;
    for (int row = 0; row + 3 < spline.rows(); ++row)
        for (int column = 0; column + 3 < spline.columns; ++column) {
            BezierPatch controls;
            for (int j = 0; j < 4; ++j)
                for (int i = 0; i < 4; ++i)
                    controls[static_cast<std::size_t>(4 * j + i)] =
                        spline.points[static_cast<std::size_t>((row + j) * spline.columns + column + i)];
            patches.push_back(in_basis(controls, kBezierOfSpline));
        }
    return patches;
}

SurfacePoint evaluate(const BezierPatch& patch, const Vec2& uv) {
    const auto sum = [&](int along_u, int along_v) {
        const Weights a = bernstein(uv.x, along_u), b = bernstein(uv.y, along_v);
        Vec3 total(0);
        for (std::size_t j = 0; j < 4; ++j)
            for (std::size_t i = 0; i < 4; ++i) total += a[i] * b[j] * patch[4 * j + i];
        return total;
    };
    SurfacePoint point;
    point.position = sum(0, 0);
    point.du = sum(1, 0);
    point.dv = sum(0, 1);
    point.duu = sum(2, 0);
    point.duv = sum(1, 1);
    point.dvv = sum(0, 2);
    double extent = 0;
    for (const Vec3& control : patch) extent = std::max(extent, length(control - patch[0]));
    const Vec3 normal = cross(point.du, point.dv);
    // Less is rounding of derivatives and no direction.
    const double least = 1e-12 * extent * std::max(length(point.du), length(point.dv));
    point.normal = length(normal) > least ? normalize(normal) : Vec3(0);
    return point;
}

Cage spline_cage(const std::vector<SplineGrid>& splines) {
    Cage cage;
    cage.interpolate_boundary = InterpolateBoundary::kNothing;
    for (const SplineGrid& spline : splines) {
        const auto first = static_cast<int>(cage.points.size());
        cage.points.insert(cage.points.end(), spline.points.begin(), spline.points.end());
        const int columns = spline.columns, rows = spline.rows();
        for (int j = 0; j + 1 < rows; ++j)
            for (int i = 0; i + 1 < columns; ++i) {
                const bool at_border = i == 0 || j == 0 || i + 2 == columns || j + 2 == rows;
                if (at_border) cage.hole_indices.push_back(static_cast<int>(cage.face_vertex_counts.size()));
                cage.face_vertex_counts.push_back(4);
                const int corner = first + j * columns + i;
                for (const int vertex : {corner, corner + 1, corner + columns + 1, corner + columns})
                    cage.face_vertex_indices.push_back(vertex);
            }
    }
    return cage;
}

Box patch_bounds(const Cage& cage) {
    Box box;
    std::size_t hole = 0;
    for (std::size_t face = 0; face < cage.face_vertex_counts.size(); ++face) {
        if (hole < cage.hole_indices.size() && cage.hole_indices[hole] == static_cast<int>(face)) {
            ++hole;
            continue;
        }
        // Its first corner is the second of the second row of its 16 points, its last one stands a row below.
        const int corner = cage.face_vertex_indices[4 * face];
        const int columns = cage.face_vertex_indices[4 * face + 3] - corner;
        SplineGrid spline;
        for (int k = 0; k < 16; ++k)
            spline.points.push_back(
                cage.points[static_cast<std::size_t>(corner + (k / 4 - 1) * columns + k % 4 - 1)]);
        const std::vector<BezierPatch> one = beziers_of(spline);
        for (const Vec3& point : one[0]) box.include(point);
    }
    return box;
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

PolygonMesh patch_polygons(const std::vector<BezierPatch>& patches, int n) {
    TRILENS_CHECK(n >= 1, "a patch has a quad");
    PolygonMesh mesh;
    const double tolerance = kSameControl * size_of(patches);
    for (const BezierPatch& patch : patches) {
        std::vector<PatchCorner> lattice;
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i) {
                const Vec2 uv(static_cast<double>(i) / n, static_cast<double>(j) / n);
                lattice.push_back({static_cast<int>(mesh.cage.points.size()), normal_near(patch, uv), uv});
                mesh.cage.points.push_back(evaluate(patch, uv).position);
            }
        const auto at = [&](int i, int j) { return lattice[static_cast<std::size_t>(j * (n + 1) + i)]; };
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i)
                add_quad({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, tolerance, mesh);
    }
    return mesh;
}

std::size_t count_open_edges(const std::vector<BezierPatch>& patches) {
    const double tolerance = kSameControl * size_of(patches);
    std::vector<BezierCurve> edges;
    for (const BezierPatch& patch : patches)
        for (const BezierCurve& edge : edges_of(patch))
            if (!is_one_point(edge, tolerance)) edges.push_back(edge);
    // By the middle of their ends, so that only edges near each other are compared.
    const auto key = [](const BezierCurve& edge) { return edge[0].x + edge[3].x; };
    std::sort(edges.begin(), edges.end(),
              [&](const BezierCurve& a, const BezierCurve& b) { return key(a) < key(b); });
    std::vector<bool> is_shared(edges.size(), false);
    for (std::size_t a = 0; a < edges.size(); ++a)
        for (std::size_t b = a + 1; b < edges.size() && key(edges[b]) - key(edges[a]) <= 2 * tolerance; ++b)
            if (agree(edges[a], edges[b], tolerance)) is_shared[a] = is_shared[b] = true;
    return static_cast<std::size_t>(std::count(is_shared.begin(), is_shared.end(), false));
}

}  // namespace trilens
