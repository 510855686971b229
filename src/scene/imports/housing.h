// Calibrated cameras behind ports, as other programs write them: Calibmar's calibration.yaml and the
// cameras.txt of COLMAP with refraction. Based on: She, Naujoks, Köser and Weber, Refractive geometry for
// underwater domes (ISPRS 2022); Jordt-Sedlazeck and Koch, Refractive calibration of underwater cameras (ECCV
// 2012).
#pragma once

#include <string>

#include "json/json.h"

namespace trilens {

/// Whether a file's name ends as theirs: .yaml, .yml or .txt.
bool is_housing_name(const std::string& file);

/// The scene: a camera for each that the file has, all at the origin, looking along +Z with +Y downward
/// (their own frame), and the port before it as optics. A flat port (FLATPORT: Nx, Ny, Nz, distance,
/// thickness, indices of air, glass and water) is two planes; a dome (DOMEPORT: Cx, Cy, Cz, radius,
/// thickness, likewise) a ball of air in a ball of glass. Outside the bodies lies a vacuum: indices are told
/// relative to what is there, air of a flat port and water of a dome. `file` is for messages. Throws
/// InputError with the line for what is missing, unknown or no number, and where two cameras have different
/// ports.
Json scene_of_housing(const std::string& text, const std::string& file);

}  // namespace trilens
