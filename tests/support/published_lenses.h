// Lenses whose first order and aberrations are published, for tests.
#pragma once

#include <array>

#include "lens/prescription.h"

namespace trilens_test {

struct PublishedRow {
    double radius, thickness;
    trilens::Glass glass;
    double aperture;
    bool stop = false;
};

template <std::size_t N>
trilens::LensPrescription prescription_of(const char* name, const PublishedRow (&rows)[N]) {
    trilens::LensPrescription lens{name, name, {}};
    for (const PublishedRow& row : rows) {
        trilens::LensRow& made = lens.rows.emplace_back();
        made.side.curvature = row.radius == 0 ? 0 : 1 / row.radius;
        made.side.aperture = row.aperture;
        made.thickness = row.thickness;
        made.glass = row.glass;
        made.stop = row.stop;
    }
    return lens;
}

/// The Cooke triplet of W. J. Smith, Modern Optical Engineering, fourth edition, chapter 6.
inline trilens::LensPrescription cooke_triplet() {
    const trilens::Glass crown{"SK4", 1.61272, 58.63}, flint{"SF2", 1.64769, 33.85};
    const PublishedRow rows[] = {{37.40, 5.90, crown, 14.7},  {-341.48, 12.93, {}, 14.7},
                                 {-42.65, 2.50, flint, 10.8}, {36.40, 2.00, {}, 10.8},
                                 {0, 9.85, {}, 10.3, true},   {204.52, 5.90, crown, 11.6},
                                 {-37.05, 77.405, {}, 11.6}};
    return prescription_of("triplet", rows);
}

/// The double Gauss f/1.25 of W. J. Smith, Modern Lens Design, 1992, page 304 (US patent 2,771,006).
inline trilens::LensPrescription double_gauss() {
    const trilens::Glass laf3{"LAF3", 1.717, 48.0}, baf9{"BAF9", 1.64328, 48.0}, lf2{"LF2", 1.58921, 40.9},
        sf14{"SF14", 1.76182, 26.5}, laf2{"LAF2", 1.744, 44.7};
    const PublishedRow rows[] = {
        {93.320, 11.320, laf3, 40}, {358.290, 0.400, {}, 40},   {46.320, 20.000, baf9, 36},
        {0, 2.000, lf2, 36},        {28.680, 14.000, {}, 24.5}, {0, 10.000, {}, 24.3, true},
        {-41.320, 6.000, sf14, 24}, {60.800, 22.000, laf2, 30}, {-55.000, 13.000, {}, 30},
        {90.200, 16.000, laf3, 28}, {-212.580, 56.424, {}, 28}};
    return prescription_of("double Gauss", rows);
}

/// The double Gauss with a field of 28 degrees among the samples of Zemax, as Optiland's samples have it.
inline trilens::LensPrescription double_gauss_of_28_degrees() {
    const trilens::Glass ssk2{"N-SSK2", 1.62229, 53.27}, sk2{"N-SK2", 1.60738, 56.65},
        f5{"F5", 1.60342, 38.03}, sk16{"N-SK16", 1.62041, 60.32};
    const PublishedRow rows[] = {{56.20238, 8.75, ssk2, 29},    {152.2858, 0.5, {}, 28},
                                 {37.68262, 12.5, sk2, 24},     {0, 3.8, f5, 21},
                                 {24.2313, 16.369445, {}, 15},  {0, 13.747957, {}, 10, true},
                                 {-28.37731, 3.8, f5, 15},      {0, 11, sk16, 19},
                                 {-37.92546, 0.5, {}, 20},      {177.41176, 7, sk16, 23},
                                 {-79.41143, 61.487536, {}, 24}};
    return prescription_of("double Gauss of 28 degrees", rows);
}

}  // namespace trilens_test
