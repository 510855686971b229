// Paraxial optics of a lens, and its primary aberrations by Seidel's sums (Welford, Aberrations of Optical
// Systems, 1986, chapters 6 and 8). Objects are at infinity, air is on both sides. Mirrors turn the index'
// sign; tilts and decentres are not looked at, as if the lens were unfolded. Of biconics and toric sides the
// section in the plane of y is taken, as if it were turned about the axis; section_of() gives that of x.
#pragma once

#include <array>
#include <vector>

#include "lens/prescription.h"

namespace trilens {

/// A number of a struct, by the name that JSON and Python have for it.
template <typename T>
struct NamedNumber {
    const char* name;
    double T::*number;
};

/// A paraxial ray as it leaves a surface: its height there, and the slope behind it.
struct ParaxialPlace {
    double height = 0, slope = 0;
};

/// The ray that comes to the first surface with that height and slope, at each row.
std::vector<ParaxialPlace> paraxial_ray(const LensPrescription& lens, const ParaxialPlace& start,
                                        SpectralLine line = SpectralLine::kD);

/// Lengths in the prescription's units. What counts from the first surface's vertex grows along the axis,
/// what counts from the last's too; places at infinity are infinite.
struct FirstOrder {
    double focal_length = 0;       // positive: it gathers light
    double back_focal_length = 0;  // from the last vertex to the image of what is at infinity; along z
    double front_focus = 0;        // from the first vertex to what is imaged to infinity
    double front_principal = 0;    // plane, from the first vertex
    double back_principal = 0;     // plane, from the last vertex
    double entrance_pupil = 0;     // the stop seen from the front, from the first vertex
    double exit_pupil = 0;         // the stop seen from behind, from the last vertex
    double entrance_radius = 0;    // of the pupils, of the stop's aperture; 0: that is not given
    double exit_radius = 0;
    double f_number = 0;        // focal length over the entrance pupil's diameter; 0: not known
    double length = 0;          // from the first vertex to the last
    double petzval_radius = 0;  // of the image of a plane at infinity, if it had no astigmatism
};

inline constexpr std::array<NamedNumber<FirstOrder>, 12> kFirstOrderNumbers{
    {{"focal_length", &FirstOrder::focal_length},
     {"back_focal_length", &FirstOrder::back_focal_length},
     {"front_focus", &FirstOrder::front_focus},
     {"front_principal", &FirstOrder::front_principal},
     {"back_principal", &FirstOrder::back_principal},
     {"entrance_pupil", &FirstOrder::entrance_pupil},
     {"exit_pupil", &FirstOrder::exit_pupil},
     {"entrance_radius", &FirstOrder::entrance_radius},
     {"exit_radius", &FirstOrder::exit_radius},
     {"f_number", &FirstOrder::f_number},
     {"length", &FirstOrder::length},
     {"petzval_radius", &FirstOrder::petzval_radius}}};

/// The section along y, or that along x where the lens gathers nothing along y, as a cylinder may.
LensSection imaging_section(const LensPrescription& lens);

/// Throws InputError where the lens has no focal length along y (its last ray runs along the axis).
FirstOrder first_order(const LensPrescription& lens, SpectralLine line = SpectralLine::kD);

/// Sums of one surface, or of all: wavefront aberrations in lengths, of the given pupil and field. Colour
/// from C to F.
struct SeidelTerms {
    double spherical = 0, coma = 0, astigmatism = 0, petzval = 0, distortion = 0;
    double axial_colour = 0, lateral_colour = 0;
};

inline constexpr std::array<NamedNumber<SeidelTerms>, 7> kSeidelNumbers{
    {{"spherical", &SeidelTerms::spherical},
     {"coma", &SeidelTerms::coma},
     {"astigmatism", &SeidelTerms::astigmatism},
     {"petzval", &SeidelTerms::petzval},
     {"distortion", &SeidelTerms::distortion},
     {"axial_colour", &SeidelTerms::axial_colour},
     {"lateral_colour", &SeidelTerms::lateral_colour}}};

/// What is looked at: the height of the marginal ray at the entrance pupil, and the chief ray's slope in
/// front of the lens.
struct LensBeam {
    double pupil_radius = 0, field_slope = 0;
};

struct SeidelSums {
    std::vector<SeidelTerms> rows;
    SeidelTerms sum;
    double image_slope = 0;   // of the marginal ray behind the lens, against the way light goes there
    double image_height = 0;  // of the chief ray, in the paraxial focus
};

/// Transverse aberrations are sums over twice the image's slope: spherical / (2 u') is how far the marginal
/// ray passes by the focus, in the third order.
SeidelSums seidel_sums(const LensPrescription& lens, const LensBeam& beam);

}  // namespace trilens
