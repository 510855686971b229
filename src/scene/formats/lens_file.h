// Lens files of optics programs: sequential systems of Zemax (.zmx) and CODE V (.seq), as far as they are
// refracting surfaces about one axis.
#pragma once

#include <string>

#include "lens/prescription.h"

namespace trilens {

/// Parses a Zemax file, UTF-8 or UTF-16: of each surface TYPE (STANDARD, EVENASPH), CURV, CONI, DISZ, GLAS,
/// DIAM, PARM and STOP; object and image are left out, what is said of anything else is not looked at. Throws
/// InputError(file, "line n") for surfaces of other types, mirrors, glass that the catalogue does not have,
/// and numbers that are none.
LensPrescription parse_zemax(const std::string& bytes, const std::string& file);

/// Parses a CODE V sequence: SO, S and SI with radius (after CUM: curvature), thickness and glass, RDY, CUY,
/// THI, GLA, CIR, STO, K and A to G. Throws as parse_zemax, and for commands that tilt, decenter or reflect.
LensPrescription parse_code_v(const std::string& bytes, const std::string& file);

}  // namespace trilens
