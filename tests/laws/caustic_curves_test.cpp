// Light over optics at curves and points that have closed forms.
#include <algorithm>
#include <cmath>

#include "support/lit_world.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// How much light is near a fold: two points at distances from it, on its bright side, less that beyond.
struct FoldLight {
    double near = 0, far = 0, beyond = 0;
    double ratio() const { return (near - beyond) / (far - beyond); }
};

FoldLight light_at_fold(const BeamLight& light, const Vec3& on_curve, const Vec3& across) {
    const auto light_at = [&](double distance) {
        const Vec3 there = on_curve + distance * across;
        return light.exact_irradiance(on_floor(there.x, there.z)).y;
    };
    const double side = light_at(0.002) > light_at(-0.002) ? 1 : -1;
    return {light_at(side * 0.0005), light_at(side * 0.002), light_at(-side * 0.002)};
}

}  // namespace

TEST_CASE("a lamp on the rim of a mirrored ring draws a cardioid", "[laws][law][caustics]") {
    // The lamp stands on the mirrored wall. Seen from above, light of all heights runs along the same lines:
    // those of a circle's point, reflected in the circle, touch (2 cos b + cos 2b, 2 sin b + sin 2b) / 3.
    // Source: Castillon, De curva cardioide, 1741.
    const LitWorld lit(lit_world(
        R"({"name": "ring", "role": "optic", "material": "mirror", "resolution": 16,
        "primitive": {"type": "cylinder", "center": [0, 0.5, 0], "axis": [0, 1, 0], "radius": 1, "height": 1}})",
        R"({"type": "point", "position": [0.999999, 0.9, 0], "intensity": 1, "caustics": true})"));
    for (const double b : {1.2, 1.7, 2.2}) {
        const Vec3 on_curve((2 * std::cos(b) + std::cos(2 * b)) / 3, 0,
                            (2 * std::sin(b) + std::sin(2 * b)) / 3);
        const Vec3 tangent(-std::sin(b) - std::sin(2 * b), 0, std::cos(b) + std::cos(2 * b));
        const Vec3 across = normalize(Vec3(tangent.z, 0, -tangent.x));
        const FoldLight fold = light_at_fold(lit.light(), on_curve, across);
        CAPTURE(b, fold.near, fold.far, fold.beyond);
        CHECK(fold.ratio() == Approx(2).epsilon(0.1));
    }
}

TEST_CASE("a parabola gathers the light that comes along its axis in its focus", "[laws][law][caustics]") {
    const LitWorld lit(lit_world(
        R"({"name": "dish", "role": "optic", "material": "mirror", "resolution": 16, "primitive": {"type": "paraboloid", "center": [0, 0.5, 0], "axis": [0, 1, 0], "radius": 1, "focalLength": 1}})",
        R"({"type": "directional", "direction": [0, -1, 0], "intensity": 1, "caustics": true})"));
    const Beams& beams = lit.light().beams();
    const Vec3 focus(0, 1.5, 0);
    double farthest = 0;
    std::size_t reflected = 0;
    for (const LightBeam& beam : beams.beams) {
        if (beams.histories[beam.history].steps.size() != 1) continue;
        for (const Id e : beam.end) {
            const BeamEnd& end = beams.ends[e];
            farthest = std::max(farthest, length(cross(focus - end.origin, end.direction)));
            ++reflected;
        }
    }
    CHECK(reflected > 100);
    CHECK(farthest < 1e-6);
}
