// Cages for tests: small ones by hand, and the shapes under data/cages.
#pragma once

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "base/description/optic_description.h"
#include "support/test.h"

namespace trilens_test {

using trilens::Cage;
using trilens::Vec3;

inline const std::vector<std::string>& cage_files() {
    static const std::vector<std::string> kFiles = {
        "catmark_car",           "catmark_cube",          "catmark_cube_creases0", "catmark_cube_creases1",
        "catmark_fan",           "catmark_gregory_test1", "catmark_helmet",        "catmark_hole_test1",
        "catmark_pawn",          "catmark_pole64",        "catmark_torus",         "catmark_torus_creases0",
        "catmark_val2_interior", "loop_cube_creases0",    "loop_icosahedron",      "loop_saddle_edgeonly"};
    return kFiles;
}

/// Reads what these files use: v, f, and tags of one crease edge, one corner, one hole or the boundary rule
/// each.
inline Cage read_cage(const std::string& name) {
    Cage cage;
    if (name.rfind("loop_", 0) == 0) cage.scheme = trilens::SubdivisionScheme::kLoop;
    std::ifstream file(data_dir() + "/cages/" + name + ".obj");
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string kind, word, counts;
        words >> kind;
        if (kind == "v") {
            Vec3 p;
            words >> p.x >> p.y >> p.z;
            cage.points.push_back(p);
        } else if (kind == "f") {
            int count = 0;
            for (; words >> word; ++count) cage.face_vertex_indices.push_back(std::stoi(word) - 1);
            cage.face_vertex_counts.push_back(count);
        } else if (kind == "t") {
            words >> word >> counts;
            int a = 0, b = 0;
            double sharpness = 0;
            if (word == "crease" && words >> a >> b >> sharpness) {
                cage.crease_indices.insert(cage.crease_indices.end(), {a, b});
                cage.crease_lengths.push_back(2);
                cage.crease_sharpnesses.push_back(sharpness);
            } else if (word == "corner" && words >> a >> sharpness) {
                cage.corner_indices.push_back(a);
                cage.corner_sharpnesses.push_back(sharpness);
            } else if (word == "hole" && words >> a) {
                cage.hole_indices.push_back(a);
            } else if (word == "interpolateboundary" && words >> a) {
                using trilens::InterpolateBoundary;
                cage.interpolate_boundary = a == 0   ? InterpolateBoundary::kNothing
                                            : a == 1 ? InterpolateBoundary::kEdgeAndCorner
                                                     : InterpolateBoundary::kEdgeOnly;
            }
        }
    }
    return cage;
}

inline Cage make_cage(std::vector<Vec3> points, const std::vector<std::vector<int>>& faces) {
    Cage cage;
    cage.points = std::move(points);
    for (const std::vector<int>& face : faces) {
        cage.face_vertex_counts.push_back(static_cast<int>(face.size()));
        cage.face_vertex_indices.insert(cage.face_vertex_indices.end(), face.begin(), face.end());
    }
    return cage;
}

/// A cube of side 2, faces counter-clockwise seen from outside; vertex = x + 2 y + 4 z (0 or 1 each).
inline Cage cube() {
    std::vector<Vec3> points;
    for (int i = 0; i < 8; ++i) points.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    return make_cage(points,
                     {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}});
}

inline void add_crease(Cage& cage, const std::vector<int>& chain, double sharpness) {
    cage.crease_indices.insert(cage.crease_indices.end(), chain.begin(), chain.end());
    cage.crease_lengths.push_back(static_cast<int>(chain.size()));
    cage.crease_sharpnesses.push_back(sharpness);
}

/// A prism over a regular polygon: n quads and two n-gons.
inline Cage prism(int n) {
    Cage cage;
    std::vector<std::vector<int>> faces(2);
    for (int i = 0; i < n; ++i) {
        const double angle = 2 * 3.14159265358979 * i / n;
        cage.points.emplace_back(std::cos(angle), std::sin(angle), -1);
        cage.points.emplace_back(std::cos(angle), std::sin(angle), 1);
        const int j = (i + 1) % n;
        faces.push_back({2 * i, 2 * j, 2 * j + 1, 2 * i + 1});
        faces[0].insert(faces[0].begin(), 2 * i);
        faces[1].push_back(2 * i + 1);
    }
    return make_cage(cage.points, faces);
}

/// A rectangle of nx x ny quads over [0, nx] x [0, ny], bent a little.
inline Cage sheet(int nx, int ny) {
    std::vector<Vec3> points;
    std::vector<std::vector<int>> faces;
    for (int y = 0; y <= ny; ++y)
        for (int x = 0; x <= nx; ++x) points.emplace_back(x, y, 0.3 * std::sin(1.3 * x) * std::cos(0.9 * y));
    for (int y = 0; y < ny; ++y)
        for (int x = 0; x < nx; ++x) {
            const int a = y * (nx + 1) + x;
            faces.push_back({a, a + 1, a + nx + 2, a + nx + 1});
        }
    return make_cage(points, faces);
}

/// Four quads around one edge: a cross in section.
inline Cage book() {
    std::vector<Vec3> points = {{0, 0, -1}, {0, 0, 1}};
    std::vector<std::vector<int>> faces;
    for (int k = 0; k < 4; ++k) {
        const double x = k == 0 ? 1.0 : k == 2 ? -1.2 : 0.1, y = k == 1 ? 1.0 : k == 3 ? -0.8 : 0.2;
        points.emplace_back(x, y, -1);
        points.emplace_back(x, y, 1);
        faces.push_back({0, 2 + 2 * k, 3 + 2 * k, 1});
    }
    return make_cage(points, faces);
}

/// A sheet with a quad that shares two edges with its neighbour at a vertex of two faces.
inline Cage folded() {
    Cage cage = sheet(3, 3);
    cage.points.emplace_back(1.4, 1.5, 0.5);
    const int a = 5, b = 6, c = 10, d = 9, v = 16;  // the middle quad, and a vertex inside it
    std::vector<std::vector<int>> faces = {{a, b, v, d}, {b, c, d, v}};
    for (int f = 0; f < 9; ++f)
        if (f != 4)
            faces.emplace_back(cage.face_vertex_indices.begin() + 4 * f,
                               cage.face_vertex_indices.begin() + 4 * f + 4);
    return make_cage(cage.points, faces);
}

inline std::vector<std::pair<std::string, Cage>> small_cages() {
    std::vector<std::pair<std::string, Cage>> cages = {
        {"cube", cube()},          {"prism 3", prism(3)}, {"prism 5", prism(5)}, {"sheet", sheet(4, 3)},
        {"one quad", sheet(1, 1)}, {"book", book()},      {"folded", folded()},  {"prism 9", prism(9)}};
    Cage edge_only = sheet(3, 3);
    edge_only.interpolate_boundary = trilens::InterpolateBoundary::kEdgeOnly;
    Cage creased = cube();
    add_crease(creased, {4, 5, 7, 6, 4}, 10);
    Cage semi = cube();
    add_crease(semi, {4, 5, 7, 6, 4}, 2.25);
    add_crease(semi, {0, 4}, 0.625);
    Cage cornered = cube();
    cornered.corner_indices = {0, 7};
    cornered.corner_sharpnesses = {10, 1.75};
    Cage bilinear = prism(5);
    bilinear.scheme = trilens::SubdivisionScheme::kBilinear;
    Cage creased_prism = prism(5);
    add_crease(creased_prism, {0, 2, 4, 6, 8, 0}, 10);
    Cage dart = folded();
    add_crease(dart, {6, 16}, 10);
    cages.insert(cages.end(), {{"edge only", edge_only},
                               {"creased", creased},
                               {"semi-sharp", semi},
                               {"cornered", cornered},
                               {"bilinear", bilinear},
                               {"creased prism", creased_prism},
                               {"dart", dart}});
    return cages;
}

/// A vertex of n quads, bent: n = 2 folds them onto each other's edges.
inline Cage wheel(int n) {
    std::vector<Vec3> points = {{0, 0, 0.4}};
    std::vector<std::vector<int>> faces;
    for (int i = 0; i < 2 * n; ++i) {
        const double angle = 3.14159265358979 * i / n, r = i % 2 ? 1.3 : 1;
        points.emplace_back(r * std::cos(angle), r * std::sin(angle), 0.2 * std::cos(2 * angle));
    }
    for (int i = 0; i < n; ++i) faces.push_back({0, 1 + 2 * i, 2 + 2 * i, 1 + (2 * i + 2) % (2 * n)});
    return make_cage(points, faces);
}

/// Two vertices of n triangles each over a polygon.
inline Cage bipyramid(int n) {
    std::vector<Vec3> points = {{0, 0, 1}, {0, 0, -1.2}};
    std::vector<std::vector<int>> faces;
    for (int i = 0; i < n; ++i) {
        const double angle = 2 * 3.14159265358979 * i / n;
        points.emplace_back(std::cos(angle), std::sin(angle), 0.1 * std::sin(3 * angle));
        const int a = 2 + i, b = 2 + (i + 1) % n;
        faces.insert(faces.end(), {{0, a, b}, {1, b, a}});
    }
    return make_cage(points, faces);
}

/// What the shapes on file have, made here: vertices of 2 to 12 faces, creases, corners, holes, boundaries,
/// triangles under Loop.
inline std::vector<std::pair<std::string, Cage>> made_cages() {
    std::vector<std::pair<std::string, Cage>> cages;
    for (int n = 2; n <= 12; ++n) cages.emplace_back("wheel " + std::to_string(n), wheel(n));
    for (int n = 3; n <= 12; ++n) {
        cages.emplace_back("bipyramid " + std::to_string(n), bipyramid(n));
        cages.emplace_back("loop bipyramid " + std::to_string(n), bipyramid(n));
        cages.back().second.scheme = trilens::SubdivisionScheme::kLoop;
    }
    Cage holed = sheet(4, 4);
    holed.hole_indices = {5, 10};
    Cage creased = bipyramid(7);
    add_crease(creased, {2, 3, 4, 5, 6, 7, 8, 2}, 10);
    Cage loop_creased = creased;
    loop_creased.scheme = trilens::SubdivisionScheme::kLoop;
    Cage cornered = wheel(5);
    cornered.corner_indices = {0, 2};
    cornered.corner_sharpnesses = {10, 10};
    Cage crossed = sheet(4, 4);
    add_crease(crossed, {10, 11, 12, 13, 14}, 10);
    add_crease(crossed, {2, 7, 12, 17, 22}, 3);
    cages.insert(cages.end(), {{"holed", holed},
                               {"creased bipyramid", creased},
                               {"loop creased bipyramid", loop_creased},
                               {"cornered wheel", cornered},
                               {"crossed creases", crossed}});
    return cages;
}

}  // namespace trilens_test
