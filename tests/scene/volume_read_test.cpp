// Volumes out of scene files: every source of cells, and what is refused or warned of.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "scene/data/scene_digest.h"
#include "scene/samples/volume_file.h"
#include "scene/scene_text.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr const char* kEven = R"({"points": [{"value": 0, "color": [1, 1, 1], "extinction": 1}]})";
constexpr const char* kTet = R"("points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "scalars": [0, 1, 2, 3])";

std::string volume_scene(const std::string& volume, const std::string& transfer = kEven) {
    return R"({"version": 1, "cameras": [{"yfov": 40, "lookAt": {"eye": [0, 1, 4], "at": [0, 0, 0]}}],
        "volumes": [{)" +
           volume + R"(, "transferFunction": )" + transfer + "}]}";
}

std::string volume_refusal(const std::string& volume, const std::string& transfer = kEven) {
    return error_of(volume_scene(volume, transfer));
}

/// A file in a folder of the test's own, and a scene beside it.
std::string file_with(const std::string& name, const std::string& bytes) {
    const std::string path = scratch_dir("volume_read_" + name) + "/" + name;
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
}

std::string message_of(const std::string& name, const std::string& bytes, const std::string& more = "") {
    return volume_refusal("\"file\": \"" + file_with(name, bytes) + "\"" + more);
}

std::string vtk(const std::string& cells, const std::string& data) {
    return "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n"
           "POINTS 5 float\n0 0 0 1 0 0 0 1 0\n0 0 1 1 1 1\n" +
           cells + data;
}

/// As if nothing were packed.
bool copied(std::string_view packed, std::span<char> to) {
    if (packed.size() < to.size()) return false;
    std::copy_n(packed.begin(), to.size(), to.begin());
    return true;
}

constexpr const char* kCells = "CELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\n";
constexpr const char* kData = "POINT_DATA 5\nSCALARS heat float\nLOOKUP_TABLE default\n0 1 2 3 4\n";

}  // namespace

TEST_CASE("inline cells of all shapes are read, in the world", "[scene]") {
    const Scene scene = load_text(
        volume_scene(std::string(kTet) +
                     R"(, "cells": [[0,1,2,3]], "name": "cloud", "transform": {"scale": [-1, 2, 1]})"));
    REQUIRE(scene.volumes.size() == 1);
    const Volume& volume = scene.volumes[0];
    CHECK(volume.name == "cloud");
    CHECK(volume.cells->points[1] == Vec3(-1, 0, 0));
    const Tetrahedron& cell = volume.cells->cells.at(0);
    const Vec3& a = volume.cells->points[cell[0]];
    CHECK(dot(cross(volume.cells->points[cell[1]] - a, volume.cells->points[cell[2]] - a),
              volume.cells->points[cell[3]] - a) > 0);
    CHECK(scene.warnings.empty());

    const Scene boxes = load_text(volume_scene(
        R"("points": [[0,0,0],[1,0,0],[1,1,0],[0,1,0],[0,0,1],[1,0,1],[1,1,1],[0,1,1],[0.5,0.5,2]],
        "scalars": [0,0,0,0,1,1,1,1,5], "cells": [[0,1,2,3,4,5,6,7],[4,5,6,7,8]], "fit": {"size": 4})"));
    CHECK(boxes.volumes[0].cells->cells.size() == 8);
    CHECK(boxes.volumes[0].cells->counts.cells == 2);
    CHECK(boxes.volumes[0].cells->points[8].z == Approx(2));
    CHECK(scene_digest(scene) != scene_digest(boxes));
}

TEST_CASE("bad inline cells are refused with their place", "[scene]") {
    CHECK(contains(volume_refusal(std::string(kTet) + R"(, "cells": [[0,1,2,4]])"), "/volumes/0/cells/0/3"));
    CHECK(contains(volume_refusal(std::string(kTet) + R"(, "cells": [[0,1,2,3,3,3,3]])"),
                   "4, 5, 6 or 8 corners"));
    CHECK(contains(
        volume_refusal(
            R"("points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "scalars": [0,1,2,3,4], "cells": [[0,1,2,3]])"),
        "/volumes/0/scalars"));
    CHECK(contains(
        volume_refusal(
            R"("points": [[0,0,0],[1,0,0],[0,1,0],[1,1,0]], "scalars": [0,1,2,3], "cells": [[0,1,2,3]])"),
        "no cell with a volume"));
    CHECK(contains(volume_refusal(R"("name": "empty")"), "/volumes/0"));
    CHECK(contains(volume_refusal(std::string(kTet) + R"(, "cells": [[0,1,2,3]], "file": "x.vtk")"),
                   "/volumes/0"));
}

TEST_CASE("cells that are turned, flat or apart are warned of by number", "[scene]") {
    const Scene scene = load_text(volume_scene(
        R"("points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1],[1,1,0]], "scalars": [0,1,2,3,4], "cells": [[0,2,1,3],[0,1,2,4]])"));
    REQUIRE(scene.warnings.size() == 2);
    CHECK(contains(scene.warnings[0], "1 tetrahedra are inverted"));
    CHECK(contains(scene.warnings[1], "1 tetrahedra have no volume"));
    // Two cells with a seam: points of their own where they touch.
    const Scene seam = load_text(volume_scene(
        R"("points": [[0,0,0],[1,0,0],[0,1,0],[0,0,1],[0,0,0],[1,0,0],[0,1,0],[0,0,-1]], "scalars": [0,1,2,3,0,1,2,3],
           "cells": [[0,1,2,3],[4,6,5,7]])"));
    REQUIRE(seam.warnings.size() == 1);
    CHECK(contains(seam.warnings[0], "2 faces touch a cell"));
}

TEST_CASE("transfer functions are points or a map, and their values rise", "[scene]") {
    const std::string cells = std::string(kTet) + R"(, "cells": [[0,1,2,3]])";
    const Scene scene = load_text(volume_scene(cells, R"({"map": "heat", "extinction": 6})"));
    const std::vector<TransferPoint>& points = scene.volumes[0].transfer.points;
    REQUIRE(points.size() == 4);
    CHECK(points.front().value == 0);
    CHECK(points.back().value == 3);
    CHECK(points[1].color == Vec3(1, 0, 0));
    CHECK(points[1].extinction == Approx(2));
    CHECK(contains(volume_refusal(cells, R"({"map": "jet", "extinction": 6})"),
                   "/volumes/0/transferFunction/map"));
    CHECK(contains(volume_refusal(cells, R"({"map": "heat"})"),
                   "/volumes/0/transferFunction: 'map' needs 'extinction' beside it"));
    CHECK(contains(volume_refusal(cells, "{}"), "needs one of 'points' and 'map'"));
    CHECK(
        contains(volume_refusal(cells, R"({"map": "heat", "extinction": 1, "range": [2, 2]})"), "must rise"));
    CHECK(contains(volume_refusal(cells, R"({"points": [{"value": 1, "color": [1,1,1], "extinction": 1},
                                                 {"value": 1, "color": [1,1,1], "extinction": 2}]})"),
                   "/volumes/0/transferFunction/points/1/value"));
    CHECK(contains(volume_refusal(cells, R"({"points": [{"value": 1, "color": [1,1,1], "extinction": -1}]})"),
                   "/volumes/0/transferFunction/points/0/extinction"));
}

TEST_CASE("grids are read inline, and their sizes hold", "[scene]") {
    const Scene scene = load_text(volume_scene(
        R"("grid": {"size": [2,2,2], "origin": [1,0,0], "spacing": [2,1,1], "scalars": [0,1,2,3,4,5,6,7]})"));
    CHECK(scene.volumes[0].cells->cells.size() == 6);
    CHECK(scene.volumes[0].cells->points[1] == Vec3(3, 0, 0));
    CHECK(contains(volume_refusal(R"("grid": {"size": [2,2,3], "scalars": [0,1,2,3,4,5,6,7]})"),
                   "/volumes/0/grid/scalars"));
    CHECK(contains(volume_refusal(R"("grid": {"size": [1,2,2], "scalars": [0,1,2,3,4,5,6,7]})"),
                   "/volumes/0/grid/size"));
    CHECK(contains(volume_refusal(R"("grid": {"size": [2,2,2], "type": "uint8"})"), "/volumes/0/grid/type"));
    // What would not fit is refused before anything is read.
    CHECK(
        contains(volume_refusal(R"("file": "none.raw", "grid": {"size": [4000,4000,4000], "type": "uint8"})"),
                 "more than 50000000"));
}

TEST_CASE("samples as they lie in memory are read in every type", "[scene]") {
    const std::string bytes("\x00\x01\x00\x02\x00\x03\x00\x04\x00\x05\x00\x06\x00\x07\x80\x08", 16);
    const std::string file = "\"file\": \"" + file_with("numbers.raw", bytes) + "\"";
    const auto scalars = [&](const std::string& grid) {
        return load_text(volume_scene(file + R"(, "grid": {"size": [2,2,2], )" + grid + "}"))
            .volumes[0]
            .cells->scalars;
    };
    CHECK(scalars(R"("type": "uint16", "endian": "big")")[7] == 0x8008);
    CHECK(scalars(R"("type": "int16", "endian": "big")")[7] == 0x8008 - 0x10000);
    CHECK(scalars(R"("type": "uint16")")[0] == 0x0100);
    CHECK(scalars(R"("type": "uint8", "skip": 8)")[1] == 5);
    CHECK(contains(volume_refusal(file + R"(, "grid": {"size": [2,2,2], "type": "uint8"})"),
                   "16 bytes of samples"));
    CHECK(contains(volume_refusal(file + R"(, "grid": {"size": [2,2,2], "type": "float"})"), "are 32"));
    for (const char* skip : {"7", "9", "17"})
        CHECK(contains(
            volume_refusal(file + R"(, "grid": {"size": [2,2,2], "type": "uint8", "skip": )" + skip + "}"),
            std::string(" bytes of samples after the ") + skip + " skipped, but 2 x 2 x 2"));
}

TEST_CASE("VTK's legacy files are read, of both ways to write cells", "[scene]") {
    const VolumeFile old = parse_vtk(vtk(kCells, kData), "a.vtk", "");
    const auto& soup = std::get<CellSoup>(old.cells);
    CHECK(old.field == "heat");
    CHECK(soup.shapes.size() == 2);
    CHECK(soup.scalars[4] == 4);
    const VolumeFile recent = parse_vtk(vtk("CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY "
                                            "vtktypeint64\n0 1 2 3\n1 2 3 4\nCELL_TYPES 2\n10\n10\n",
                                            "POINT_DATA 5\nFIELD FieldData 2\nvelocity 3 5 float\n0 0 0 0 0 "
                                            "0 0 0 0 0 0 0 0 0 0\npressure 1 5 "
                                            "float\n9 8 7 6 5\nMETADATA\nINFORMATION 0\n\n"),
                                        "b.vtk", "pressure");
    CHECK(std::get<CellSoup>(recent.cells).corners == soup.corners);
    CHECK(std::get<CellSoup>(recent.cells).scalars[0] == 9);
    const VolumeFile grid = parse_vtk(
        "# vtk DataFile Version 2.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 1 2 "
        "3\nSPACING .5 "
        "1 1\nPOINT_DATA 8\nSCALARS s float 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7\n",
        "c.vtk", "");
    CHECK(std::get<RegularGrid>(grid.cells).origin == Vec3(1, 2, 3));
    CHECK(std::get<RegularGrid>(grid.cells).steps[0] == Vec3(0.5, 0, 0));
    const VolumeFile mixed =
        parse_vtk(vtk("CELLS 2 9\n4 0 1 2 3\n3 1 2 3\nCELL_TYPES 2\n10 5\n", kData), "d.vtk", "");
    REQUIRE(mixed.warnings.size() == 1);
    CHECK(begins_with(mixed.warnings[0], "1 cells are no tetrahedra"));
}

TEST_CASE("bad VTK files are refused with the line", "[scene]") {
    CHECK(contains(message_of("a.vtk", "solid\n"), "begin with '# vtk DataFile Version'"));
    CHECK(contains(message_of("a.vtk", "# vtk DataFile Version 3.0\nt\nEBCDIC\nDATASET UNSTRUCTURED_GRID\n"),
                   "neither ASCII nor BINARY"));
    CHECK(contains(message_of("a.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n"),
                   "POLYDATA"));
    CHECK(contains(message_of("a.vtk", vtk("CELLS 2 10\n4 0 1 2 3\n4 1 2 3 9\nCELL_TYPES 2\n10 10\n", kData)),
                   "names point 9"));
    CHECK(contains(message_of("a.vtk", vtk("CELLS 2000000 10000000\n4 0 1 2 3\n", "")), "too short"));
    CHECK(
        contains(message_of("a.vtk", vtk("CELLS 1 5\n3 0 1 2\nCELL_TYPES 1\n10\n", kData)), "has 3 corners"));
    CHECK(contains(
        message_of("a.vtk", vtk(kCells, "POINT_DATA 4\nSCALARS heat float\nLOOKUP_TABLE default\n0 1 2 3\n")),
        "data of 4 points, but 5"));
    CHECK(contains(
        message_of("a.vtk",
                   vtk(kCells, "POINT_DATA 5\nSCALARS heat float\nLOOKUP_TABLE default\n0 1 nan 3 4\n")),
        "not finite at point 2"));
    CHECK(contains(message_of("a.vtk", vtk(kCells, "")), "no field of one component"));
    CHECK(contains(message_of("a.vtk", vtk(kCells, kData), ", \"field\": \"density\""), "it has 'heat'"));
    CHECK(contains(
        message_of("a.vtk", vtk(kCells, "CELL_DATA 2\nSCALARS q float\nLOOKUP_TABLE default\n1 2\n")),
        "data of cells are not read"));
    CHECK(contains(
        message_of("a.vtk", vtk(kCells, "POINT_DATA 5\nSCALARS heat float\nLOOKUP_TABLE default\n0 1 2\n")),
        "too short"));
    CHECK(contains(message_of("a.vtk", vtk(kCells,
                                           "POINT_DATA 5\nSCALARS heat float\nLOOKUP_TABLE default\n"
                                           "0.125 1.125 2.125\n")),
                   "ends where a number must stand"));
    CHECK(contains(message_of("a.vtu", "<VTKFile>"), "holds ''; UnstructuredGrid is read"));
    CHECK(contains(message_of("a.obj", "v 0 0 0"), "neither .vtk, .vtu, .nrrd nor .nhdr"));
}

TEST_CASE("NRRDs are read, attached, detached and as text, and refused with the line", "[scene]") {
    const std::string head = "NRRD0004\n# a comment\ntype: uchar\ndimension: 3\nsizes: 2 2 2\n";
    const auto none = [](const std::string&) { return std::string(); };
    const RegularGrid grid = parse_nrrd(head + "spacings: 1 2 3\nspace origin: (1,0,-1)\nencoding: raw\n\n" +
                                            std::string("\0\1\2\3\4\5\6\7", 8),
                                        "a.nrrd", none, copied);
    CHECK(grid.scalars[7] == 7);
    CHECK(grid.steps[2] == Vec3(0, 0, 3));
    CHECK(grid.origin == Vec3(1, 0, -1));
    // The place of the first sample along each axis, or where its cell begins.
    for (const auto& [centers, origin] :
         {std::pair("", Vec3(5, 6, 7)), {"centers: cell node cell\n", Vec3(5.5, 6, 8.5)}}) {
        const RegularGrid moved = parse_nrrd(
            head + centers + "axis mins: 5 6 7\nspacings: 1 2 3\nencoding: ascii\n\n0 1 2 3\n4 5 6 7\n",
            "m.nrrd", none, copied);
        CHECK(moved.origin == origin);
        CHECK(moved.steps[1] == Vec3(0, 2, 0));
    }
    CHECK_THROWS_WITH(
        parse_nrrd(head + "axis mins: 1 2\nencoding: ascii\n\n0 1 2 3 4 5 6 7\n", "m.nrrd", none, copied),
        ContainsSubstring("'axis mins' must have three entries"));
    const RegularGrid turned =
        parse_nrrd(head + "space directions: (0,1,0) (1,0,0) (0,0,2)\nencoding: ascii\n\n0 1 2 3\n4 5 6 7\n",
                   "b.nrrd", none, copied);
    CHECK(turned.steps[0] == Vec3(0, 1, 0));
    CHECK(turned.scalars[5] == 5);
    const RegularGrid detached = parse_nrrd(
        head + "encoding: raw\ndata file: b.raw\n", "c.nhdr",
        [](const std::string& name) {
            CHECK(name == "b.raw");
            return std::string(8, '\3');
        },
        copied);
    CHECK(detached.scalars[3] == 3);
    const RegularGrid packed = parse_nrrd(head + "encoding: gzip\nbyte skip: 2\n\nxx" + std::string(8, '\5'),
                                          "d.nrrd", none, copied);
    CHECK(packed.scalars == std::vector<double>(8, 5));
    CHECK(contains(message_of("a.nrrd", head + "encoding: gzip\n\nxx"),
                   "no gzip stream of 8 bytes, as its sizes say"));
    CHECK(contains(message_of("a.nrrd", head + "encoding: bzip2\n\nxx"), "'bzip2' are not read"));
    CHECK(contains(message_of("a.nrrd", head + "encoding: raw\n\nxx"), "2 bytes of samples"));
    CHECK(contains(message_of("a.nrrd", "NRRD0004\ntype: block\n"), "line 2"));
    CHECK(contains(message_of("a.nrrd", "NRRD0004\ndimension: 2\n"), "three are read"));
    CHECK(
        contains(message_of("a.nrrd", "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n"),
                 "need 'endian'"));
    const float bad = std::numeric_limits<float>::quiet_NaN();
    std::string floats(reinterpret_cast<const char*>(&bad), 4);
    floats = std::string(12, '\0') + floats + std::string(16, '\0');
    CHECK(contains(message_of("a.nrrd",
                              "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nencoding: raw\nendian: "
                              "little\n\n" +
                                  floats),
                   "sample 1, 1, 0 is not finite"));
}
