#include "volume/tet_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/util/check.h"

namespace trilens {
namespace {

constexpr double kFlatVolume = 1e-14;  // of the cube of the longest edge

/// A face of a cell, its corners counterclockwise from outside; the fourth is kNoCorner of a triangle.
constexpr std::uint8_t kNoCorner = 255;
using CellFace = std::array<std::uint8_t, 4>;

std::span<const CellFace> faces_of(CellShape shape) {
    static constexpr std::array<CellFace, 4> kTetrahedron{
        {{1, 2, 3, kNoCorner}, {0, 3, 2, kNoCorner}, {0, 1, 3, kNoCorner}, {0, 2, 1, kNoCorner}}};
    static constexpr std::array<CellFace, 5> kPyramid{{{0, 3, 2, 1},
                                                       {0, 1, 4, kNoCorner},
                                                       {1, 2, 4, kNoCorner},
                                                       {2, 3, 4, kNoCorner},
                                                       {3, 0, 4, kNoCorner}}};
    static constexpr std::array<CellFace, 5> kWedge{
        {{0, 1, 2, kNoCorner}, {3, 5, 4, kNoCorner}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}};
    static constexpr std::array<CellFace, 6> kHexahedron{
        {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
    switch (shape) {
        case CellShape::kPyramid:
            return kPyramid;
        case CellShape::kWedge:
            return kWedge;
        case CellShape::kHexahedron:
            return kHexahedron;
        case CellShape::kTetrahedron:
            break;
    }
    return kTetrahedron;
}

double longest_edge(const std::vector<Vec3>& points, const Tetrahedron& cell) {
    double longest = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j)
            longest = std::max(longest, length(points[cell[j]] - points[cell[i]]));
    return longest;
}

enum class Turn { kRight, kInverted, kFlat };

/// The cell's turn; an inverted one is turned.
Turn turn_right(const std::vector<Vec3>& points, Tetrahedron& cell) {
    const Vec3& a = points[cell[0]];
    const double volume = dot(cross(points[cell[1]] - a, points[cell[2]] - a), points[cell[3]] - a);
    const double edge = longest_edge(points, cell);
    if (!(std::fabs(volume) > kFlatVolume * edge * edge * edge)) return Turn::kFlat;
    if (volume > 0) return Turn::kRight;
    std::swap(cell[2], cell[3]);
    return Turn::kInverted;
}

}  // namespace

std::size_t corner_count(CellShape shape) {
    switch (shape) {
        case CellShape::kPyramid:
            return 5;
        case CellShape::kWedge:
            return 6;
        case CellShape::kHexahedron:
            return 8;
        case CellShape::kTetrahedron:
            break;
    }
    return 4;
}

void split_cell(CellShape shape, std::span<const Id> corners, std::vector<Tetrahedron>& tetrahedra) {
    TRILENS_CHECK(corners.size() == corner_count(shape), "a cell has the corners of its shape");
    if (shape == CellShape::kTetrahedron) {
        tetrahedra.push_back({corners[0], corners[1], corners[2], corners[3]});
        return;
    }
    const Id apex = *std::min_element(corners.begin(), corners.end());
    for (const CellFace& face : faces_of(shape)) {
        const std::size_t sides = face[3] == kNoCorner ? 3 : 4;
        std::array<Id, 4> at{};
        for (std::size_t k = 0; k < sides; ++k) at[k] = corners[face[k]];
        if (std::find(at.begin(), at.begin() + sides, apex) != at.begin() + sides) continue;
        const auto lowest =
            static_cast<std::size_t>(std::min_element(at.begin(), at.begin() + sides) - at.begin());
        for (std::size_t k = 1; k + 1 < sides; ++k)
            tetrahedra.push_back({apex, at[lowest], at[(lowest + k) % sides], at[(lowest + k + 1) % sides]});
    }
}

TetMesh make_tet_mesh(CellSoup soup) {
    TetMesh mesh;
    mesh.points = std::move(soup.points);
    mesh.scalars = std::move(soup.scalars);
    mesh.counts.cells = soup.shapes.size();
    mesh.cells.reserve(soup.shapes.size());
    std::vector<Tetrahedron> split;
    std::size_t first = 0;
    for (const CellShape shape : soup.shapes) {
        split.clear();
        split_cell(shape, std::span(soup.corners).subspan(first, corner_count(shape)), split);
        first += corner_count(shape);
        std::size_t right = 0, inverted = 0;
        for (Tetrahedron& cell : split) {
            const Turn turn = turn_right(mesh.points, cell);
            mesh.counts.flat += turn == Turn::kFlat;
            right += turn == Turn::kRight;
            inverted += turn == Turn::kInverted;
            if (turn != Turn::kFlat) mesh.cells.push_back(cell);
        }
        if (shape == CellShape::kTetrahedron)
            mesh.counts.inverted += inverted;
        else
            mesh.counts.folded += right > 0 && inverted > 0;
    }
    return mesh;
}

TetMesh make_tet_mesh(RegularGrid grid) {
    const std::size_t nx = grid.size[0], ny = grid.size[1], nz = grid.size[2];
    TRILENS_CHECK(nx >= 2 && ny >= 2 && nz >= 2 && grid.scalars.size() == nx * ny * nz,
                  "a grid has at least two points along each axis, and a scalar at each");
    TetMesh mesh;
    mesh.scalars = std::move(grid.scalars);
    mesh.points.reserve(mesh.scalars.size());
    for (std::size_t z = 0; z < nz; ++z)
        for (std::size_t y = 0; y < ny; ++y)
            for (std::size_t x = 0; x < nx; ++x)
                mesh.points.push_back(grid.origin + grid.steps * Vec3(x, y, z));
    mesh.counts.cells = (nx - 1) * (ny - 1) * (nz - 1);
    mesh.cells.reserve(6 * mesh.counts.cells);
    for (std::size_t z = 0; z + 1 < nz; ++z)
        for (std::size_t y = 0; y + 1 < ny; ++y)
            for (std::size_t x = 0; x + 1 < nx; ++x) {
                const auto at = [&](std::size_t i, std::size_t j, std::size_t k) {
                    return static_cast<Id>(((z + k) * ny + y + j) * nx + x + i);
                };
                const std::array<Id, 8> corners{at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0),
                                                at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)};
                split_cell(CellShape::kHexahedron, corners, mesh.cells);
            }
    for (Tetrahedron& cell : mesh.cells) turn_right(mesh.points, cell);
    return mesh;
}

}  // namespace trilens
