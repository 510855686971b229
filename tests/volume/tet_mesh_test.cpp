// Cells split into tetrahedra: volumes, faces that neighbours share, and what is counted.
#include <algorithm>
#include <numeric>
#include <vector>

#include "support/draw.h"
#include "support/test.h"
#include "volume/cell_checks.h"
#include "volume/cell_faces.h"
#include "volume/tet_mesh.h"

using namespace trilens;
using namespace trilens_test;

namespace {

double volume_of(const TetMesh& mesh) {
    double sum = 0;
    for (const Tetrahedron& cell : mesh.cells) {
        const Vec3& a = mesh.points[cell[0]];
        const double six =
            dot(cross(mesh.points[cell[1]] - a, mesh.points[cell[2]] - a), mesh.points[cell[3]] - a);
        CHECK(six > 0);
        sum += six / 6;
    }
    return sum;
}

std::vector<Vec3> corners_of(CellShape shape) {
    const std::vector<Vec3> cube{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                 {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    switch (shape) {
        case CellShape::kPyramid:
            return {cube[0], cube[1], cube[2], cube[3], {0.4, 0.5, 1}};
        case CellShape::kWedge:
            return {cube[0], cube[3], cube[1], cube[4], cube[7], cube[5]};
        case CellShape::kHexahedron:
            return cube;
        case CellShape::kTetrahedron:
            break;
    }
    return {cube[0], cube[1], cube[3], cube[4]};
}

/// Boxes in a row, their points numbered at random.
CellSoup row_of_boxes(std::size_t count, Draw& draw) {
    const std::size_t points = 4 * (count + 1);
    std::vector<Id> number(points);
    std::iota(number.begin(), number.end(), Id{0});
    for (std::size_t i = points; i > 1; --i)
        std::swap(number[i - 1],
                  number[static_cast<std::size_t>(draw.uniform(0, 1) * static_cast<double>(i))]);
    CellSoup soup;
    soup.points.resize(points);
    soup.scalars.resize(points, 1);
    const auto at = [&](std::size_t box, std::size_t k) { return number[4 * box + k]; };
    for (std::size_t box = 0; box <= count; ++box) {
        const double x = static_cast<double>(box);
        soup.points[at(box, 0)] = {x, 0, 0};
        soup.points[at(box, 1)] = {x, 1, 0};
        soup.points[at(box, 2)] = {x, 1, 1};
        soup.points[at(box, 3)] = {x, 0, 1};
    }
    for (std::size_t box = 0; box < count; ++box) {
        soup.shapes.push_back(CellShape::kHexahedron);
        for (const auto& [side, k] : std::vector<std::pair<std::size_t, std::size_t>>{
                 {0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 3}, {1, 3}, {1, 2}, {0, 2}})
            soup.corners.push_back(at(box + side, k));
    }
    return soup;
}

std::size_t open_faces(const TetMesh& mesh) {
    std::size_t crowded = 0;
    return count_open_faces(mesh, find_faces(mesh, crowded));
}

}  // namespace

TEST_CASE("a cell's tetrahedra fill it whatever its corners' numbers", "[volume][law]") {
    for (const auto& [shape, volume] :
         std::vector<std::pair<CellShape, double>>{{CellShape::kTetrahedron, 1.0 / 6},
                                                   {CellShape::kPyramid, 1.0 / 3},
                                                   {CellShape::kWedge, 0.5},
                                                   {CellShape::kHexahedron, 1.0}}) {
        const std::vector<Vec3> corners = corners_of(shape);
        std::vector<Id> number(corners.size());
        std::iota(number.begin(), number.end(), Id{0});
        std::size_t tries = 0;
        do {
            CellSoup soup;
            soup.points.resize(corners.size());
            soup.scalars.resize(corners.size());
            for (std::size_t k = 0; k < corners.size(); ++k) soup.points[number[k]] = corners[k];
            soup.shapes = {shape};
            soup.corners = number;
            const TetMesh mesh = make_tet_mesh(std::move(soup));
            CHECK(volume_of(mesh) == Approx(volume).epsilon(1e-14));
            CHECK(mesh.counts.folded + mesh.counts.flat + mesh.counts.inverted == 0);
            CHECK(open_faces(mesh) == 0);
        } while (std::next_permutation(number.begin(), number.end()) && ++tries < 800);
    }
}

TEST_CASE("cells that share a face split it alike, however points are numbered", "[volume][law]") {
    Draw draw(11);
    for (int round = 0; round < 50; ++round) {
        const TetMesh mesh = make_tet_mesh(row_of_boxes(4, draw));
        CHECK(volume_of(mesh) == Approx(4).epsilon(1e-13));
        std::size_t crowded = 0;
        const CellFaces faces = find_faces(mesh, crowded);
        CHECK(crowded == 0);
        const auto border = std::count_if(faces.cells.begin(), faces.cells.end(),
                                          [](const auto& sides) { return sides[1] == kNone; });
        CHECK(border == 2 * (4 * 4 + 2));  // two triangles for each square on the outside
        CHECK(count_open_faces(mesh, faces) == 0);
    }
}

TEST_CASE("a regular grid is the mesh of its boxes", "[volume]") {
    RegularGrid grid;
    grid.size = {3, 4, 2};
    grid.origin = {1, 2, 3};
    grid.steps = Mat3(0.5);
    grid.scalars.resize(24);
    const TetMesh mesh = make_tet_mesh(std::move(grid));
    CHECK(mesh.cells.size() == 36);
    CHECK(volume_of(mesh) == Approx(6 * 0.125).epsilon(1e-14));
    CHECK(mesh.points.front() == Vec3(1, 2, 3));
    CHECK(mesh.points.back() == Vec3(2, 3.5, 3.5));
    CHECK(open_faces(mesh) == 0);
}

TEST_CASE("inverted and flat tetrahedra, folded cells and faces of three cells are counted", "[volume]") {
    CellSoup soup;
    soup.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 0, 2}};
    soup.scalars.resize(6);
    soup.shapes.assign(4, CellShape::kTetrahedron);
    soup.corners = {0, 1, 2, 3, 0, 2, 1, 3, 0, 1, 2, 4, 0, 1, 2, 5};
    const TetMesh mesh = make_tet_mesh(std::move(soup));
    CHECK(mesh.counts.inverted == 1);
    CHECK(mesh.counts.flat == 1);
    CHECK(mesh.cells.size() == 3);
    std::size_t crowded = 0;
    find_faces(mesh, crowded);
    CHECK(crowded >= 1);

    CellSoup folded;
    folded.points = corners_of(CellShape::kHexahedron);
    std::swap(folded.points[6], folded.points[7]);
    folded.scalars.resize(8);
    folded.shapes = {CellShape::kHexahedron};
    folded.corners = {0, 1, 2, 3, 4, 5, 6, 7};
    CHECK(make_tet_mesh(std::move(folded)).counts.folded == 1);
}

TEST_CASE("cells that touch without sharing a face are counted, cells apart are not", "[volume]") {
    // Two boxes with points of their own, side by side: nothing is shared where they touch.
    Draw draw(5);
    const CellSoup one = row_of_boxes(1, draw);
    CellSoup two = one;
    for (const Vec3& point : one.points) two.points.push_back(point + Vec3(1, 0, 0));
    two.scalars.resize(16);
    two.shapes.push_back(CellShape::kHexahedron);
    for (const Id corner : one.corners) two.corners.push_back(corner + 8);
    CellSoup apart = two;
    for (std::size_t i = 8; i < 16; ++i) apart.points[i].x += 1e-3;
    CHECK(open_faces(make_tet_mesh(std::move(two))) == 4);
    CHECK(open_faces(make_tet_mesh(std::move(apart))) == 0);
}
