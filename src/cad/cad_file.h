// STEP and IGES, the files of computer-aided design [ISO 10303-21; ANSI US PRO/IPO-100]: their faces as NURBS
// surfaces and as triangles.
#pragma once

#include <trilens/types.h>

#include <array>
#include <string>
#include <vector>

namespace trilens {

/// A NURBS surface whole, as a scene's patch of type `nurbs` has it: control points row by row, u along a
/// row; the front is where du x dv points.
struct CadSurface {
    int columns = 0;
    std::vector<Vec3> points;
    std::vector<double> weights;
    std::array<int, 2> degree{};
    std::array<std::vector<double>, 2> knots;
};

/// A face; of a solid its front is outwards.
struct CadFace {
    std::string fault;                 // why no surfaces could be made of it; empty: they were
    std::vector<CadSurface> surfaces;  // a flat face that is no rectangle has one per side
    double covered = 1;                // of the surfaces' area what the face has: below 1 where it is trimmed
    std::vector<Vec3> points;          // of its triangles, which keep its trims
    std::vector<std::array<int, 3>> triangles;  // counter-clockwise seen from its front
};

struct CadBody {
    std::string name;  // of the file, or "body 1"
    bool is_solid = false;
    std::vector<CadFace> faces;
};

struct CadModel {
    std::vector<CadBody> bodies;
    std::vector<std::string> warnings;  // of what was left out
};

/// What a file has: its solids, then its shells and faces that are in none, in the file's order, in
/// millimetres. `deviation`: how far triangles may lie off their face, as a
/// share of the file's size, above 0. Throws InputError with the file's name where it cannot be read, is
/// neither STEP (.step, .stp) nor IGES (.iges, .igs), has no face, or goes beyond 1e30.
CadModel read_cad_file(const std::string& file, double deviation);

}  // namespace trilens
