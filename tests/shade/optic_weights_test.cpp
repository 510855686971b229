// Weights of reflected and refracted light: what glass without Fresnel passes on at grazing.
#include "shade/optic_weights.h"

#include "support/test.h"

using namespace trilens;

TEST_CASE("without Fresnel glass passes everything on at grazing too, and so to its tint", "[shade][law]") {
    Material glass;
    glass.transmission_factor = 1;
    glass.ior = 1.1;
    glass.base_color_factor = {0.5, 0.6, 0.7};
    for (const double dispersion : {0.0, 1.0}) {
        glass.dispersion = dispersion;
        const OpticWeights grazing = optic_weights(glass, {0, true}, false);
        CHECK(grazing.reflect == Vec3(0));
        CHECK(grazing.refract == glass.base_color_factor);
        CHECK_FALSE(reflects_totally(glass, {0, true}));
        CHECK(optic_weights(glass, {0, true}, true).reflect == Vec3(1));
        CHECK(optic_weights(glass, {0, false}, false).reflect == Vec3(1));
        CHECK(reflects_totally(glass, {0, false}));
    }
}
