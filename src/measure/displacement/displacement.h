// Displacement: the screen-space distance, in pixels, between where two images show the same point; with
// outlier rejection, as displacement is continuous and a jump is another image of the point.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/util/ids.h"
#include "measure/common/statistics.h"

namespace trilens {

class ReferenceLayers;

struct DisplacementOptions {
    double radius = 64;             // pixels; what is seen farther away counts as lost
    std::optional<Id> mask_object;  // as in CompareOptions
};

enum class Shift : std::uint8_t {
    kNothing,     // the test sees nothing here, or the pixel is masked
    kFound,       // measured
    kLost,        // the two show different things here, and the reference does not show the point within the
                  // radius, or only another image of it
    kUnmeasured,  // the two show the same triangle through the same optic here (or both the environment), and
                  // it cannot be said how far apart: its piece is too small to have a slope, or the reference
                  // shows the point only beyond the radius, or only another image of it
};

/// Statistics over the pixels that are kFound, and the vectors themselves, per pixel of the data window. What
/// could not be measured is in no mean, so every mean is to be read with its losses, which are counted in
/// both directions, and with the unmeasured. Each pixel of the test that shows the layer is in one of pixels,
/// lost and unmeasured. At folds of the reference (position_field.h) displacements fall more slowly than
/// elsewhere: the mean off the folds shows the order of the surface alone.
struct Displacement {
    std::optional<Summary> summary;  // of the shifts' lengths, pixels; none where no pixel was found
    std::size_t pixels = 0;          // found
    std::size_t lost = 0;            // pixels of the test whose point the reference does not show
    std::size_t unmeasured = 0;      // pixels of the test that show what the reference shows there, at a
                                     // distance that nothing tells
    std::size_t beyond_radius = 0;   // those lost or unmeasured whose point the reference shows farther away
                                     // than the radius
    std::size_t missing = 0;         // pixels of the reference whose point the test does not show: what would
                                     // be lost with the two images exchanged
    std::optional<double> coverage;  // found pixels over the pixels that show the layer in either image,
                                     // 0..1; none where neither shows it
    std::optional<double> mean_off_folds;  // over the found pixels that are not near a fold of the reference
    std::size_t near_folds = 0;            // found pixels that are
    std::vector<Shift> state;
    std::vector<float> shift_x, shift_y;  // from the test's pixel to the place in the reference, x right and
                                          // y down; zero where not found
};

/// For every pixel of `test` that sees, in `layer` ("reflect", "refract"), a point q of an object: the vector
/// to the nearest place where `reference` shows q, on the same object and through the same optic (of two
/// places within a quarter of a pixel either may be taken). Where a pixel sees the environment, q is a
/// direction, and the place is one where the reference sees the environment in that direction. Between the
/// reference's pixel centres positions are interpolated: cubically where 4 x 4 neighbours are smooth, on q's
/// own triangle where the images name triangles. Beyond a border of what the reference sees they are
/// continued by up to one pixel, guided by the test where that sees on. Where what the reference sees at the
/// pixel is one pixel wide, the shift is measured along that line alone. Exactly zero where both images agree
/// to the last bit. For small displacements of smooth fields the error is a small share of the displacement,
/// plus the rounding of float positions over their change from pixel to pixel; where a pixel holds much of
/// the scene (the rim of a sphere) and the displacement is not small, it may reach some pixels. Nothing where
/// the images have no such layer with places. Throws InputError where they cannot be compared.
std::optional<Displacement> measure_displacement(const Image& reference, const Image& test,
                                                 const std::string& layer,
                                                 const DisplacementOptions& options = {});

/// The same, for many tests of one reference.
std::optional<Displacement> measure_displacement(const ReferenceLayers& reference, const Image& test,
                                                 const std::string& layer,
                                                 const DisplacementOptions& options = {});

/// A curved mirror may show one point several times. Where the image that a pixel shows has no counterpart
/// (at a rim that the facets draw a little too large, say), the nearest match is another image of the point,
/// far away, and no measure of the error. Such a pixel's shift exceeds kOtherImage times the median shift of
/// the found pixels in the 7 x 7 window round it plus half a pixel; near a fold, where shifts grow large
/// together, none does. These pixels become kLost. Pixels with fewer than kFewestNeighbours found ones round
/// them stay as they are. `width`: of the data window.
void drop_other_images(Displacement& displacement, int width);

inline constexpr double kOtherImage = 8;
inline constexpr std::size_t kFewestNeighbours = 6;

/// Proven bounds of the test's displacement (its channel "bound", of a certified picture) against what was
/// measured. Checked are pixels with a bound above zero whose shift was found and is not in doubt: off folds,
/// in the middle of 5 x 5 pixels of the reference that show one triangle, or the environment, through one
/// optic, and where its places, by their fourth differences, are cubic between pixels to kBoundRoom. So good
/// the shift is there, too. A pixel's bound is the largest of all its paths', so it says less
/// of one layer where light goes on in several ways.
struct BoundCheck {
    std::size_t pixels = 0;               // checked
    std::size_t beyond = 0;               // those displaced by more than their bound and kBoundRoom
    std::optional<double> excess;         // the largest shift less its bound, pixels; none: none was checked
    std::optional<double> tightness_p50;  // median and
    std::optional<double> tightness_max;  // largest of bound over shift, where that is over 0.01 px
};

/// What the test's bounds are worth, by measure_displacement() of the same images and layer. None where the
/// test has no bounds or the layer shows no places. The bounds are of the exact surfaces: a reference that is
/// not traced from them tells nothing.
std::optional<BoundCheck> check_bounds(const Image& reference, const Image& test, const std::string& layer,
                                       const Displacement& displacement);

inline constexpr double kBoundRoom = 0.02;  // pixels

}  // namespace trilens
