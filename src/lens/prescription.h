// Lenses as optical prescriptions: rows of surfaces about one axis, each with what follows it.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "base/description/lens_side.h"
#include "base/description/optic_description.h"

namespace trilens {

/// What lies behind a surface: air, where its name is empty.
struct Glass {
    std::string name = {};
    double index = 1;  // at the d line, 587.6 nm
    double abbe = 0;   // (n_d - 1) / (n_F - n_C); 0: the same index at all lines

    bool is_air() const { return name.empty(); }
};

/// Lines of the spectrum at which rays are traced: hydrogen's C (656.3 nm) and F (486.1 nm), helium's d
/// (587.6 nm).
enum class SpectralLine { kC, kD, kF };

template <>
struct EnumNames<SpectralLine> {
    static constexpr std::array kTable{NamedValue<SpectralLine>{SpectralLine::kD, "d"},
                                       NamedValue<SpectralLine>{SpectralLine::kC, "C"},
                                       NamedValue<SpectralLine>{SpectralLine::kF, "F"}};
};

/// By index and Abbe number alone, as scenes have it: n_F and n_C lie equally far from n_d.
double index_at(const Glass& glass, SpectralLine line);

/// A surface, and what follows it.
struct LensRow {
    LensSide side = {.aperture = 0};  // aperture 0: not given
    double thickness = 0;  // to the next surface's vertex; of the last one: to the image, 0: not given
    Glass glass = {};
    bool stop = false;
    std::string place = {};  // where it stands, for messages: "line 12", "/surfaces/2"
};

struct LensPrescription {
    std::string name;
    std::string file;  // for messages
    std::vector<LensRow> rows;
};

/// The row that is the stop: the one that says so, else the first.
std::size_t stop_row(const LensPrescription& lens);

/// Throws InputError with the file and the place of the row where there are no rows, no glass, two stops,
/// glass behind the last surface, or a thickness that is negative or, in glass, not positive.
void check_prescription(const LensPrescription& lens);

/// A body of glass of a lens, from row `first` to the next; its front's vertex is at `z` from the first
/// row's.
struct LensElement {
    std::size_t first = 0;
    double z = 0;
    LensPrimitive shape;
    Glass glass;
};

/// All bodies in order; those that are cemented have one side in common. Throws InputError with the place of
/// a row that has no aperture, or of which no body can be made (see lens_fault).
std::vector<LensElement> lens_elements(const LensPrescription& lens);

/// From the first surface's vertex to that of `row`.
double vertex_of(const LensPrescription& lens, std::size_t row);

// The catalogue of glasses: index and Abbe number at the d line, as their makers publish them.

/// The glass of that name; older names without N- are glasses of their own. `name` may also be a code of n_d
/// - 1 and V_d: "517642" and "517.642" are n_d 1.517 and V_d 64.2, "516800.641700" has more digits. Throws
/// InputError(file, place) with the nearest known name where it is neither.
Glass find_glass(const std::string& name, const std::string& file, const std::string& place);

/// All names of the catalogue, sorted.
std::vector<std::string> glass_names();

}  // namespace trilens
