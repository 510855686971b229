// Cells along a ray: from the faces that it crosses, and by clipping against planes.
#include <cmath>
#include <limits>
#include <vector>

#include "support/draw.h"
#include "support/test.h"
#include "volume/cell_faces.h"
#include "volume/tet_mesh.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A grid of 4 x 4 x 4 boxes in the unit cube, its inner points moved by up to `shake` of a box.
TetMesh shaken_grid(double shake, Draw& draw) {
    RegularGrid grid;
    grid.size = {5, 5, 5};
    grid.steps = Mat3(0.25);
    for (int i = 0; i < 125; ++i) grid.scalars.push_back(draw.uniform(0, 1));
    TetMesh mesh = make_tet_mesh(std::move(grid));
    for (Vec3& point : mesh.points)
        for (int k = 0; k < 3; ++k)
            if (point[k] > 0 && point[k] < 1) point[k] += 0.25 * draw.uniform(-shake, shake);
    return mesh;
}

std::vector<CellStretch> clipped(const TetMesh& mesh, const Ray& ray, double until) {
    std::vector<CellStretch> cells;
    for (Id c = 0; c < mesh.cells.size(); ++c)
        if (const auto stretch = clip_line(mesh, c, ray)) cells.push_back(*stretch);
    order_cells(until, cells);
    return cells;
}

/// Of all faces: by Moeller and Trumbore's formula, which is not watertight; rays at random meet no edge.
std::vector<FaceCrossing> crossings(const TetMesh& mesh, const CellFaces& faces, const Ray& ray,
                                    double until) {
    std::vector<FaceCrossing> found;
    FaceCrossing behind{kNone, std::numeric_limits<double>::infinity()};
    for (Id f = 0; f < faces.triangles.triangles.size(); ++f) {
        const IdTriple& corner = faces.triangles.triangles[f];
        const Vec3 a = mesh.points[corner[0]], e1 = mesh.points[corner[1]] - a,
                   e2 = mesh.points[corner[2]] - a;
        const Vec3 p = cross(ray.direction, e2), s = ray.origin - a, q = cross(s, e1);
        const double det = dot(e1, p), u = dot(s, p) / det, v = dot(ray.direction, q) / det,
                     t = dot(e2, q) / det;
        if (!(u >= 0 && v >= 0 && u + v <= 1 && t >= 0)) continue;
        if (t <= until)
            found.push_back({f, t});
        else if (t < behind.t)
            behind = {f, t};
    }
    if (found.empty() && behind.face != kNone) found.push_back(behind);
    return found;
}

}  // namespace

TEST_CASE("cells from crossed faces are the cells that clipping finds", "[volume][law]") {
    Draw draw(21);
    const TetMesh mesh = shaken_grid(0.3, draw);
    std::size_t crowded = 0;
    const CellFaces faces = find_faces(mesh, crowded);
    const CrossedCells crossed(mesh, faces);
    std::size_t inside = 0;
    for (int i = 0; i < 2000; ++i) {
        const bool starts_inside = i % 2 == 0;
        const Vec3 origin = Vec3(0.5) + (starts_inside ? draw.in_cube(0.49) : 2.0 * draw.unit());
        const Vec3 target = Vec3(0.5) + draw.in_cube(0.4);
        const Ray ray{origin, draw.log_uniform(0.1, 10) * (target - origin)};
        const double until = i % 3 == 0 ? std::numeric_limits<double>::infinity()
                                        : draw.log_uniform(0.001, 3) / length(ray.direction);
        const std::vector<CellStretch> expected = clipped(mesh, ray, until),
                                       found = crossed.find(ray, until, crossings(mesh, faces, ray, until));
        REQUIRE(found.size() == expected.size());
        for (std::size_t c = 0; c < found.size(); ++c) {
            CHECK(found[c].cell == expected[c].cell);
            CHECK(found[c].t_in == Approx(expected[c].t_in).epsilon(1e-9).margin(1e-12));
            CHECK(found[c].t_out == Approx(expected[c].t_out).epsilon(1e-9));
            if (c > 0) CHECK(found[c].t_in == Approx(found[c - 1].t_out).epsilon(1e-9));
        }
        inside += starts_inside && !found.empty() && found[0].t_in == 0;
    }
    CHECK(inside == 1000);
}

TEST_CASE("a ray that starts on a corner, an edge or a face of cells passes those that hold it",
          "[volume][law]") {
    Draw draw(23);
    for (const double shake : {0.0, 0.3}) {
        const TetMesh mesh = shaken_grid(shake, draw);
        std::size_t crowded = 0;
        const CellFaces faces = find_faces(mesh, crowded);
        const CrossedCells crossed(mesh, faces);
        constexpr double kFar = std::numeric_limits<double>::infinity();
        for (int i = 0; i < 600; ++i) {
            const IdTriple& corner = faces.triangles.triangles[static_cast<std::size_t>(
                draw.uniform(0, 1) * static_cast<double>(faces.triangles.triangles.size()))];
            Vec3 weights(1, 0, 0);  // at a corner
            if (i % 3 == 1) weights = Vec3(0.5, 0.5, 0);
            if (i % 3 == 2) weights = Vec3(0.25, 0.5, 0.25);
            Ray ray{Vec3(0), draw.unit()};
            for (int k = 0; k < 3; ++k)
                ray.origin += weights[k] * mesh.points[corner[static_cast<std::size_t>(k)]];
            double expected = 0, found = 0;
            for (const CellStretch& one : clipped(mesh, ray, kFar)) expected += one.t_out - one.t_in;
            for (const CellStretch& one : crossed.find(ray, kFar, crossings(mesh, faces, ray, kFar)))
                found += one.t_out - one.t_in;
            CAPTURE(shake, i, ray.origin.x, ray.origin.y, ray.origin.z);
            CHECK(found == Approx(expected).epsilon(1e-9).margin(1e-9));
        }
    }
}

TEST_CASE("a gradient gives back the scalars of its cell", "[volume][law]") {
    Draw draw(22);
    const TetMesh mesh = shaken_grid(0.3, draw);
    for (Id c = 0; c < mesh.cells.size(); ++c) {
        const Vec3 gradient = scalar_gradient(mesh, c);
        const Tetrahedron& cell = mesh.cells[c];
        for (const Id corner : cell)
            CHECK(mesh.scalars[cell[0]] + dot(gradient, mesh.points[corner] - mesh.points[cell[0]]) ==
                  Approx(mesh.scalars[corner]).margin(1e-12));
    }
}

TEST_CASE("lines along faces and edges of cells pass one cell after the other", "[volume][law]") {
    Draw draw(23);
    const TetMesh mesh = shaken_grid(0, draw);
    for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(0, 1, 1)})
        for (const Vec3& through :
             {Vec3(0.5), Vec3(0.25, 0.5, 0.75), Vec3(0.3, 0.5, 0.5), Vec3(0.5, 0.5, 0.1)}) {
            const Ray ray{through - 3.0 * direction, direction};
            const std::vector<CellStretch> cells = clipped(mesh, ray, 100);
            REQUIRE_FALSE(cells.empty());
            double reached = cells[0].t_in;
            for (const CellStretch& one : cells) {
                CHECK(one.t_in == reached);
                reached = one.t_out;
            }
            double enters = 0, leaves = 100;
            for (int k = 0; k < 3; ++k)
                if (direction[k] != 0) {
                    enters = std::max(enters, (0 - ray.origin[k]) / direction[k]);
                    leaves = std::min(leaves, (1 - ray.origin[k]) / direction[k]);
                }
            CHECK(cells[0].t_in == Approx(enters));
            CHECK(reached == Approx(leaves));
        }
}
