// Lens files of optics programs: sequential systems of Zemax (.zmx) and CODE V (.seq), as far as they are
// refracting and reflecting surfaces that are read, and their glass catalogues (.agf).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lens/prescription.h"

namespace trilens {

/// Parses a Zemax file, UTF-8 or UTF-16: of each surface TYPE (STANDARD, EVENASPH, BICONICX, TOROIDAL,
/// QED_TYPE, COORDBRK), CURV, CONI, DISZ, GLAS, DIAM, CLAP, PARM, XDAT and STOP; object and image are left
/// out, what is said of anything else is not looked at. The rim is the smaller one of DIAM's and CLAP's
/// second radius, CLAP's first one a hole. `glasses` come before those of the catalogue. Throws
/// InputError(file, "line n") for surfaces of other types, other apertures and obscurations, glass that is
/// not known, and numbers that are none.
LensPrescription parse_zemax(const std::string& bytes, const std::string& file,
                             std::span<const Glass> glasses = {});

/// Parses a CODE V sequence: SO, S and SI with radius (after CUM: curvature), thickness and glass, RDY, CUY,
/// THI, GLA, RMD, CIR (CLR, EDG, HOL), STO, K, A to G, YTO, XTO and AAS with RDX, CUX, KX and KY, XDE to CDE
/// with DAR, BEN and REV (also of the image), and private glasses (PRV). Throws as parse_zemax, and for
/// commands that name their surface (K S2 -1), forms that a surface has beside another, and AAS without RDX
/// or CUX.
LensPrescription parse_code_v(const std::string& bytes, const std::string& file,
                              std::span<const Glass> glasses = {});

/// Parses a glass catalogue of Zemax (.agf), UTF-8 or UTF-16: of each glass its name and its formula,
/// Schott's (1) or Sellmeier's (2); of other formulas index and Abbe number. Glasses without an index have a
/// fault that says so with their line. Throws InputError(file, "line n") for numbers that are none and files
/// without a glass.
std::vector<Glass> parse_agf(const std::string& bytes, const std::string& file);

}  // namespace trilens
