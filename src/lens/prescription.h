// Lenses as optical prescriptions: rows of surfaces, each with what follows it, along an axis that mirrors
// fold back and tilts bend.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "base/description/lens_side.h"
#include "base/description/optic_description.h"
#include "base/util/names.h"
#include "lens/pose.h"

namespace trilens {

/// What lies behind a surface: air, where its name is empty.
struct Glass {
    std::string name = {};
    double index = 1;                 // at the d line, 587.6 nm
    double abbe = 0;                  // (n_d - 1) / (n_F - n_C); 0: the same index at all lines
    double index_c = 0, index_f = 0;  // where they are known by themselves; 0: by the Abbe number
    std::string fault = {};           // of a catalogue's: why none can be made of it; empty: it can

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

/// Where n_F and n_C are not known, they lie beside n_d as those of a glass of this Abbe number on Schott's
/// normal line, through K7 and F2, of the partial dispersion (n_F - n_d) / (n_F - n_C): for most glasses to
/// 5e-5. (A scene's material has both equally far from n_d.)
double index_at(const Glass& glass, SpectralLine line);

/// A surface, and what follows it. Behind an odd number of mirrors light runs against the axis, and
/// thicknesses are negative.
struct LensRow {
    LensSide side = {.aperture = 0};  // aperture 0: not given
    double thickness = 0;  // to the next surface's vertex; of the last one: to the image, 0: not given
    Glass glass = {};      // of a mirror: none
    bool stop = false;
    std::string place = {};  // where it stands, for messages: "line 12", "/surfaces/2"
    bool mirror = false;     // light stays in what it came through
    double hole = 0;         // radius of what it lets by in its middle
    double obscuration = 0;  // radius of what stops light in its middle, on the side that air is on
    LensPose before = {};    // its frame in that which the row before it leads to
    LensPose after = {};     // the frame in which its thickness is measured, in its own
};

struct LensPrescription {
    std::string name;
    std::string file;  // for messages
    std::vector<LensRow> rows;
    LensPose image = {};  // as a row's `before`
};

/// How the axis goes on behind a tilted row: as the row has it, as it came, along what a mirror there
/// reflects of it, or, of a row that is not tilted itself, tilted backwards.
enum class AxisBehind { kFollows, kReturns, kBends, kReverses };

template <>
struct EnumNames<AxisBehind> {
    static constexpr std::array kTable{NamedValue<AxisBehind>{AxisBehind::kFollows, "follows"},
                                       NamedValue<AxisBehind>{AxisBehind::kReturns, "returns"},
                                       NamedValue<AxisBehind>{AxisBehind::kBends, "bends"},
                                       NamedValue<AxisBehind>{AxisBehind::kReverses, "reverses"}};
};

struct LensTilt {
    Vec3 decentre{0};
    Vec3 degrees{0};  // then, as tilted() turns
    AxisBehind behind = AxisBehind::kFollows;
};

/// Sets the row's frames.
void tilt_row(LensRow& row, const LensTilt& tilt);

/// The frames of all rows, and of the image, in that of the first row as it would be without a tilt of its
/// own; the thickness of the last row leads to the image.
std::vector<LensPose> lens_poses(const LensPrescription& lens);

/// Whether nothing is tilted or decentred.
bool is_centred(const LensPrescription& lens);

/// Whether all sides are of revolution.
bool is_round(const LensPrescription& lens);

/// The lens whose sides are of revolution and have the profiles that the plane cuts out of this one's.
LensPrescription section_of(const LensPrescription& lens, LensSection section);

/// What light goes through, and whether along the axis (1) or against it (-1).
struct LensMedium {
    Glass glass = {};
    double sense = 1;
};

/// Before the first row, and behind each.
std::vector<LensMedium> lens_media(const LensPrescription& lens);

/// The row that is the stop: the one that says so, else the first.
std::size_t stop_row(const LensPrescription& lens);

/// Throws InputError with the file and the place of the row where there are no rows, neither glass nor
/// mirror, two stops, glass behind the last surface, a thickness in glass that is not along the light, or one
/// in air of a lens that is centred, an aperture that reaches to where its side turns back (see
/// kLeastRimRoom), or an obscuration of which no shell can be made (see lens_obscurations).
void check_prescription(const LensPrescription& lens);

/// Why no bodies can be made of a lens: `what` holds of the row and what comes next.
struct LensFault {
    std::size_t row = 0;
    std::string what = {};
};

/// Glass whose sides no lens can have (see lens_fault), and lenses that stand in the next one: within the
/// rims of both, their sides cross in the air between them. What has no aperture, is tilted against the next
/// surface or has a mirror before the next lens is not looked at. Of a checked prescription.
std::vector<LensFault> lens_faults(const LensPrescription& lens);

/// A body of a lens, of glass from row `first` to the next, or behind a mirror. Its front's vertex is the
/// origin of its frame.
struct LensElement {
    std::size_t first = 0;
    LensPose pose = {};
    LensPrimitive shape = {};
    LensMedium medium = {};
    bool is_mirror = false;
};

/// All bodies in order, each once however often light comes through; those that are cemented have one side in
/// common. A mirror's body is flat behind, and as thick there as a quarter of its aperture; on glass
/// (Mangin's) it has a side in common with it. Throws InputError with the place of a row that has no
/// aperture, of which no body can be made (see lens_fault), of glass whose sides are tilted against each
/// other, of a mirror on glass that light leaves by another side than it came in by, and of a lens that
/// stands in the next one (see lens_faults).
std::vector<LensElement> lens_elements(const LensPrescription& lens);

/// Corners of a ring of an obscuration's shell; it has a quarter as many rings.
inline constexpr int kShellSegments = 128;

/// An opaque shell over a row's obscuration, with its front's vertex at the origin of its frame.
struct LensObscuration {
    std::size_t row = 0;
    LensPose pose = {};
    LensPrimitive shape = {};
};

/// All that can be made: between glass and glass there is no place for one. The shells are as thick as a
/// thousandth of their radius, on steep sides more, and as far from the surface, on the side that light comes
/// from where air is there.
std::vector<LensObscuration> lens_obscurations(const LensPrescription& lens);

/// From the first surface's vertex to that of `row`, along the axis; tilts and decentres are not looked at.
double vertex_of(const LensPrescription& lens, std::size_t row);

// The catalogue of glasses: index and Abbe number at the d line, as their makers publish them.

/// The glass of that name, in letters of any case; older names without N- are glasses of their own. `name`
/// may also be a code of n_d - 1 and V_d: "517642" and "517.642" are n_d 1.517 and V_d 64.2, "516800.641700"
/// has more digits. `more` come before the catalogue. Throws InputError(file, place) with the nearest known
/// name where it is neither, and with the glass' fault where it has one.
Glass find_glass(const std::string& name, const std::string& file, const std::string& place,
                 std::span<const Glass> more = {});

/// All names of the catalogue, sorted.
std::vector<std::string> glass_names();

}  // namespace trilens
